"""How far from points of the plane their neighbours lie."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
POINTS_PER_CELL = cython.declare(cython.double, 1.0)
"""Points in a cell of the grid in which neighbours are looked for: it decides how long that takes, and nothing else."""


def squared_reach(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    chosen: cython.const[cython.Py_ssize_t][::1],  # type: ignore[valid-type]
    count: cython.Py_ssize_t,
) -> NDArray[np.float32]:
    """Square (m,) of how far from each of the `chosen` (m,) `points` (n, 2) the farthest of its nearest `count` lies.

    The point itself is one of them. Single precision is enough.
    """
    index: cython.Py_ssize_t
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    ring: cython.Py_ssize_t
    grid: cython.double[::1] = _grid(points)
    rows: cython.Py_ssize_t = cython.cast(cython.Py_ssize_t, grid[3])
    columns: cython.Py_ssize_t = cython.cast(cython.Py_ssize_t, grid[4])
    begin: cython.Py_ssize_t[::1] = np.zeros(rows * columns + 1, dtype=np.intp)
    places: cython.float[:, ::1] = np.empty((points.shape[0], 2), dtype=np.float32)
    _sort(points, grid, begin, places)
    nearest: cython.float[::1] = np.empty(count, dtype=np.float32)
    found = np.empty(chosen.shape[0], dtype=np.float32)
    answer: cython.float[::1] = found
    for index in range(chosen.shape[0]):
        x: cython.float = points[chosen[index], 0]
        y: cython.float = points[chosen[index], 1]
        row = _step(x, grid[0], grid[5])
        column = _step(y, grid[1], grid[5])
        for ring in range(count):
            nearest[ring] = INFINITY
        for ring in range(max(rows, columns)):
            _around(places, begin, grid, row, column, ring, x, y, nearest)
            if nearest[count - 1] <= (ring * grid[2]) ** 2:  # all that is nearer lies in these rings
                break
        answer[index] = nearest[count - 1]
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _step(place: cython.float, low: cython.double, per_cell: cython.double) -> cython.Py_ssize_t:
    """The row or column that holds a place."""
    return cython.cast(cython.Py_ssize_t, (place - low) * per_cell)


@cython.cfunc
def _grid(points: cython.const[cython.double][:, :]) -> cython.double[::1]:  # type: ignore[valid-type]
    """A grid over the points (6,): its origin, the size of cells, how many rows and columns, and the size's inverse."""
    point: cython.Py_ssize_t
    count: cython.double = points.shape[0]
    low_x: cython.float = INFINITY
    low_y: cython.float = INFINITY
    high_x: cython.float = -INFINITY
    high_y: cython.float = -INFINITY
    for point in range(points.shape[0]):
        x: cython.float = points[point, 0]
        y: cython.float = points[point, 1]
        low_x, high_x = min(low_x, x), max(high_x, x)
        low_y, high_y = min(low_y, y), max(high_y, y)
    grid: cython.double[::1] = np.array([low_x, low_y, 0.0, 1.0, 1.0, 1.0])
    wide: cython.double = cython.cast(cython.double, high_x) - grid[0]
    long: cython.double = cython.cast(cython.double, high_y) - grid[1]
    grid[2] = max(sqrt(POINTS_PER_CELL * wide * long / count), max(wide, long) / count)
    if grid[2] <= 0:
        grid[2] = 1.0
    grid[5] = 1.0 / grid[2]
    grid[3] = 1.0 + _step(high_x, grid[0], grid[5])
    grid[4] = 1.0 + _step(high_y, grid[1], grid[5])
    return grid


@cython.cfunc
def _sort(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    grid: cython.double[::1],
    begin: cython.Py_ssize_t[::1],
    places: cython.float[:, ::1],
) -> cython.void:
    """Write the points into `places` cell by cell, and where each cell's `begin`."""
    point: cython.Py_ssize_t
    cell: cython.Py_ssize_t
    cells: cython.Py_ssize_t[::1] = np.empty(points.shape[0], dtype=np.intp)
    columns: cython.Py_ssize_t = cython.cast(cython.Py_ssize_t, grid[4])
    for point in range(points.shape[0]):
        cell = columns * _step(points[point, 0], grid[0], grid[5]) + _step(points[point, 1], grid[1], grid[5])
        cells[point] = cell
        begin[cell + 1] += 1
    for cell in range(begin.shape[0] - 1):
        begin[cell + 1] += begin[cell]
    for point in range(points.shape[0] - 1, -1, -1):  # each cell from its end on, which then is its begin
        cell = cells[point]
        begin[cell + 1] -= 1
        places[begin[cell + 1], 0], places[begin[cell + 1], 1] = points[point, 0], points[point, 1]
    for cell in range(begin.shape[0] - 1):
        begin[cell] = begin[cell + 1]
    begin[begin.shape[0] - 1] = points.shape[0]


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _around(
    places: cython.float[:, ::1],
    begin: cython.Py_ssize_t[::1],
    grid: cython.double[::1],
    row: cython.Py_ssize_t,
    column: cython.Py_ssize_t,
    ring: cython.Py_ssize_t,
    x: cython.float,
    y: cython.float,
    nearest: cython.float[::1],
) -> cython.void:
    """Sort the squared distances of the points in the cells of a ring into those of the `nearest`."""
    down: cython.Py_ssize_t
    rows: cython.Py_ssize_t = cython.cast(cython.Py_ssize_t, grid[3])
    columns: cython.Py_ssize_t = cython.cast(cython.Py_ssize_t, grid[4])
    left: cython.Py_ssize_t = max(column - ring, 0)
    right: cython.Py_ssize_t = min(column + ring, columns - 1)
    for down in range(max(row - ring, 0), min(row + ring, rows - 1) + 1):
        first: cython.Py_ssize_t = down * columns
        if down == row - ring or down == row + ring:  # the cells of a row are neighbours, and so are their points
            _nearer(places, begin[first + left], begin[first + right + 1], x, y, nearest)
            continue
        if column >= ring:
            _nearer(places, begin[first + left], begin[first + left + 1], x, y, nearest)
        if column + ring < columns:
            _nearer(places, begin[first + right], begin[first + right + 1], x, y, nearest)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _nearer(
    places: cython.float[:, ::1],
    begin: cython.Py_ssize_t,
    end: cython.Py_ssize_t,
    x: cython.float,
    y: cython.float,
    nearest: cython.float[::1],
) -> cython.void:
    """Sort the squared distances of the places from `begin` to `end` into those of the `nearest`."""
    point: cython.Py_ssize_t
    rank: cython.Py_ssize_t
    last: cython.Py_ssize_t = nearest.shape[0] - 1
    for point in range(begin, end):
        dx: cython.float = places[point, 0] - x
        dy: cython.float = places[point, 1] - y
        square: cython.float = dx * dx + dy * dy
        rank = last
        if square >= nearest[rank]:
            continue
        while rank > 0 and nearest[rank - 1] > square:
            nearest[rank] = nearest[rank - 1]
            rank -= 1
        nearest[rank] = square
