"""Which of a scene's objects are wanted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, ObjectCloud, Scene, Sensor

NO_OBJECT_AT = "no object lies at"


def cropped(cloud: Cloud, crop: tuple[float, ...] | None) -> Cloud:
    """The cloud without the points outside the region of interest (x_min, x_max, y_min, y_max, z_min, z_max)."""
    if crop is None:
        return cloud
    low, high = np.array(crop[::2]), np.array(crop[1::2])
    return cloud.select(np.all((cloud.points >= low) & (cloud.points <= high), axis=1))


def chosen(scene: Scene, select: str | tuple[float, float], sensor: Sensor) -> Scene:
    """The scene with the wanted ones of its objects alone; the others remain obstacles to them.

    If only the direction to the `sensor` is known, the nearest object is the one that reaches farthest in it. A place
    that is farther from all objects than the nearest is long means none of them: it is a slip, or in another unit.
    """
    if select == "all" or not scene.objects:
        return scene
    if select == "largest":
        return replace(scene, objects=(max(scene.objects, key=lambda item: len(item.points)),))

    def distance(item: ObjectCloud) -> float:
        if isinstance(select, str):
            if sensor.position is not None:
                return _nearest(item.points, sensor.position)
            return -float((item.points @ (item.toward if sensor.direction is None else sensor.direction)).max())
        return _nearest(item.points[:, :2], np.array(select))

    nearest = min(scene.objects, key=distance)
    reason = None if isinstance(select, str) else _too_far(nearest, select)
    if reason is None:
        return replace(scene, objects=(nearest,))
    clutter = np.concatenate([scene.clutter, *(item.points for item in scene.objects)])
    return replace(scene, objects=(), clutter=clutter, reason=reason)


def _too_far(item: ObjectCloud, place: tuple[float, float]) -> str | None:
    """Why a place (x, y) cannot mean the object that is nearest to it; None if it may."""
    if len(item.points) == 0:
        return None
    places = item.points[:, :2]
    low, high = places.min(axis=0), places.max(axis=0)
    size_m, away_m = float(np.linalg.norm(high - low)), _nearest(places, np.array(place))
    if away_m <= size_m:
        return None
    x, y = (0.5 * (low + high)).tolist()
    return (
        f"{NO_OBJECT_AT} {place[0]:g}, {place[1]:g}: the nearest, object {item.id} around {x:.3f}, {y:.3f}, is "
        f"{away_m:.3f} m away and {size_m:.3f} m long"
    )


def _nearest(points: FloatArray, place: FloatArray) -> float:
    """Distance from a place to the nearest of the points; infinite if there are none."""
    return float(np.linalg.norm(points - place, axis=1).min(initial=np.inf))
