"""The cells of a raster that places fall into, and what it holds there."""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

UNSEEN = cython.declare(cython.double, -math.inf)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _cell(
    place: cython.double, low: cython.double, cell_m: cython.double, count: cython.Py_ssize_t
) -> cython.Py_ssize_t:
    """The row or column that holds a place, out of `count` from `low`; those outside are on the rim."""
    return cython.cast(cython.Py_ssize_t, min(max((place - low) / cell_m, 0.0), count - 1.0))


def cells(
    x: cython.double[:],
    y: cython.double[:],
    origin: cython.double[::1],
    cell_m: cython.double,
    rows: cython.Py_ssize_t,
    columns: cython.Py_ssize_t,
) -> NDArray[np.intp]:
    """Flat indices (n,) of the cells that hold places x and y (n,), of a raster of `rows` × `columns` from `origin`."""
    place: cython.Py_ssize_t
    found = np.empty(x.shape[0], dtype=np.intp)
    cell: cython.Py_ssize_t[::1] = found
    for place in range(x.shape[0]):
        cell[place] = columns * _cell(x[place], origin[0], cell_m, rows)
        cell[place] += _cell(y[place], origin[1], cell_m, columns)
    return found


def over(
    values: cython.double[:, ::1],
    x: cython.double[:],
    y: cython.double[:],
    origin: cython.double[::1],
    cell_m: cython.double,
) -> NDArray[np.float64]:
    """The `values` (rows, columns) of a raster at places x and y (n,)."""
    place: cython.Py_ssize_t
    found = np.empty(x.shape[0])
    answer: cython.double[::1] = found
    for place in range(x.shape[0]):
        row: cython.Py_ssize_t = _cell(x[place], origin[0], cell_m, values.shape[0])
        answer[place] = values[row, _cell(y[place], origin[1], cell_m, values.shape[1])]
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _moved(
    values: cython.double[:, ::1],
    x: cython.const[cython.double][:],  # type: ignore[valid-type]
    y: cython.const[cython.double][:],  # type: ignore[valid-type]
    levels: cython.const[cython.double][:],  # type: ignore[valid-type]
    origin: cython.double[::1],
    cell_m: cython.double,
    upward: cython.bint,
) -> cython.void:
    """Move the `values` at places up to the highest, or down to the lowest, of the levels there."""
    place: cython.Py_ssize_t
    for place in range(x.shape[0]):
        row: cython.Py_ssize_t = _cell(x[place], origin[0], cell_m, values.shape[0])
        column: cython.Py_ssize_t = _cell(y[place], origin[1], cell_m, values.shape[1])
        value: cython.double = values[row, column]
        values[row, column] = max(value, levels[place]) if upward else min(value, levels[place])


def raised(
    values: cython.double[:, ::1],
    x: cython.const[cython.double][:],  # type: ignore[valid-type]
    y: cython.const[cython.double][:],  # type: ignore[valid-type]
    levels: cython.const[cython.double][:],  # type: ignore[valid-type]
    origin: cython.double[::1],
    cell_m: cython.double,
) -> None:
    """Raise the `values` (rows, columns) of a raster to the highest of the `levels` (n,) at places x and y (n,)."""
    _moved(values, x, y, levels, origin, cell_m, True)


def lowered(
    values: cython.double[:, ::1],
    x: cython.const[cython.double][:],  # type: ignore[valid-type]
    y: cython.const[cython.double][:],  # type: ignore[valid-type]
    levels: cython.const[cython.double][:],  # type: ignore[valid-type]
    origin: cython.double[::1],
    cell_m: cython.double,
) -> None:
    """Lower the `values` (rows, columns) of a raster to the lowest of the `levels` (n,) at places x and y (n,)."""
    _moved(values, x, y, levels, origin, cell_m, False)


def averaged(
    x: cython.const[cython.double][:],  # type: ignore[valid-type]
    y: cython.const[cython.double][:],  # type: ignore[valid-type]
    levels: cython.const[cython.double][:],  # type: ignore[valid-type]
    origin: cython.double[::1],
    cell_m: cython.double,
    means: cython.double[:, ::1],
) -> None:
    """Write the means (rows, columns) of the `levels` (n,) at places x and y (n,) into cells of a raster that have any.

    What the others hold stays.
    """
    place: cython.Py_ssize_t
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    count: cython.double[:, ::1] = np.zeros((means.shape[0], means.shape[1]))
    total: cython.double[:, ::1] = np.zeros((means.shape[0], means.shape[1]))
    for place in range(x.shape[0]):
        row = _cell(x[place], origin[0], cell_m, means.shape[0])
        column = _cell(y[place], origin[1], cell_m, means.shape[1])
        count[row, column] += 1.0
        total[row, column] += levels[place]
    for row in range(means.shape[0]):
        for column in range(means.shape[1]):
            if count[row, column] > 0:
                means[row, column] = total[row, column] / count[row, column]


def filled(
    heights: cython.double[:, ::1],
    cell_m: cython.double,
    corner: cython.const[cython.double][:],  # type: ignore[valid-type]
    along: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    ground: cython.double[:, ::1],
    origin: cython.double[::1],
    ground_cell_m: cython.double,
) -> None:
    """Write into the `heights` (rows, columns) that are −∞ what each cell's axis meets of the `ground` (…, …).

    That is heights over another plane, in cells of `ground_cell_m` from an `origin` (2,). In its frame the first cell's
    middle is at the `corner` (3,), and rows go along the first, columns along the second of the axes `along` (3, 3).
    """
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    for row in range(heights.shape[0]):
        for column in range(heights.shape[1]):
            if heights[row, column] != UNSEEN:
                continue
            down: cython.double = cell_m * row
            right: cython.double = cell_m * column
            x: cython.double = corner[0] + down * along[0, 0] + right * along[1, 0]
            y: cython.double = corner[1] + down * along[0, 1] + right * along[1, 1]
            way: cython.double = -(corner[2] + down * along[0, 2] + right * along[1, 2]) / along[2, 2]
            there: cython.Py_ssize_t = _cell(x + way * along[2, 0], origin[0], ground_cell_m, ground.shape[0])
            across: cython.Py_ssize_t = _cell(y + way * along[2, 1], origin[1], ground_cell_m, ground.shape[1])
            heights[row, column] = way + ground[there, across] / along[2, 2]
