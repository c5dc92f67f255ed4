"""What concave seams, jumps and gaps leave of a surface: its pieces."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.scene.parting.seams import seam_cells
from flatgrasp_cli.scene.parting.view_grid import ViewGrid, shifted

LEAST_CELL_M = 0.003
"""Of cells; a finger's width holds a few of them."""
POINTS_ACROSS = 2.0
"""Points along a cell's side, at least, so that hardly one is empty."""
SURE_SIGMAS = 4.0
"""A bend is told from noise by so many of its standard deviations."""
DOWN, RIGHT = (1, 0), (0, 1)
CORE_CELLS = 6
"""Cells of a piece, at least, that lie in no seam: fewer may be noise."""
MOST_FLOODS = 100
"""Cells in a row that a seam may be wide."""


def pieces(
    points: FloatArray, viewpoint: FloatArray, spacing_m: float, noise_m: float, *, seam_deg: float, least_m: float
) -> IntArray:
    """Names (n,) from 1 of the pieces of the surface that `points` (n, 3) lie on; 0 for those that belong to none.

    The points lie `spacing_m` apart and scatter by `noise_m` along the ray from `viewpoint` (3,). A seam is a concave
    bend of more than `seam_deg`; a piece whose area, seen from there, is less than a square of side `least_m` belongs
    to the one beside it.
    """
    cell_m = max(LEAST_CELL_M, POINTS_ACROSS * spacing_m, fitting_cell_m(spacing_m, noise_m, seam_deg))
    grid = ViewGrid.of(points, viewpoint, cell_m, noise_m)
    names = _connected(grid, grid.known & ~seam_cells(grid, seam_deg))
    names = _flooded(grid, _of_size(names, CORE_CELLS))
    small = names - _of_size(names, (least_m / grid.cell_m) ** 2)
    names = _flooded(grid, names - small)
    return np.asarray(np.where(names > 0, names, small).ravel()[grid.cell])


def _of_size(names: IntArray, cells: float) -> IntArray:
    """The names of pieces of so many cells, 0 for those of smaller ones."""
    large = np.bincount(names.ravel()) >= cells
    large[0] = False
    return np.asarray(large[names] * names)


def fitting_cell_m(spacing_m: float, noise_m: float, seam_deg: float) -> float:
    """Side of cells whose normals are so sure that noise makes no seam of `seam_deg`.

    The mean of the (c/s)² points in a cell of side c scatters by σ s/c, the slope of a plane through 3 × 3 such cells by
    σ s/(√6 c²), and the difference of two slopes by √2 times that.
    """
    return float(np.sqrt(SURE_SIGMAS * np.sqrt(2 / 6) * noise_m * spacing_m / np.radians(seam_deg)))


def _connected(grid: ViewGrid, free: BoolArray) -> IntArray:
    """Names (rows, columns) from 1 of the pieces of `free` cells that no jump parts; 0 for the others.

    Between the cells of an image of twice the size lie those of its connections.
    """
    rows, columns = free.shape
    double = np.zeros((2 * rows, 2 * columns), dtype=np.uint8)
    double[::2, ::2] = free
    double[1::2, ::2] = free & shifted(free, DOWN) & grid.smooth_to(DOWN)
    double[::2, 1::2] = free & shifted(free, RIGHT) & grid.smooth_to(RIGHT)
    return np.asarray(cv2.connectedComponents(double, connectivity=4)[1][::2, ::2], dtype=np.intp)


def _flooded(grid: ViewGrid, names: IntArray) -> IntArray:
    """The names spread, cell by cell, over what has none: each takes that of its nearest neighbour in space."""
    sides = []
    places = grid.places()
    for step in (DOWN, RIGHT, (-1, 0), (0, -1)):
        apart = np.sqrt(((shifted(places, step) - places) ** 2).sum(axis=0))
        sides.append((step, np.where(grid.smooth_to(step), apart, np.inf)))
    for _ in range(MOST_FLOODS):
        waiting = grid.known & (names == 0)
        spread, nearest = names.copy(), np.full(names.shape, np.inf)
        for step, apart in sides:
            name = shifted(names, step)
            closer = waiting & (name > 0) & (apart < nearest)
            spread[closer], nearest[closer] = name[closer], apart[closer]
        if (spread == names).all():
            break
        names = spread
    return names
