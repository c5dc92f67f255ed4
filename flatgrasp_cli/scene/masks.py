"""The extent of what a mask (rows, columns) marks."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.kernels.rim import ends


def hull_of(mask: BoolArray) -> FloatArray:
    """Corners (c, 2) of the convex hull of a mask's cells, none if they lie on a line; each row's ends suffice."""
    rows, first, last = ends(mask.view(np.uint8))
    both = np.column_stack([np.tile(rows, 2), np.concatenate([first, last])])
    if len(both) == 0:
        return np.empty((0, 2))
    corners = cv2.convexHull(both.astype(np.int32)).reshape(-1, 2)  # which of whole numbers is exact
    return corners.astype(np.float64) if len(corners) > 2 else np.empty((0, 2))


def span_of(mask: BoolArray) -> FloatArray:
    """How many cells lie between a mask's first and last row and column (2,)."""
    rows, first, last = ends(mask.view(np.uint8))
    return np.array([np.ptp(rows), last.max() - first.min()], dtype=np.float64)
