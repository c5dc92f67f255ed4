"""Heights above a support plane, averaged over square cells: what single noisy points don't tell, cells do."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray

COARSE_CELL_M = 0.01
POINTS_PER_CELL = 4.0
CELL_RANGE_M = (0.002, 0.02)
MAX_CELLS = 4_000_000
LEVEL_WINDOW_M = 0.08
"""The plane's own level is averaged over a square of this side: wider than ripple is narrow."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Cells (rows, columns) of side `cell_m` from `origin` (2,), those of the rim for nothing."""

    origin: FloatArray
    cell_m: float
    shape: tuple[int, int]

    @classmethod
    def over(cls, low: FloatArray, high: FloatArray, cell_m: float) -> Grid:
        """The grid over an area; its cells are made larger if there would be too many."""
        cell_m = max(cell_m, float(np.sqrt(np.prod(high - low + cell_m) / MAX_CELLS)))
        rows, columns = (((high - low) / cell_m).astype(np.intp) + 3).tolist()
        return cls(low - cell_m, cell_m, (rows, columns))

    def cells(self, x: FloatArray, y: FloatArray) -> IntArray:
        """Flat indices (n,) of points x and y (n,) in the area."""
        row: IntArray = ((x - self.origin[0]) / self.cell_m).astype(np.intp)
        row *= self.shape[1]
        row += ((y - self.origin[1]) / self.cell_m).astype(np.intp)
        return row


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """Points of the plane sorted into a grid: `cell` (n,) is each point's flat index, `count` (rows, columns) how many.

    Points that do not count have the index 0, a cell of the rim.
    """

    grid: Grid
    cell: IntArray
    count: IntArray

    @classmethod
    def of(cls, grid: Grid, cell: IntArray) -> Raster:
        """The raster of points in cells `cell` (n,)."""
        count = np.bincount(cell, minlength=grid.shape[0] * grid.shape[1])
        count[0] = 0
        return cls(grid, cell, count.reshape(grid.shape))

    def total(self, values: FloatArray, cell: IntArray | None = None) -> FloatArray:
        """Sum (rows, columns) of `values` (n,) in each cell; of other points if their `cell` is given."""
        total = np.bincount(self.cell if cell is None else cell, weights=values, minlength=self.count.size)
        total[0] = 0.0
        return np.asarray(total.reshape(self.count.shape))


def fitting_cell_m(x: FloatArray, y: FloatArray, every: float = 1.0) -> float:
    """Side of cells that hold a few points each, where there are any; of those x and y (n,) are one in `every`."""
    low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
    coarse = Grid.over(low, high, COARSE_CELL_M * np.sqrt(every))
    count = Raster.of(coarse, coarse.cells(x, y)).count
    density = every * float(np.median(count[count > 0])) / coarse.cell_m**2
    return float(np.clip(np.sqrt(POINTS_PER_CELL / density), *CELL_RANGE_M))


def smoothed(values: FloatArray, where: BoolArray | IntArray, cells: int) -> FloatArray:
    """Mean of `values` over windows of `cells` × `cells`, weighted by `where`; 0 where a window has no weight."""
    weight = where.astype(np.float32)  # the windows' sums are in double precision all the same
    share = cv2.blur(weight, (cells, cells), borderType=cv2.BORDER_CONSTANT)
    total = cv2.blur(weight * values.astype(np.float32), (cells, cells), borderType=cv2.BORDER_CONSTANT)
    return np.where(share > 1e-6, total / np.maximum(share, 1e-6), 0.0).astype(np.float64)
