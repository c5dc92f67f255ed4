"""Clusters → objects, each with what stands near it, and from where it was seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.extents import bounds_of, extent_of, mean_of
from flatgrasp_cli.kernels.points import between
from flatgrasp_cli.model import Cloud, ObjectCloud, Sensor, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.clusters import Clusters
from flatgrasp_cli.scene.heaps import longest_whole_m
from flatgrasp_cli.scene.picture import at_table_edge, cut_off
from flatgrasp_cli.scene.stacking import least_drop_m, supported_by
from flatgrasp_cli.scene.support_plane import NEAR_M, REACH_M, looks_down


def overlook(points: FloatArray, sensor: Sensor, plane: SupportPlane) -> FloatArray:
    """Where `points` (n, 3) are looked at from: the sensor, or straight above where it is not known to look down."""
    if sensor.position is not None and not sensor.sees_all_sides and looks_down(sensor, plane.normal, plane.offset_m):
        return sensor.position
    return np.asarray(mean_of(points) + REACH_M * plane.normal)


def objects_of(
    cloud: Cloud, sensor: Sensor, plane: SupportPlane, clusters: Clusters, settings: SceneSettings
) -> tuple[tuple[ObjectCloud, ...], tuple[ObjectCloud, ...]]:
    """The clusters as objects, and the groups of those that touch and may be one; each with what stands near it."""
    rows = (*clusters.members, clusters.clutter, clusters.container)
    standing = np.concatenate([cloud.points.take(np.concatenate(rows), axis=0), clusters.solid])
    ends = np.cumsum([len(own) for own in clusters.members])
    places = [np.arange(end - len(own), end) for own, end in zip(clusters.members, ends, strict=True)]
    groups = clusters.groups or (None,) * len(places)
    around = _Around(standing, sensor, plane, clusters)
    carried = supported_by(cloud.points, clusters.members, clusters.floor, least_drop_m(settings))
    at_edge = at_table_edge(cloud.points, clusters.members, clusters.floor, settings.least_part_m)
    cut = cut_off(cloud, overlook(cloud.points, sensor, plane), clusters.members, clusters.floor.spacing_m)
    objects = tuple(
        replace(
            around.object(index, place),
            group=groups[index],
            cut_off=cut[index],
            at_edge=at_edge[index],
            supports=carried[index],
        )
        for index, place in enumerate(places)
    )
    wholes = []
    for group in sorted({group for group in groups if group is not None}):
        parts = [index for index, own in enumerate(groups) if own == group]
        place = np.concatenate([places[index] for index in parts])
        if np.linalg.norm(extent_of(standing[place])) <= longest_whole_m(settings):
            whole = around.object(parts[0], place)
            cut_any, edge_any = (any(flags[index] for index in parts) for flags in (cut, at_edge))
            wholes.append(replace(whole, group=group, cut_off=cut_any, at_edge=edge_any))
    return objects, tuple(wholes)


class _Around:
    """The points (n, 3) above a support plane, and who saw them."""

    def __init__(self, standing: FloatArray, sensor: Sensor, plane: SupportPlane, clusters: Clusters) -> None:
        self.standing = standing
        self.sensor, self.plane, self.floor = sensor, plane, clusters.floor
        self.seen_from_above = looks_down(sensor, plane.normal, plane.offset_m)
        self.in_container = len(clusters.container) > 0

    def object(self, index: int, mine: IntArray) -> ObjectCloud:
        """The object number `index` that has the points `mine` (k,), with what stands near it."""
        points = self.standing.take(mine, axis=0)
        low, high = bounds_of(points)
        near = np.zeros(len(self.standing), dtype=np.bool_)
        near[between(self.standing, low - NEAR_M, high + NEAR_M)] = True
        near[mine] = False
        middle = mean_of(points)
        viewpoint = self.sensor.position if self.seen_from_above else middle + REACH_M * self.plane.normal
        return ObjectCloud(
            id=index,
            points=points,
            toward=self.plane.normal if viewpoint is None else viewpoint - middle,
            viewpoint=None if self.sensor.sees_all_sides else viewpoint,
            support=self.plane,
            obstacles=self.standing.take(np.flatnonzero(near), axis=0),
            floor=self.floor,
            in_container=self.in_container,
        )
