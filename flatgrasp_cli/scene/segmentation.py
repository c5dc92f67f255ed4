"""One cloud → its scene: objects on a support plane, or one object alone."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, ObjectCloud, Scene, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.clusters import Clusters, find_clusters
from flatgrasp_cli.scene.selection import cropped, selected
from flatgrasp_cli.scene.support_plane import find_support_plane, looks_down

NEAR_M = 0.2
"""Other points farther than this from an object's bounding box cannot meet the hand."""
OVERHEAD_M = 1.0
"""Where no sensor is known, shadows are those of one straight above."""
LARGEST_EXTENT_M = 20.0
"""No view of objects for a gripper is wider than this: a lidar's is, and one that is in millimetres."""
SAMPLE, STRAY_SHARE = 2000, 0.02
SIGMAS, LEAST_BELOW_M, MOST_BELOW_M = 3.0, 0.010, 0.1
BELOW_SHARE = 0.03
"""Of the points on a plane: real tables have less than 1 % close below them, their edges."""


def segment(cloud: Cloud, settings: SceneSettings, seed: int) -> Scene:
    """The objects that `cloud` shows.

    In mode `auto` a plane is a support plane if objects stand on it with more of it around them and nothing goes on
    below, or if it is too long for an object; else the whole cloud is one object.
    """
    cloud = cropped(cloud, settings.crop)
    reason = _too_large(cloud.points)
    if reason is not None:
        return Scene(None, (), cloud.points, reason)
    alone = Scene(None, (ObjectCloud(0, cloud.points, cloud.viewpoint),), np.empty((0, 3)))
    if settings.mode == "object" or len(cloud.points) < 3:
        return alone
    plane = find_support_plane(cloud.points, cloud.viewpoint, settings, seed)
    clusters = find_clusters(cloud.points, plane, settings) if plane is not None else None
    if plane is None or clusters is None:
        return alone if settings.mode == "auto" else Scene(None, (), cloud.points, "no support plane was found")
    small = clusters.extent_m <= settings.max_size_m
    if settings.mode == "auto" and small and (not clusters.lie_on_table or _goes_on_below(cloud.points, plane)):
        return alone
    objects = _objects(cloud, plane, clusters)
    reason = None if objects else "nothing stands on the support plane"
    return Scene(plane, selected(objects, settings.select), cloud.points[clusters.clutter], reason)


def _too_large(points: FloatArray) -> str | None:
    """Why a cloud is no view of objects, stray points aside; None if it may be one."""
    if len(points) == 0:
        return None
    sample = points[:: max(1, len(points) // SAMPLE)]
    strays = int(STRAY_SHARE * len(sample))
    low, high = np.sort(sample, axis=0)[[strays, -1 - strays]]
    x, y, z = (high - low).tolist()
    if max(x, y, z) <= LARGEST_EXTENT_M:
        return None
    return (
        f"the cloud is {x:.0f} × {y:.0f} × {z:.0f} m, no view of objects for a gripper: choose a region with --crop, "
        "or, if it is in millimetres, give --scale 0.001"
    )


def _goes_on_below(points: FloatArray, plane: SupportPlane) -> bool:
    """Whether much lies close below a plane, as the flanks of a body do below one through its front."""
    heights = plane.heights(points[:: max(1, len(points) // SAMPLE)])
    on = np.abs(heights) < SIGMAS * plane.noise_m
    below = (heights < -max(SIGMAS * plane.noise_m, LEAST_BELOW_M)) & (heights > -MOST_BELOW_M)
    return bool(below.sum() > BELOW_SHARE * on.sum())


def _objects(cloud: Cloud, plane: SupportPlane, clusters: Clusters) -> tuple[ObjectCloud, ...]:
    """The clusters as objects, each with what else stands near it."""
    rows = (*clusters.members, clusters.clutter)
    ends = np.cumsum([len(own) for own in rows])
    standing = cloud.points[np.concatenate(rows)]
    columns = np.ascontiguousarray(standing.T)
    seen_from_above = looks_down(cloud.viewpoint, plane.normal, plane.offset_m)
    found = []
    for index in range(len(clusters.members)):
        mine = slice(ends[index] - len(rows[index]), ends[index])
        near = np.ones(len(standing), dtype=np.bool_)
        for values in columns:
            near &= (values > values[mine].min() - NEAR_M) & (values < values[mine].max() + NEAR_M)
        near[mine] = False
        viewpoint = cloud.viewpoint
        if not seen_from_above:
            viewpoint = columns[:, mine].mean(axis=1) + OVERHEAD_M * plane.normal
        found.append(
            ObjectCloud(index, standing[mine], viewpoint, plane, standing[np.flatnonzero(near)], clusters.floor)
        )
    return tuple(found)
