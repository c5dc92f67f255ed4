"""Which of a scene's objects are wanted."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, ObjectCloud, Sensor


def cropped(cloud: Cloud, crop: tuple[float, ...] | None) -> Cloud:
    """The cloud without the points outside the region of interest (x_min, x_max, y_min, y_max, z_min, z_max)."""
    if crop is None:
        return cloud
    low, high = np.array(crop[::2]), np.array(crop[1::2])
    return cloud.select(np.all((cloud.points >= low) & (cloud.points <= high), axis=1))


def selected(
    objects: tuple[ObjectCloud, ...], select: str | tuple[float, float], sensor: Sensor
) -> tuple[ObjectCloud, ...]:
    """The wanted objects; the others remain obstacles to them.

    If only the direction to the `sensor` is known, the nearest object is the one that reaches farthest in it.
    """
    if select == "all" or not objects:
        return objects
    if select == "largest":
        return (max(objects, key=lambda item: len(item.points)),)

    def distance(item: ObjectCloud) -> float:
        if isinstance(select, str):
            if sensor.position is not None:
                return _nearest(item.points, sensor.position)
            return -float((item.points @ (item.toward if sensor.direction is None else sensor.direction)).max())
        return _nearest(item.points[:, :2], np.array(select))

    return (min(objects, key=distance),)


def _nearest(points: FloatArray, place: FloatArray) -> float:
    """Distance from a place to the nearest of the points; infinite if there are none."""
    return float(np.linalg.norm(points - place, axis=1).min(initial=np.inf))
