"""Names of pieces, cell by cell: which of them hold something, and how they spread over the cells between them."""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)


def flooded(
    names: cython.Py_ssize_t[::1],
    waiting: cython.Py_ssize_t[::1],
    steps: cython.Py_ssize_t[::1],
    smooth: cython.uchar[:, ::1],
    places: cython.double[:, ::1],
    normals: cython.double[:, ::1],
) -> NDArray[np.intp]:
    """The `names` (cells,), 0 where there is none, spread over the `waiting` (w,) cells, one cell further at a time.

    Of its neighbours, so many `steps` (s,) on in flat order, to which the surface goes on (`smooth`, (s, cells)), each
    joins the one whose plane, by `normals` (3, cells) from beyond the seam, its place, of `places` (3, cells), is
    nearest to.
    """
    index: cython.Py_ssize_t
    axis: cython.Py_ssize_t
    left: cython.Py_ssize_t = waiting.shape[0]
    kept: cython.Py_ssize_t
    found = np.array(names, dtype=np.intp)
    name: cython.Py_ssize_t[::1] = found
    turned: cython.double[:, ::1] = np.array(normals)
    cells: cython.Py_ssize_t[::1] = np.array(waiting, dtype=np.intp)
    source: cython.Py_ssize_t[::1] = np.empty(waiting.shape[0], dtype=np.intp)
    while True:
        for index in range(left):
            source[index] = _nearest(cells[index], name, steps, smooth, places, turned)
        kept = 0
        for index in range(left):  # those that wait on move up
            if source[index] < 0:
                cells[kept] = cells[index]
                kept += 1
                continue
            name[cells[index]] = name[source[index]]
            for axis in range(3):
                turned[axis, cells[index]] = turned[axis, source[index]]
        if kept == left:
            return found
        left = kept


@cython.cfunc
def _nearest(
    cell: cython.Py_ssize_t,
    name: cython.Py_ssize_t[::1],
    steps: cython.Py_ssize_t[::1],
    smooth: cython.uchar[:, ::1],
    places: cython.double[:, ::1],
    turned: cython.double[:, ::1],
) -> cython.Py_ssize_t:
    """The neighbour with a name that a cell joins, −1 if there is none."""
    side: cython.Py_ssize_t
    axis: cython.Py_ssize_t
    nearest: cython.Py_ssize_t = -1
    least: cython.double = INFINITY
    for side in range(steps.shape[0]):
        there: cython.Py_ssize_t = cell + steps[side]
        if not smooth[side, cell] or name[there] == 0:
            continue
        off: cython.double = 0.0
        for axis in range(3):
            off += (places[axis, cell] - places[axis, there]) * turned[axis, there]
        if abs(off) < least:
            least, nearest = abs(off), there
    return nearest


def holding(
    names: cython.const[cython.int][:, ::1],  # type: ignore[valid-type]
    core: cython.const[cython.uchar][:, ::1],  # type: ignore[valid-type]
    count: cython.Py_ssize_t,
) -> NDArray[np.bool_]:
    """Which cells (rows, columns) belong to pieces that hold some of the `core`, by `names` less than a count."""
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    holds: cython.uchar[::1] = np.zeros(count, dtype=np.uint8)
    found = np.empty((names.shape[0], names.shape[1]), dtype=np.uint8)
    kept: cython.uchar[:, ::1] = found
    for row in range(names.shape[0]):
        for column in range(names.shape[1]):
            if core[row, column]:
                holds[names[row, column]] = 1
    for row in range(names.shape[0]):
        for column in range(names.shape[1]):
            kept[row, column] = holds[names[row, column]]
    return found.view(np.bool_)


def from_nearest(
    values: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    nearest: cython.const[cython.int][:, ::1],  # type: ignore[valid-type]
    empty: cython.const[cython.uchar][:, ::1],  # type: ignore[valid-type]
) -> NDArray[np.float64]:
    """The `values` (rows, columns) with that of the nearest cell in those that are `empty`.

    `nearest` are numbers of the cells that are not, up to that of all cells, and those of the nearest ones in the rest.
    """
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    value_of: cython.double[::1] = np.zeros(values.shape[0] * values.shape[1] + 1)
    found = np.empty((values.shape[0], values.shape[1]))
    filled: cython.double[:, ::1] = found
    for row in range(values.shape[0]):
        for column in range(values.shape[1]):
            if not empty[row, column]:
                value_of[nearest[row, column]] = values[row, column]
    for row in range(values.shape[0]):
        for column in range(values.shape[1]):
            filled[row, column] = value_of[nearest[row, column]]
    return found
