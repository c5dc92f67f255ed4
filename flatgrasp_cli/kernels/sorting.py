"""A frame's points sorted into the cells of a plane: read once, from coordinates to cells."""

from __future__ import annotations

import cython
import numpy as np
from numpy.typing import NDArray


def into_cells(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    frame: cython.double[:, ::1],
    grid: cython.double[::1],
    shape: cython.Py_ssize_t[::1],
    limits: cython.double[::1],
    cell: cython.int[::1],
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """How many of the `points` (n, 3) each cell holds, and the sum of their heights, (rows, columns) each.

    The rows of the `frame` (3, 4) are the plane's x, y and normal with the origin's place along them; the `grid` (3,)
    is where its cells begin, and their size, and `shape` (2,) how many there are, rows and columns, with a rim that
    holds nothing. Heights are cut off at the second of the `limits` (2,). Written is the flat index `cell` (n,) of each
    point, 0 for those outside or not above the first of the limits.
    """
    row: cython.Py_ssize_t
    rows: cython.Py_ssize_t = shape[0]
    columns: cython.Py_ssize_t = shape[1]
    count = np.zeros((rows, columns), dtype=np.intp)
    total = np.zeros((rows, columns))
    counted: cython.Py_ssize_t[::1] = count.reshape(-1)
    summed: cython.double[::1] = total.reshape(-1)
    # numbers that no array holds: a compiler cannot know that writing to one does not change another
    low_x, low_y, size, lowest, highest = grid[0], grid[1], grid[2], limits[0], limits[1]
    xx, xy, xz, x0 = frame[0, 0], frame[0, 1], frame[0, 2], frame[0, 3]
    yx, yy, yz, y0 = frame[1, 0], frame[1, 1], frame[1, 2], frame[1, 3]
    zx, zy, zz, z0 = frame[2, 0], frame[2, 1], frame[2, 2], frame[2, 3]
    for row in range(points.shape[0]):
        px: cython.double = points[row, 0]
        py: cython.double = points[row, 1]
        pz: cython.double = points[row, 2]
        height: cython.double = px * zx + py * zy + pz * zz - z0
        down: cython.double = (px * xx + py * xy + pz * xz - x0 - low_x) / size
        right: cython.double = (px * yx + py * yy + pz * yz - y0 - low_y) / size
        place: cython.Py_ssize_t = 0
        if 1 <= down < rows - 1 and 1 <= right < columns - 1 and height > lowest:
            place = columns * cython.cast(cython.Py_ssize_t, down) + cython.cast(cython.Py_ssize_t, right)
            counted[place] += 1
            summed[place] += min(height, highest)
        cell[row] = place
    return count, total


def standing(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    cell: cython.const[cython.int][::1],  # type: ignore[valid-type]
    floor: cython.const[cython.double][::1],  # type: ignore[valid-type]
    normal: cython.double[::1],
    highest: cython.double,
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Rows (k,) of the `points` (n, 3) that are higher than the `floor` (cells,) of their `cell` (n,), and how high.

    Heights are those over the plane of a `normal` (4,), its place along it last, and cut off at the `highest`. Where
    nothing stands the floor is infinite.
    """
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    rows: cython.Py_ssize_t[::1] = np.empty(points.shape[0], dtype=np.intp)
    heights: cython.double[::1] = np.empty(points.shape[0])
    for row in range(points.shape[0]):
        if floor[cell[row]] >= highest:
            continue
        height: cython.double = points[row, 0] * normal[0] + points[row, 1] * normal[1] + points[row, 2] * normal[2]
        height = min(height - normal[3], highest)
        if height > floor[cell[row]]:
            rows[found], heights[found] = row, height
            found += 1
    return np.asarray(rows[:found]), np.asarray(heights[:found])


def from_above(
    cell: cython.Py_ssize_t[::1],
    heights: cython.double[::1],
    names: cython.Py_ssize_t[::1],
    owner: cython.Py_ssize_t[::1],
    highest: cython.double[::1],
) -> None:
    """Write the `highest` of the points in each `cell` (n,), by their `heights` (n,), and who owns it, by `names` (n,).

    What the cells (cells,) hold already counts, too; of points as high as each other the last one is seen.
    """
    point: cython.Py_ssize_t
    for point in range(cell.shape[0]):
        if heights[point] >= highest[cell[point]]:
            highest[cell[point]], owner[cell[point]] = heights[point], names[point]
