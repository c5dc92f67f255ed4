"""One cloud → its scene: objects on a support plane, or one object alone."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, ObjectCloud, Scene, Sensor, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.clusters import find_clusters
from flatgrasp_cli.scene.faint import without_faint
from flatgrasp_cli.scene.heaps import Heap
from flatgrasp_cli.scene.objects import objects_of, overlook
from flatgrasp_cli.scene.selection import chosen, cropped
from flatgrasp_cli.scene.strays import TAIL_SHARE
from flatgrasp_cli.scene.support_plane import NEAR_M, SAMPLE, find_support_plane, flatness_m

LARGEST_EXTENT_M = 20.0
"""No view of objects for a gripper is wider than this, metres; a lidar's is, and so is a cloud in millimetres."""
NO_PLANE = "no support plane was found"
RIPPLE_M = 0.010
"""A table's own ripple, metres: what lies close below a plane, and not on it, is lower."""
BELOW_SHARE = 0.03
"""Share of points close below a plane, of those on it, from which on the plane is a part of a body. Real tables have
less than 1 %, at their edges."""
NOTHING_STANDS = "nothing stands on the support plane"


def segment(cloud: Cloud, settings: SceneSettings, seed: int) -> Scene:
    """The objects that `cloud` shows, those that are wanted.

    In mode `auto` a plane is a support plane if objects stand on it, with enough of it around them and little below it,
    or if it is too long for an object; else the whole cloud is one object.
    """
    cloud = cropped(cloud, settings.crop)
    sensor = cloud.sensor or Sensor("assumed", np.zeros(3))
    return chosen(_shown(cloud, sensor, settings, seed), settings.select, sensor)


def _shown(cloud: Cloud, sensor: Sensor, settings: SceneSettings, seed: int) -> Scene:
    """The scene with all of its objects."""
    reason = _too_large(cloud)
    if reason is not None:
        return Scene(None, (), cloud.points, reason)
    if settings.mode == "object" or len(cloud.points) < 3:
        return _alone(cloud.points, sensor, settings)
    plane = find_support_plane(cloud, sensor, settings, seed)
    clusters = find_clusters(cloud, plane, settings) if plane is not None else None
    if plane is None or clusters is None:
        if settings.mode == "auto":
            return _alone(cloud.points, sensor, settings)
        return Scene(None, (), cloud.points, NO_PLANE)
    viewpoint = overlook(cloud.points, sensor, plane)
    clusters = without_faint(cloud, clusters, plane, viewpoint, settings)
    heap = Heap(cloud.points, clusters, plane, viewpoint, settings=settings, colors=cloud.colors)
    container = heap.container()
    small = clusters.extent_m <= settings.max_size_m and container is None
    if settings.mode == "auto" and small and (not clusters.lie_on_table or _goes_on_below(cloud, plane, settings)):
        return _alone(cloud.points, sensor, settings)
    clusters = heap.apart(container)
    objects, wholes = objects_of(cloud, sensor, plane, clusters, settings)
    return Scene(
        support=plane,
        objects=objects,
        clutter=cloud.points.take(clusters.clutter, axis=0),
        reason=None if objects else NOTHING_STANDS,
        wholes=wholes,
        container=cloud.points.take(clusters.container, axis=0),
    )


def _too_large(cloud: Cloud) -> str | None:
    """Why a cloud, apart from stray points, is no view of objects; None if it may be one."""
    if len(cloud.points) == 0 or float(np.ptp(cloud.measured.corners, axis=0).max()) <= LARGEST_EXTENT_M:
        return None
    sample = cloud.sample(SAMPLE)
    strays = int(TAIL_SHARE * len(sample))
    low, high = np.sort(sample, axis=0)[[strays, -1 - strays]]
    x, y, z = (high - low).tolist()
    if max(x, y, z) <= LARGEST_EXTENT_M:
        return None
    return f"the cloud is {x:.0f} × {y:.0f} × {z:.0f} m, no view of objects for a gripper"


def _goes_on_below(cloud: Cloud, plane: SupportPlane, settings: SceneSettings) -> bool:
    """Whether much lies close below a plane, as a body's flanks do below its front."""
    heights, flat_m = plane.heights(cloud.sample(SAMPLE)), flatness_m(plane, settings)
    on = np.abs(heights) < flat_m
    below = (heights < -max(flat_m, RIPPLE_M)) & (heights > -NEAR_M)
    return bool(below.sum() > BELOW_SHARE * on.sum())


def _alone(points: FloatArray, sensor: Sensor, settings: SceneSettings) -> Scene:
    """All points as one object; the hand comes from above if the way up is known, else from the sensor."""
    toward = sensor.toward(points.mean(axis=0)) if len(points) else np.zeros(3)
    if settings.up is not None:
        up, length = np.asarray(settings.up), max(float(np.linalg.norm(toward)), 1e-12)
        # the sensor decides where the main plane has no upper side: so upright that little of one would be seen
        share = 1 / np.tan(np.radians(settings.max_view_deg))
        toward = up / np.linalg.norm(up) + share * toward / length
    return Scene(None, (ObjectCloud(0, points, toward, sensor.position),), np.empty((0, 3)))
