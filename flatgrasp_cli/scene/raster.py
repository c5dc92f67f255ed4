"""Heights above a support plane, averaged over square cells: what single noisy points don't tell, cells do."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray

COARSE_CELL_M, COARSE_SAMPLE = 0.02, 50_000
POINTS_PER_CELL = 4.0
CELL_RANGE_M = (0.002, 0.02)
MAX_CELLS = 4_000_000
Area = tuple[FloatArray, FloatArray]
"""Lower and upper corner (2,)."""
LEVEL_WINDOW_M = 0.08
"""The plane's own level is averaged over a square of this side: wider than ripple is narrow."""


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """Points of the plane sorted into cells of side `cell_m`, with a rim of empty ones around.

    `cell` (n,) is each point's flat index into arrays of `shape`; `count` (rows, columns) the points in each cell.
    Points that do not count have the index 0, a cell of the rim.
    """

    origin: FloatArray
    cell_m: float
    shape: tuple[int, int]
    cell: IntArray
    count: IntArray

    def total(self, values: FloatArray, cell: IntArray | None = None) -> FloatArray:
        """Sum (rows, columns) of `values` (n,) in each cell; of other points if their `cell` is given."""
        total = np.bincount(self.cell if cell is None else cell, weights=values, minlength=self.count.size)
        total[0] = 0.0
        return np.asarray(total.reshape(self.shape))

    def mean(self, values: FloatArray) -> FloatArray:
        """Mean (rows, columns) of `values` (n,) in each cell; 0 in empty ones."""
        return np.asarray(self.total(values) / np.maximum(self.count, 1))


def rasterise(x: FloatArray, y: FloatArray, keep: BoolArray | None, cell_m: float, area: Area | None = None) -> Raster:
    """Sort the points x, y (n,) into cells; these are made larger if there would be too many.

    Only points that the mask `keep` names count; they must lie in `area`, of which no more is covered than need be.
    Columns are read one after the other and as rarely as can be: a frame has hundreds of thousands of points.
    """
    low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
    if area is not None:
        low, high = np.maximum(low, area[0]), np.minimum(high, area[1])
    cell_m = max(cell_m, float(np.sqrt(np.prod(high - low + cell_m) / MAX_CELLS)))
    rows, columns = (((high - low) / cell_m).astype(np.intp) + 3).tolist()
    cell = _index(x, low[0], cell_m)
    cell *= columns
    cell += _index(y, low[1], cell_m)
    if keep is not None:
        cell *= keep
    count = np.bincount(cell, minlength=rows * columns)
    count[0] = 0
    return Raster(low - cell_m, cell_m, (rows, columns), cell, count.reshape(rows, columns))


def _index(values: FloatArray, low: float, cell_m: float) -> IntArray:
    """Row or column (n,) of `values` (n,), the rim's being 0."""
    index = values - (low - cell_m)
    index *= 1 / cell_m
    return index.astype(np.intp)


def fitting_cell_m(x: FloatArray, y: FloatArray, keep: BoolArray) -> float:
    """Side of cells that hold a few of the points x, y (n,) that a mask names, where there are any."""
    every = max(1, len(x) // COARSE_SAMPLE)
    keep = keep[::every]
    coarse = rasterise(x[::every][keep], y[::every][keep], None, COARSE_CELL_M)
    density = every * float(np.median(coarse.count[coarse.count > 0])) / coarse.cell_m**2
    return float(np.clip(np.sqrt(POINTS_PER_CELL / density), *CELL_RANGE_M))


def smoothed(values: FloatArray, where: BoolArray | IntArray, cells: int) -> FloatArray:
    """Mean of `values` over windows of `cells` × `cells`, weighted by `where`; 0 where a window has no weight."""
    weight = where.astype(np.float32)  # the windows' sums are in double precision all the same
    share = cv2.blur(weight, (cells, cells), borderType=cv2.BORDER_CONSTANT)
    total = cv2.blur(weight * values.astype(np.float32), (cells, cells), borderType=cv2.BORDER_CONSTANT)
    return np.where(share > 1e-6, total / np.maximum(share, 1e-6), 0.0).astype(np.float64)
