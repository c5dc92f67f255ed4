"""A disc that rolls around points: which of those in a pixel it touches."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import hypot
from numpy.typing import NDArray


def marked(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    origin: cython.const[cython.double][:],  # type: ignore[valid-type]
    pixel: cython.double,
    empty: cython.uchar[:, ::1],
) -> NDArray[np.intp]:
    """The flat index (n,) of the pixel that each of the `points` (n, 2) lies in; it is marked by a 0. Rows go along y.

    The image `empty` (rows, columns) has a rim of one pixel around what begins at the `origin` (2,).
    """
    point: cython.Py_ssize_t
    found = np.empty(points.shape[0], dtype=np.intp)
    place: cython.Py_ssize_t[::1] = found
    for point in range(points.shape[0]):
        column: cython.Py_ssize_t = cython.cast(cython.Py_ssize_t, (points[point, 0] - origin[0]) / pixel + 1)
        row: cython.Py_ssize_t = cython.cast(cython.Py_ssize_t, (points[point, 1] - origin[1]) / pixel + 1)
        empty[row, column] = 0
        place[point] = empty.shape[1] * row + column
    return found


def without_notches(
    ring: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    widest: cython.double,
) -> NDArray[np.float64]:
    """The `ring` (k, 2) without its vertices at which it turns right between two that are no farther apart.

    Of two such neighbours only the first goes.
    """
    vertex: cython.Py_ssize_t
    count: cython.Py_ssize_t = ring.shape[0]
    found: cython.Py_ssize_t = 0
    left = np.empty((count, 2))
    kept: cython.double[:, ::1] = left
    was: cython.bint = False
    for vertex in range(count):
        before: cython.Py_ssize_t = vertex - 1 if vertex > 0 else count - 1
        after: cython.Py_ssize_t = vertex + 1 if vertex + 1 < count else 0
        ax: cython.double = ring[vertex, 0] - ring[before, 0]
        ay: cython.double = ring[vertex, 1] - ring[before, 1]
        bx: cython.double = ring[after, 0] - ring[vertex, 0]
        by: cython.double = ring[after, 1] - ring[vertex, 1]
        dx: cython.double = ring[after, 0] - ring[before, 0]
        dy: cython.double = ring[after, 1] - ring[before, 1]
        notch: cython.bint = ax * by - ay * bx < 0 and hypot(dx, dy) <= widest
        if not notch or was:
            kept[found, 0], kept[found, 1] = ring[vertex, 0], ring[vertex, 1]
            found += 1
        was = notch
    smooth: NDArray[np.float64] = left[:found]
    return smooth


def outermost(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    label: cython.const[cython.int][:],  # type: ignore[valid-type]
    touched: cython.const[cython.int][:],  # type: ignore[valid-type]
    path: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    labels: cython.Py_ssize_t,
) -> NDArray[np.intp]:
    """Of the `points` (n, 2) in each pixel the one nearest to the disc that touches it, by the pixel's label (labels,).

    `label` (n,) is that of each point's pixel. A disc whose centre is at `path` (m, 2) touches a point in the pixel
    `touched` (m,); of several the last counts, and of points as near as each other.
    """
    step: cython.Py_ssize_t
    point: cython.Py_ssize_t
    owner = np.zeros(labels, dtype=np.intp)
    owners: cython.Py_ssize_t[::1] = owner
    least: cython.double[::1] = np.full(labels, math.inf)
    centers: cython.Py_ssize_t[::1] = np.full(labels, -1, dtype=np.intp)
    for step in range(touched.shape[0]):
        centers[touched[step]] = step
    for point in range(points.shape[0]):
        name: cython.int = label[point]
        if centers[name] < 0:
            continue
        dx: cython.double = points[point, 0] - path[centers[name], 0]
        dy: cython.double = points[point, 1] - path[centers[name], 1]
        square: cython.double = dx * dx + dy * dy
        if square <= least[name]:
            least[name], owners[name] = square, point
    return owner
