"""The extent of what a mask (rows, columns) marks."""

from __future__ import annotations

from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray


def hull_of(mask: BoolArray) -> Any:
    """Convex hull of a mask's cells, as a shapely geometry; the first and the last cell of each row suffice."""
    import shapely

    rows, first, last = ends_of(mask)
    ends = np.column_stack([np.tile(rows, 2), np.concatenate([first, last])])
    return shapely.LineString(ends).convex_hull  # of a line: a geometry of many points takes long to make


def ends_of(mask: BoolArray) -> tuple[IntArray, IntArray, IntArray]:
    """The rows in which a mask has cells, and the first and last column of the cells in each."""
    rows = np.flatnonzero(mask.any(axis=1))
    last = mask.shape[1] - 1 - mask[rows, ::-1].argmax(axis=1)
    return rows, mask[rows].argmax(axis=1), last


def span_of(mask: BoolArray) -> FloatArray:
    """How many cells lie between a mask's first and last row and column (2,)."""
    rows, first, last = ends_of(mask)
    return np.array([np.ptp(rows), last.max() - first.min()], dtype=np.float64)
