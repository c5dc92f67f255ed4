"""The cells of a raster that places fall into, and what it holds there."""

from __future__ import annotations

import cython
import numpy as np
from numpy.typing import NDArray


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
