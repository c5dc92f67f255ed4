"""A surface in the cells of the sensor's image: what each of them shows, its normals, and where it bends.

Images are (rows, columns); cells that show nothing have an infinite depth. The surface goes on from a cell to another
one if the depth between them changes by less than `jump` for each cell of the way.
"""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
LEAST_SPREAD = cython.declare(cython.double, 1e-3)
"""Neighbours that lie on a line have no plane: least determinant of their spread, over the square of its trace."""


def nearest_means(
    values: cython.double[:, ::1],
    cell: cython.Py_ssize_t[::1],
    cells: cython.Py_ssize_t,
    jump: cython.double,
) -> NDArray[np.float64]:
    """Means (v, cells) of the `values` (v, n), the first of which is a depth, of those points in each `cell` (n,).

    Only points that are less than a `jump` deeper than the nearest of the cell count; infinity where there are none.
    """
    point: cython.Py_ssize_t
    value: cython.Py_ssize_t
    nearest: cython.double[::1] = np.full(cells, math.inf)
    count: cython.double[::1] = np.zeros(cells)
    means = np.zeros((values.shape[0], cells))
    total: cython.double[:, ::1] = means
    for point in range(values.shape[1]):
        nearest[cell[point]] = min(nearest[cell[point]], values[0, point])
    for point in range(values.shape[1]):
        if values[0, point] < nearest[cell[point]] + jump:
            count[cell[point]] += 1.0
            for value in range(values.shape[0]):
                total[value, cell[point]] += values[value, point]
    for point in range(cells):
        for value in range(values.shape[0]):
            total[value, point] = total[value, point] / count[point] if count[point] > 0 else INFINITY
    return means


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _goes_on(
    depth: cython.double[:, ::1],
    row: cython.Py_ssize_t,
    column: cython.Py_ssize_t,
    down: cython.Py_ssize_t,
    right: cython.Py_ssize_t,
    jump: cython.double,
) -> cython.bint:
    """Whether the surface goes on from a cell to the one so many rows and columns further."""
    if row + down < 0 or row + down >= depth.shape[0] or column + right < 0 or column + right >= depth.shape[1]:
        return False
    apart: cython.double = abs(depth[row + down, column + right] - depth[row, column])
    steps: cython.double = down * down + right * right
    return apart < sqrt(steps) * jump  # false for NaN, the difference of infinities


def smooth_to(
    depth: cython.double[:, ::1], down: cython.Py_ssize_t, right: cython.Py_ssize_t, jump: cython.double
) -> NDArray[np.bool_]:
    """Whether (rows, columns) the surface goes on from each cell to the one so many rows and columns further."""
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    found = np.empty((depth.shape[0], depth.shape[1]), dtype=np.uint8)
    smooth: cython.uchar[:, ::1] = found
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            smooth[row, column] = _goes_on(depth, row, column, down, right, jump)
    return found.view(np.bool_)


def normals(
    x: cython.double[:, ::1],
    y: cython.double[:, ::1],
    depth: cython.double[:, ::1],
    jump: cython.double,
    least_neighbours: cython.double,
) -> NDArray[np.float64]:
    """Unit normals toward the sensor (3, rows, columns), of planes through 3 × 3 cells; 0 where there are none.

    Cells are at x and y in the image. A plane a·X = 1 has the inverse depth a·(x, y, 1), which is fitted by least
    squares where there are more than so many neighbours that the surface goes on to, and not all on a line.
    """
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    sums: cython.double[::1] = np.empty(9)
    found = np.zeros((3, depth.shape[0], depth.shape[1]))
    normal: cython.double[:, :, ::1] = found
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            if depth[row, column] == INFINITY:
                continue
            _sums(x, y, depth, row, column, jump, sums)
            count: cython.double = sums[8]
            u: cython.double = sums[0]
            v: cython.double = sums[1]
            w: cython.double = sums[2]
            uu: cython.double = sums[3] - u * u / count
            uv: cython.double = sums[4] - u * v / count
            vv: cython.double = sums[5] - v * v / count
            uw: cython.double = sums[6] - u * w / count
            vw: cython.double = sums[7] - v * w / count
            spread: cython.double = uu * vv - uv * uv
            if count <= least_neighbours or spread <= LEAST_SPREAD * (uu + vv) ** 2:
                continue
            along_x: cython.double = (uw * vv - vw * uv) / spread
            along_y: cython.double = (vw * uu - uw * uv) / spread
            level: cython.double = 1.0 / depth[row, column] + (w - along_x * u - along_y * v) / count
            level = level - along_x * x[row, column] - along_y * y[row, column]
            length: cython.double = max(sqrt(along_x * along_x + along_y * along_y + level * level), 1e-12)
            normal[0, row, column] = -along_x / length
            normal[1, row, column] = -along_y / length
            normal[2, row, column] = -level / length
    return found


@cython.cfunc
def _sums(
    x: cython.double[:, ::1],
    y: cython.double[:, ::1],
    depth: cython.double[:, ::1],
    row: cython.Py_ssize_t,
    column: cython.Py_ssize_t,
    jump: cython.double,
    sums: cython.double[::1],
) -> cython.void:
    """Write the sums of du, dv, dw, du², du·dv, dv², du·dw, dv·dw and 1 over a cell and its neighbours, w = 1/depth."""
    down: cython.Py_ssize_t
    right: cython.Py_ssize_t
    index: cython.Py_ssize_t
    for index in range(8):
        sums[index] = 0.0
    sums[8] = 1.0
    for down in range(-1, 2):
        for right in range(-1, 2):
            if (down == 0 and right == 0) or not _goes_on(depth, row, column, down, right, jump):
                continue
            du: cython.double = x[row + down, column + right] - x[row, column]
            dv: cython.double = y[row + down, column + right] - y[row, column]
            dw: cython.double = 1.0 / depth[row + down, column + right] - 1.0 / depth[row, column]
            sums[0] += du
            sums[1] += dv
            sums[2] += dw
            sums[3] += du * du
            sums[4] += dv * du
            sums[5] += dv * dv
            sums[6] += dw * du
            sums[7] += dw * dv
            sums[8] += 1.0


def sharpest_bends(
    places: cython.double[:, :, ::1],
    normal: cython.double[:, :, ::1],
    has_normal: cython.uchar[:, ::1],
    depth: cython.double[:, ::1],
    jump: cython.double,
    reach: cython.Py_ssize_t,
) -> NDArray[np.float64]:
    """The most concave bend (rows, columns) at each cell, along four lines, between cells `reach` to either side; ≤ 0.

    With normals n1, n2 at places x1, x2 there, (3, rows, columns) each, a bend is (n2 − n1) · (x2 − x1) / |x2 − x1|.
    """
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    line: cython.Py_ssize_t
    axis: cython.Py_ssize_t
    found = np.zeros((depth.shape[0], depth.shape[1]))
    sharpest: cython.double[:, ::1] = found
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            if depth[row, column] == INFINITY:
                continue
            for line in range(4):  # right, down, and aslant
                down: cython.Py_ssize_t = 0 if line == 0 else reach
                right: cython.Py_ssize_t = reach * (0 if line == 1 else 1 if line < 3 else -1)
                if not _goes_on(depth, row, column, down, right, jump):
                    continue
                if not _goes_on(depth, row, column, -down, -right, jump):
                    continue
                if not has_normal[row + down, column + right] or not has_normal[row - down, column - right]:
                    continue
                length: cython.double = 0.0
                bend: cython.double = 0.0
                for axis in range(3):
                    way: cython.double = places[axis, row + down, column + right]
                    way -= places[axis, row - down, column - right]
                    turn: cython.double = normal[axis, row + down, column + right]
                    turn -= normal[axis, row - down, column - right]
                    length += way * way
                    bend += turn * way
                sharpest[row, column] = min(sharpest[row, column], bend / max(sqrt(length), 1e-9))
    return found
