"""What is asked of all the points of a frame: one pass over them, and nothing is written unless it is an answer."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray


@cython.cfunc
def _with(
    rows: cython.Py_ssize_t[::1], found: cython.Py_ssize_t, row: cython.Py_ssize_t, most: cython.Py_ssize_t
) -> cython.Py_ssize_t[::1]:
    """The `rows`, of which so many are `found`, with one more; the first makes place for as many as there can be."""
    if found == 0:
        rows = np.empty(most, dtype=np.intp)
    rows[found] = row
    return rows


def measured(
    x: cython.const[cython.floating][:],  # type: ignore[valid-type]
    y: cython.const[cython.floating][:],  # type: ignore[valid-type]
    z: cython.const[cython.floating][:],  # type: ignore[valid-type]
    scale: cython.double,
    farthest: cython.double,
    filled: cython.uchar[::1],
) -> NDArray[np.float64]:
    """Points (k, 3) of n given as columns x, y and z (n,), times a `scale`: those that `not_measured` does not name.

    Written is which of them that are, `filled` (n,).
    """
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    points = np.empty((x.shape[0], 3))
    point: cython.double[:, ::1] = points
    for row in range(x.shape[0]):
        px: cython.double = scale * x[row]
        py: cython.double = scale * y[row]
        pz: cython.double = scale * z[row]
        filled[row] = _was_measured(px, py, pz, farthest)
        if filled[row]:
            point[found, 0], point[found, 1], point[found, 2] = px, py, pz
            found += 1
    return points[:found]


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _was_measured(x: cython.double, y: cython.double, z: cython.double, farthest: cython.double) -> cython.bint:
    """Whether a point is finite, near, and not exactly 0 0 0."""
    near_enough: cython.bint = abs(x) <= farthest and abs(y) <= farthest and abs(z) <= farthest  # false for NaN, too
    return near_enough and not (x == 0 and y == 0 and z == 0)


def not_measured(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    farthest: cython.double,
) -> NDArray[np.intp]:
    """Rows of `points` (n, 3) that are not finite, exactly 0 0 0, or have a coordinate beyond ±`farthest`."""
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    lost: cython.Py_ssize_t[::1] = np.empty(0, dtype=np.intp)
    for row in range(points.shape[0]):
        x: cython.double = points[row, 0]
        y: cython.double = points[row, 1]
        z: cython.double = points[row, 2]
        if not _was_measured(x, y, z, farthest):
            lost = _with(lost, found, row, points.shape[0])
            found += 1
    return np.asarray(lost[:found])


def outside(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    low: cython.double[::1],
    high: cython.double[::1],
) -> NDArray[np.intp]:
    """Rows of `points` (n, 3) outside the box between `low` and `high` (3,)."""
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    lost: cython.Py_ssize_t[::1] = np.empty(0, dtype=np.intp)
    for row in range(points.shape[0]):
        flat: cython.bint = low[0] <= points[row, 0] <= high[0] and low[1] <= points[row, 1] <= high[1]
        if not flat or not low[2] <= points[row, 2] <= high[2]:
            lost = _with(lost, found, row, points.shape[0])
            found += 1
    return np.asarray(lost[:found])


def between(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    low: cython.double[::1],
    high: cython.double[::1],
) -> NDArray[np.intp]:
    """Rows of `points` (n, 3) inside the box between `low` and `high` (3,), and not on its faces."""
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    kept: cython.Py_ssize_t[::1] = np.empty(points.shape[0], dtype=np.intp)
    for row in range(points.shape[0]):
        if not low[0] < points[row, 0] < high[0] or not low[1] < points[row, 1] < high[1]:
            continue
        if low[2] < points[row, 2] < high[2]:
            kept[found] = row
            found += 1
    return np.asarray(kept[:found])


def near(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    place: cython.double[::1],
    distance: cython.double,
) -> NDArray[np.intp]:
    """Rows of `points` (n, 3) that are nearer than a `distance` to a `place` (3,)."""
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    close: cython.Py_ssize_t[::1] = np.empty(0, dtype=np.intp)
    for row in range(points.shape[0]):
        x: cython.double = points[row, 0] - place[0]
        if abs(x) >= distance:
            continue
        y: cython.double = points[row, 1] - place[1]
        z: cython.double = points[row, 2] - place[2]
        if sqrt(x * x + y * y + z * z) < distance:
            close = _with(close, found, row, points.shape[0])
            found += 1
    return np.asarray(close[:found])


def mean(points: cython.const[cython.double][:, :]) -> NDArray[np.float64]:  # type: ignore[valid-type]
    """The mean (c,) of `points` (n, c) in the plane or in space."""
    row: cython.Py_ssize_t
    last: cython.Py_ssize_t = points.shape[1] - 1
    x: cython.double = 0.0
    y: cython.double = 0.0
    z: cython.double = 0.0
    for row in range(points.shape[0]):
        x += points[row, 0]
        y += points[row, 1]
        z += points[row, last]
    found: NDArray[np.float64] = np.array([x, y, z][: last + 1]) / points.shape[0]
    return found


def bounds(points: cython.const[cython.double][:, :]) -> NDArray[np.float64]:  # type: ignore[valid-type]
    """The least and the largest coordinates (2, c) of `points` (n, c)."""
    row: cython.Py_ssize_t
    axis: cython.Py_ssize_t
    found = np.empty((2, points.shape[1]))
    bound: cython.double[:, ::1] = found
    for axis in range(points.shape[1]):
        low: cython.double = math.inf
        high: cython.double = -math.inf
        for row in range(points.shape[0]):
            low, high = min(low, points[row, axis]), max(high, points[row, axis])
        bound[0, axis], bound[1, axis] = low, high
    return found
