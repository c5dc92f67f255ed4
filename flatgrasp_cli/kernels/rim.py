"""What may be corners of the convex hull: of many points in the plane, or cells of a mask, a few."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

SURELY = cython.declare(cython.double, 1e-6)
"""How far inside a point has to be to be left out, as a share of the extent: more than single precision rounds off."""


def on_rim(points: cython.const[cython.double][:, :]) -> NDArray[np.intp]:  # type: ignore[valid-type]
    """Rows of `points` (n, 2) that do not lie inside the octagon of the outermost ones in eight directions.

    Akl & Toussaint, "A fast convex hull algorithm", Information Processing Letters 7(5), 1978.
    """
    row: cython.Py_ssize_t
    side: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    rows = np.empty(points.shape[0], dtype=np.intp)
    kept: cython.Py_ssize_t[::1] = rows
    sides: cython.double[:, ::1] = _octagon(points)
    for row in range(points.shape[0]):
        x: cython.double = points[row, 0]
        y: cython.double = points[row, 1]
        for side in range(sides.shape[0]):
            if sides[side, 0] * x + sides[side, 1] * y >= sides[side, 2]:
                kept[found] = row
                found += 1
                break
    few: NDArray[np.intp] = rows[:found]
    return few


def ends(mask: cython.const[cython.uchar][:, :]) -> NDArray[np.intp]:  # type: ignore[valid-type]
    """The rows of a `mask` (rows, columns) that have cells, and the columns of the first and last of each (3, k)."""
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    marked = np.empty((3, mask.shape[0]), dtype=np.intp)
    end: cython.Py_ssize_t[:, ::1] = marked
    for row in range(mask.shape[0]):
        first: cython.Py_ssize_t = 0
        last: cython.Py_ssize_t = mask.shape[1] - 1
        while first <= last and not mask[row, first]:
            first += 1
        while first < last and not mask[row, last]:
            last -= 1
        if first <= last:
            end[0, found], end[1, found], end[2, found] = row, first, last
            found += 1
    return marked[:, :found]


@cython.cfunc
def _octagon(points: cython.const[cython.double][:, :]) -> cython.double[:, ::1]:  # type: ignore[valid-type]
    """Outward normals and offsets (8, 3) of the octagon's sides; none lies outside one without a length.

    Of points without an extent all count as outside.
    """
    row: cython.Py_ssize_t
    way: cython.Py_ssize_t
    ways: cython.double[:, ::1] = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0]])
    farthest: cython.double[::1] = np.full(8, -math.inf)
    corner: cython.Py_ssize_t[::1] = np.zeros(8, dtype=np.intp)
    for row in range(points.shape[0]):
        for way in range(4):
            reach: cython.double = ways[way, 0] * points[row, 0] + ways[way, 1] * points[row, 1]
            if reach > farthest[way]:
                farthest[way], corner[way] = reach, row
            if -reach > farthest[way + 4]:
                farthest[way + 4], corner[way + 4] = -reach, row
    extent: cython.double = max(farthest[0] + farthest[4], farthest[2] + farthest[6])
    sides: cython.double[:, ::1] = np.zeros((8, 3))
    if not extent > 0:
        return sides
    for way in range(8):
        here: cython.Py_ssize_t = corner[way]
        there: cython.Py_ssize_t = corner[(way + 1) % 8]
        x: cython.double = points[there, 1] - points[here, 1]
        y: cython.double = points[here, 0] - points[there, 0]
        length: cython.double = sqrt(x * x + y * y)
        sides[way, 0], sides[way, 1] = x, y
        sides[way, 2] = x * points[here, 0] + y * points[here, 1] - SURELY * extent * length if length > 0 else math.inf
    return sides
