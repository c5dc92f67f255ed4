"""Heights above a support plane, averaged over square cells: what single noisy points don't tell, cells do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray

COARSE_CELL_M = 0.01
POINTS_PER_CELL = 4.0
CELL_RANGE_M = (0.002, 0.02)
MAX_CELLS = 4_000_000
LEVEL_WINDOW_M = 0.08
"""The plane's own level is averaged over a square of this side: wider than ripple is narrow."""


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """Points (n, 2) of the plane sorted into cells of side `cell_m`, with a rim of empty ones around.

    `cell` (n,) is each point's flat index into arrays of `shape`; `count` (rows, columns) the points in each cell.
    """

    origin: FloatArray
    cell_m: float
    shape: tuple[int, int]
    cell: IntArray
    count: IntArray

    def mean(self, values: FloatArray) -> FloatArray:
        """Mean (rows, columns) of `values` (n,) in each cell; 0 in empty ones."""
        total = np.bincount(self.cell, weights=values, minlength=self.count.size).reshape(self.shape)
        return np.asarray(total / np.maximum(self.count, 1))


def rasterise(points: FloatArray, cell_m: float) -> Raster:
    """Sort `points` (n, 2) into cells; they are made larger if there would be too many."""
    low, high = points.min(axis=0), points.max(axis=0)
    cell_m = max(cell_m, float(np.sqrt(np.prod(high - low + cell_m) / MAX_CELLS)))
    index = ((points - low) / cell_m).astype(np.intp) + 1
    rows, columns = (index.max(axis=0) + 2).tolist()
    cell = index[:, 0] * columns + index[:, 1]
    count = np.bincount(cell, minlength=rows * columns).reshape(rows, columns)
    return Raster(low - cell_m, cell_m, (rows, columns), cell, count)


def fitting_cell_m(points: FloatArray) -> float:
    """Side of cells that hold a few of `points` (n, 2) each, where there are any."""
    coarse = rasterise(points, COARSE_CELL_M)
    density = float(np.median(coarse.count[coarse.count > 0])) / coarse.cell_m**2
    return float(np.clip(np.sqrt(POINTS_PER_CELL / density), *CELL_RANGE_M))


def smoothed(values: FloatArray, where: BoolArray | IntArray, cells: int) -> FloatArray:
    """Mean of `values` over windows of `cells` × `cells`, weighted by `where`; 0 where a window has no weight."""
    from scipy.ndimage import uniform_filter

    weight = uniform_filter(where.astype(np.float64), cells, mode="constant")
    total = uniform_filter(values * where, cells, mode="constant")
    return np.where(weight > 1e-9, total / np.maximum(weight, 1e-9), 0.0)
