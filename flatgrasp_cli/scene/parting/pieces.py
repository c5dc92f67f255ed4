"""What concave seams, jumps and gaps leave of a surface: its pieces."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray, IntArray
from flatgrasp_cli.kernels.borders import borders
from flatgrasp_cli.kernels.flood import flooded
from flatgrasp_cli.scene.cells import POINTS_PER_CELL, SMOOTH_CELLS
from flatgrasp_cli.scene.parting.joints import held_together
from flatgrasp_cli.scene.parting.seams import color_seam_cells, seam_cells, surface_normals
from flatgrasp_cli.scene.parting.view_grid import DOWN, RIGHT, ViewGrid, shifted, sides
from flatgrasp_cli.surroundings.slices import MIN_POINTS

SURE_SIGMAS = 4.0
"""A bend is told from noise by so many of its standard deviations: an object has thousands of places where cells meet,
of which three in a thousand go beyond 3 by noise alone, and one in 16,000 beyond 4."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What parts two pieces: a concave bend of more than `seam_deg`, or colours that differ by more than `seam_color`.

    A piece whose area, as seen, is less than a square of side `least_m` belongs to the one beside it, or the nearest.
    Pieces that meet along less than `neck_m` are one: a neck or a handle joins them. What one lies on is lower than it
    by `drop_m`.
    """

    seam_deg: float
    least_m: float
    drop_m: float
    neck_m: float = 0.0
    seam_color: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Points (n, 3) of a surface as seen from `viewpoint` (3,), and their `heights` (n,) over the support plane.

    They lie `spacing_m` apart and scatter by `noise_m` along the line of sight. `colors` (n, 3) are red, green and blue
    up to 255, if there are any.
    """

    points: FloatArray
    heights: FloatArray
    viewpoint: FloatArray
    spacing_m: float
    noise_m: float
    colors: ByteArray | None = None


def pieces(surface: Surface, limits: Limits) -> IntArray:
    """Names (n,), positive, of the pieces that a surface is made of."""
    spacing_m, noise_m = surface.spacing_m, surface.noise_m
    cell_m = max(float(np.sqrt(POINTS_PER_CELL)) * spacing_m, fitting_cell_m(spacing_m, noise_m, limits.seam_deg))
    grid = ViewGrid.of(surface.points, surface.heights, surface.viewpoint, cell_m, noise_m)
    normals, has_normal = surface_normals(grid)
    seams = seam_cells(grid, normals, has_normal, limits.seam_deg)
    if surface.colors is not None and limits.seam_color is not None:
        seams |= color_seam_cells(grid, surface.colors, limits.seam_color)
    names = _connected(grid, has_normal & ~seams)
    for least_cells in (SMOOTH_CELLS**2, max(MIN_POINTS, (limits.least_m / grid.cell_m) ** 2)):
        names = _of_size(names, least_cells)  # of fewer most lie at an edge, where normals are poor
        if np.count_nonzero(np.bincount(names.ravel())[1:]) < 2:
            return np.ones(len(surface.points), dtype=np.intp)
        names = _flooded(grid, names, normals)
    names = _over_necks(grid, held_together(grid, _nearest(names), limits.least_m, limits.drop_m), limits.neck_m)
    return np.asarray(grid.of_points(names))


def _over_necks(grid: ViewGrid, names: IntArray, neck_m: float) -> IntArray:
    """The names with one for each two pieces that meet along a line shorter than `neck_m`, mostly without a jump."""
    count = int(names.max()) + 1
    seen = np.where(grid.known, names, 0)
    _, (met, smooth), _ = borders(seen, grid.height, grid.depth, grid.jump_m, count)  # from one to the other, and back
    length_m = grid.cell_m * np.hypot(*met)
    widest_m = neck_m + grid.cell_m if neck_m > 0 else 0.0  # a line's length is known to a cell
    joined = np.arange(count)
    necks = (length_m > 0) & (length_m < widest_m) & (2 * smooth.sum(axis=0) > met.sum(axis=0))
    for one, other in zip(*np.nonzero(np.triu(necks)), strict=True):
        joined[joined == joined[other]] = joined[one]
    return np.asarray(joined[names])


def _nearest(names: IntArray) -> IntArray:
    """The names with that of the nearest cell of the image where there is none; 1 if there are none at all."""
    if not names.any():
        return np.ones_like(names)
    nameless = (names == 0).view(np.uint8)
    _, nearest = cv2.distanceTransformWithLabels(nameless, cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL)
    name_of = np.zeros(int(nearest.max()) + 1, dtype=np.intp)
    name_of[nearest[nameless == 0]] = names[nameless == 0]
    return name_of[nearest]


def _of_size(names: IntArray, cells: float) -> IntArray:
    """The names of pieces of so many cells, 0 for those of smaller ones."""
    large = np.bincount(names.ravel()) >= cells
    large[0] = False
    return np.asarray(large[names] * names)


def fitting_cell_m(spacing_m: float, noise_m: float, seam_deg: float) -> float:
    """Side of cells whose normals are so sure that noise makes no seam of `seam_deg`.

    The mean of the (c/s)² points in a cell of side c scatters by σ s/c, the slope of a plane through 3 × 3 such cells
    by σ s/(√6 c²), and the difference of two slopes by √2 times that.
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


def _flooded(grid: ViewGrid, names: IntArray, normals: FloatArray) -> IntArray:
    """The names spread, cell by cell, over what has none.

    Of its neighbours a cell joins the one whose plane, by `normals` (3, rows, columns) from beyond the seam, it lies
    nearest to.
    """
    waiting = np.flatnonzero(grid.known.ravel() & (names.ravel() == 0))
    steps = np.array([down * names.shape[1] + right for down, right in sides()])
    smooth = np.stack([grid.smooth_to(side).ravel() for side in sides()]).view(np.uint8)
    places = grid.places().reshape(3, -1)
    return flooded(names.ravel(), waiting, steps, smooth, places, normals.reshape(3, -1)).reshape(names.shape)
