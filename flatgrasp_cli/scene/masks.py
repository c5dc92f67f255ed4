"""The extent of what a mask (rows, columns) marks."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray


def hull_of(mask: BoolArray) -> FloatArray:
    """Corners (c, 2) of the convex hull of a mask's cells; the first and the last cell of each row suffice."""
    rows, first, last = ends_of(mask)
    ends = np.column_stack([np.tile(rows, 2), np.concatenate([first, last])])
    corners = cv2.convexHull(ends.astype(np.int32)).reshape(-1, 2)  # which of whole numbers is exact
    return corners.astype(np.float64) if len(corners) > 2 else np.empty((0, 2))


def ends_of(mask: BoolArray) -> tuple[IntArray, IntArray, IntArray]:
    """The rows in which a mask has cells, and the first and last column of the cells in each."""
    rows = np.flatnonzero(mask.any(axis=1))
    last = mask.shape[1] - 1 - mask[rows, ::-1].argmax(axis=1)
    return rows, mask[rows].argmax(axis=1), last


def span_of(mask: BoolArray) -> FloatArray:
    """How many cells lie between a mask's first and last row and column (2,)."""
    rows, first, last = ends_of(mask)
    return np.array([np.ptp(rows), last.max() - first.min()], dtype=np.float64)
