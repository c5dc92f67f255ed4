"""Minimum-area rectangle of a planar point set."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray


def minimum_area_axis(points: FloatArray) -> FloatArray:
    """Unit direction (2,) of the longer side of the smallest rectangle around `points` (n, 2).

    One side of that rectangle lies on an edge of the convex hull (Freeman & Shapira, CACM 18(7), 1975), so all edges
    are tried at once.

    Raises
    ------
    scipy.spatial.QhullError
        If the points lie on a line.
    """
    from scipy.spatial import ConvexHull

    outer = _outside_octagon(points)
    hull = outer[ConvexHull(outer).vertices]
    edges = np.roll(hull, -1, axis=0) - hull
    along = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    length, width = np.ptp(hull @ along.T, axis=0), np.ptp(hull @ across.T, axis=0)
    best = int(np.argmin(length * width))
    axis: FloatArray = along[best] if length[best] >= width[best] else across[best]
    return axis


def _outside_octagon(points: FloatArray) -> FloatArray:
    """The points (k, 2) that can be on the convex hull: not inside the polygon of the extremes in eight directions.

    Akl & Toussaint's throw-away (Information Processing Letters 7(5), 1978).
    """
    angles = np.arange(8) * (np.pi / 4)
    columns = np.ascontiguousarray(points.T)
    reach = np.column_stack([np.cos(angles), np.sin(angles)]) @ columns
    corners = points[reach.argmax(axis=1)]
    edge = np.roll(corners, -1, axis=0) - corners
    left = np.column_stack([-edge[:, 1], edge[:, 0]])
    inside = (left @ columns > (left * corners).sum(axis=1)[:, None]).all(axis=0)
    return np.asarray(points[~inside])
