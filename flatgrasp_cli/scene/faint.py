"""What stands out of the support plane no more than the sensor's errors do where it lies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.geometry.scatter import median, quantile
from flatgrasp_cli.kernels.points import distances
from flatgrasp_cli.model import Cloud, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.clusters import Clusters
from flatgrasp_cli.scene.parting.joints import MOST
from flatgrasp_cli.scene.parting.view_grid import image_of
from flatgrasp_cli.scene.support_plane import SAMPLE, SIGMAS, flatness_m

WINDOW_PX = 10.0
"""So near to an edge, in pixels, an image is not to be trusted: sensors that match windows of some 20 pixels take what
half of such a window shows for one surface. Most of a ripple beside the edge of something nearer lies there."""


def without_faint(
    cloud: Cloud, clusters: Clusters, plane: SupportPlane, viewpoint: FloatArray, settings: SceneSettings
) -> Clusters:
    """The clusters of a cloud without those that may be noise, which are clutter.

    The noise of depth from disparity grows with the square of the distance from `viewpoint` (3,) (Khoshelham & Elberink
    2012); the plane's own is that at its middle distance.
    """
    sample, points = cloud.sample(SAMPLE), cloud.points
    flat = sample[np.abs(plane.heights(sample)) < flatness_m(plane, settings)]
    usual_m = median(distances(flat if len(flat) else sample, viewpoint))
    reach = WINDOW_PX * clusters.floor.spacing_m / usual_m

    def is_faint(own: FloatArray) -> bool:
        share = float(np.linalg.norm(mean_of(own) - viewpoint)) / usual_m
        heights = plane.heights(own)
        if quantile(heights, MOST) < SIGMAS * plane.noise_m * share**2:
            return True
        if float(heights.mean()) > settings.min_size_m:
            return False
        standing = points.take(np.concatenate([*clusters.members, clusters.clutter]), axis=0)
        return _at_edge_share(own, standing, viewpoint, reach, settings.least_part_m) >= MOST

    sure, faint = list[IntArray](), [clusters.clutter]
    for rows in clusters.members:
        (faint if is_faint(points.take(rows, axis=0)) else sure).append(rows)
    return replace(clusters, members=tuple(sure), clutter=np.concatenate(faint))


def _at_edge_share(
    own: FloatArray, standing: FloatArray, viewpoint: FloatArray, reach: float, nearer_m: float
) -> float:
    """Share of the points `own` (k, 3) seen within an angle `reach` of one of those `standing` (n, 3) before it.

    What is nearer by less than `nearer_m` casts no shadow: a low thing may stand beside it.
    """
    x, y, depth = image_of(np.concatenate([own, standing]), viewpoint)
    (x, others_x), (y, others_y), (depth, others_depth) = (np.split(values, [len(own)]) for values in (x, y, depth))
    near = (others_x > x.min() - reach) & (others_x < x.max() + reach) & (others_depth < depth.max() - nearer_m)
    near &= (others_y > y.min() - reach) & (others_y < y.max() + reach)
    away = np.hypot(x[:, None] - others_x[near], y[:, None] - others_y[near])
    nearer = others_depth[near] < depth[:, None] - nearer_m
    return float(((away < reach) & nearer).any(axis=1).mean())
