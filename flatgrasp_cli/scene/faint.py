"""What stands out of the support plane no more than the sensor's errors do where it lies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.model import SupportPlane
from flatgrasp_cli.scene.clusters import Clusters
from flatgrasp_cli.scene.parting.view_grid import image_of
from flatgrasp_cli.scene.support_plane import SAMPLE, SIGMAS

SURE_SIGMAS = 2.0
"""A thing is higher, on average, than so many standard deviations of single points there: ripples of a disparity's last
digit, which no mean over cells removes, are as high as that in real frames of tables."""
GHOST_M, GHOST_PX, GHOST_SHARE = 0.01, 10.0, 0.8
"""A ripple of the plane beside the edge of something nearer: the share of it, at least, that lies so near to that edge
in the image, in pixels, and the most, metres, that it is high on average. Sensors that match windows of some 20 pixels
take what half of such a window shows for one surface."""
NEARER_M = 0.05
"""Something nearer by this casts a shadow; what a low thing stands beside is not so far off."""


def without_faint(points: FloatArray, clusters: Clusters, plane: SupportPlane, viewpoint: FloatArray) -> Clusters:
    """The clusters of `points` (n, 3) without those that may be noise, which are clutter.

    The noise of depth from disparity grows with the square of the distance from `viewpoint` (3,) (Khoshelham & Elberink
    2012); the plane's own is that at its middle distance.
    """
    sample = points[spread_indices(len(points), SAMPLE)]
    flat = sample[np.abs(plane.heights(sample)) < SIGMAS * plane.noise_m]
    usual_m = float(np.median(np.linalg.norm((flat if len(flat) else sample) - viewpoint, axis=1)))
    reach = GHOST_PX * clusters.floor.spacing_m / usual_m

    def is_faint(own: FloatArray) -> bool:
        share = float(np.linalg.norm(mean_of(own) - viewpoint)) / usual_m
        height_m = float(plane.heights(own).mean())
        if height_m < SURE_SIGMAS * plane.noise_m * share**2:
            return True
        if height_m > GHOST_M:
            return False
        standing = points[np.concatenate([*clusters.members, clusters.clutter])]
        return _at_edge_share(own, standing, viewpoint, reach) >= GHOST_SHARE

    sure, faint = list[IntArray](), [clusters.clutter]
    for rows in clusters.members:
        (faint if is_faint(points[rows]) else sure).append(rows)
    return replace(clusters, members=tuple(sure), clutter=np.concatenate(faint))


def _at_edge_share(own: FloatArray, standing: FloatArray, viewpoint: FloatArray, reach: float) -> float:
    """Share of the points `own` (k, 3) seen within an angle `reach` of a nearer one of those `standing` (n, 3)."""
    x, y, depth = image_of(np.concatenate([own, standing]), viewpoint)
    (x, others_x), (y, others_y), (depth, others_depth) = (np.split(values, [len(own)]) for values in (x, y, depth))
    near = (others_x > x.min() - reach) & (others_x < x.max() + reach) & (others_depth < depth.max() - NEARER_M)
    near &= (others_y > y.min() - reach) & (others_y < y.max() + reach)
    away = np.hypot(x[:, None] - others_x[near], y[:, None] - others_y[near])
    nearer = others_depth[near] < depth[:, None] - NEARER_M
    return float(((away < reach) & nearer).any(axis=1).mean())
