"""One raster for all that sorts points into square cells: heights, means, counts and ranges."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.extents import bounds_of
from flatgrasp_cli.kernels import looking_up

MAX_CELLS = 4_000_000
"""Cells that a raster may have: 32 MB of numbers."""
SLACK_CELLS = 1e-6
"""Room around the outermost points, in cells: rounding must not put them into the rim."""


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """Square cells of side `cell_m`, `shape` (rows, columns) of them from `origin` (2,); rows go along x.

    The cells of the rim hold nothing: whatever lies outside belongs to them.
    """

    origin: FloatArray
    cell_m: float
    shape: tuple[int, int]

    @classmethod
    def over(cls, low: FloatArray, high: FloatArray, cell_m: float) -> Raster:
        """The raster over an area (2,), (2,) with its rim; cells are larger if there would be more than `MAX_CELLS`."""
        wide, long = (high - low).tolist()  # plain numbers: numpy takes ten times as long for so few
        cell_m = max(cell_m, math.sqrt((wide + cell_m) * (long + cell_m) / MAX_CELLS))
        return cls(low - cell_m, cell_m, (int(wide / cell_m) + 3, int(long / cell_m) + 3))

    @classmethod
    def around(cls, points: FloatArray, cell_m: float, reach_m: float = 0.0) -> Raster:
        """The raster over the x and y of `points` (n, …), none of which falls on the rim, and `reach_m` around them."""
        reach_m += SLACK_CELLS * cell_m
        low, high = bounds_of(points[:, :2])
        return cls.over(low - reach_m, high + reach_m, cell_m)

    @property
    def inside(self) -> tuple[FloatArray, FloatArray]:
        """The corners (2,), (2,) of the cells that are not the rim's."""
        return self.origin + self.cell_m, self.origin + self.cell_m * (np.array(self.shape) - 1)

    @property
    def grid(self) -> FloatArray:
        """Where the cells begin, and their size (3,)."""
        return np.array([self.origin[0], self.origin[1], self.cell_m])

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.shape[0] * self.shape[1]

    def cells(self, x: FloatArray, y: FloatArray) -> IntArray:
        """Flat indices (…) of the cells that hold points x and y (…); those outside fall on the rim."""
        found = looking_up.cells(np.ravel(x), np.ravel(y), self.origin, self.cell_m, *self.shape)
        return found.reshape(np.shape(x))

    def looked_up(self, values: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
        """The `values` (rows, columns) at points x and y (…), those on the rim for points outside."""
        return looking_up.over(values, np.ravel(x), np.ravel(y), self.origin, self.cell_m).reshape(np.shape(x))

    def raise_to(self, values: FloatArray, x: FloatArray, y: FloatArray, levels: FloatArray) -> None:
        """Raise `values` (rows, columns) to the highest of the `levels` (n,) at points x and y (n,)."""
        looking_up.raised(values, x, y, levels, self.origin, self.cell_m)

    def lower_to(self, values: FloatArray, x: FloatArray, y: FloatArray, levels: FloatArray) -> None:
        """Lower `values` (rows, columns) to the lowest of the `levels` (n,) at points x and y (n,)."""
        looking_up.lowered(values, x, y, levels, self.origin, self.cell_m)

    def cells_within(self, x: FloatArray, y: FloatArray) -> IntArray:
        """The same for points (n,) none of which, or none that counts, lies outside: in half the time."""
        cell: IntArray = ((x - self.origin[0]) / self.cell_m).astype(np.intp)
        cell *= self.shape[1]
        cell += ((y - self.origin[1]) / self.cell_m).astype(np.intp)
        return cell

    def middles(self, row: IntArray, column: IntArray) -> FloatArray:
        """Middles (k, 2) of cells."""
        return np.asarray(self.origin + self.cell_m * (np.column_stack([row, column]) + 0.5))

    def count(self, cell: IntArray) -> IntArray:
        """How many (rows, columns) of the flat indices `cell` (n,) are in each cell."""
        return np.asarray(np.bincount(cell, minlength=self.size).reshape(self.shape))

    def total(self, cell: IntArray, values: FloatArray) -> FloatArray:
        """Sum (rows, columns) of the `values` (n,) in each cell."""
        total: FloatArray = np.bincount(cell, weights=values, minlength=self.size).astype(np.float64, copy=False)
        return total.reshape(self.shape)

    def mean(self, x: FloatArray, y: FloatArray, values: FloatArray, empty: float) -> FloatArray:
        """Mean (rows, columns) of the `values` (n,) at points x and y (n,) in each cell, `empty` where none are."""
        mean = np.full(self.shape, empty)
        looking_up.averaged(x, y, values, self.origin, self.cell_m, mean)
        return mean

    def rimmed(self, values: FloatArray, empty: float) -> FloatArray:
        """`values` (rows, columns), changed in place: `empty` all around."""
        values[0], values[-1], values[:, 0], values[:, -1] = empty, empty, empty, empty
        return values
