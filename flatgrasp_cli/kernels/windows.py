"""Means over cells of a raster, and over square windows of them: sums run along, so that their size does not matter."""

from __future__ import annotations

import cython
import numpy as np
from numpy.typing import NDArray


def of_cells(
    total: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    count: cython.const[cython.Py_ssize_t][:, ::1],  # type: ignore[valid-type]
) -> NDArray[np.float64]:
    """Mean (rows, columns) of what is summed up in `total` and counted in `count` in each cell; 0 where nothing is."""
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    found = np.zeros((total.shape[0], total.shape[1]))
    mean: cython.double[:, ::1] = found
    for row in range(total.shape[0]):
        for column in range(total.shape[1]):
            if count[row, column] > 0:
                mean[row, column] = total[row, column] / count[row, column]
    return found


def means(
    total: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    count: cython.const[cython.Py_ssize_t][:, ::1],  # type: ignore[valid-type]
    cells: cython.Py_ssize_t,
) -> NDArray[np.float64]:
    """Mean (rows, columns) of what is summed up in `total` and counted in `count` in the windows around cells.

    Windows are `cells` × `cells`, an odd number, as far as they lie in the raster; of those without a count it is 0.
    """
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    rows: cython.Py_ssize_t = total.shape[0]
    columns: cython.Py_ssize_t = total.shape[1]
    half: cython.Py_ssize_t = cells // 2
    # of each column the rows of a window, with as many empty columns as it reaches beyond the raster on both sides
    held: cython.double[::1] = np.zeros(columns + 2 * half + 1)
    counted: cython.Py_ssize_t[::1] = np.zeros(columns + 2 * half + 1, dtype=np.intp)
    found = np.empty((rows, columns))
    mean: cython.double[:, ::1] = found
    for row in range(-half, rows):
        if row + half < rows:
            for column in range(columns):
                held[column + half] += total[row + half, column]
                counted[column + half] += count[row + half, column]
        if row - half > 0:
            for column in range(columns):
                held[column + half] -= total[row - half - 1, column]
                counted[column + half] -= count[row - half - 1, column]
        if row < 0:
            continue
        sum_held: cython.double = 0.0
        sum_counted: cython.Py_ssize_t = 0
        for column in range(2 * half):
            sum_held += held[column]
            sum_counted += counted[column]
        for column in range(columns):
            sum_held += held[column + 2 * half]
            sum_counted += counted[column + 2 * half]
            mean[row, column] = sum_held / sum_counted if sum_counted > 0 else 0.0
            sum_held -= held[column]
            sum_counted -= counted[column]
    return found
