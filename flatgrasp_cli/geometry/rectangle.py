"""Minimum-area rectangle of a planar point set."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.kernels.rim import on_rim


def longer_side(points: FloatArray) -> float:
    """Length of the longer side of the smallest rectangle around `points` (n, 2)."""
    return float(max(cv2.minAreaRect((points - mean_of(points)).astype(np.float32))[1]))


def minimum_area_axis(points: FloatArray) -> FloatArray:
    """Unit direction (2,) of the longer side of the smallest rectangle around `points` (n, 2).

    One side of that rectangle lies on an edge of the convex hull (Freeman & Shapira, CACM 18(7), 1975), so all edges
    are tried at once.
    """
    middle, few = mean_of(points), points[on_rim(points)]
    corners = cv2.convexHull((few - middle).astype(np.float32), returnPoints=False)  # precise enough about the middle
    hull = few[corners[:, 0]]
    edges = np.roll(hull, -1, axis=0) - hull
    along = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    length, width = np.ptp(hull @ along.T, axis=0), np.ptp(hull @ across.T, axis=0)
    best = int(np.argmin(length * width))
    axis: FloatArray = along[best] if length[best] >= width[best] else across[best]
    return axis
