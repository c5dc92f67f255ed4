"""The highest point over each cell of a plane: what a hand that comes down on it can meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray

UNSEEN = -np.inf
MAX_CELLS = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class HeightMap:
    """Highest heights (rows, columns) in square cells of side `cell_m` from `origin` (2,); −inf where no point lies."""

    origin: FloatArray
    cell_m: float
    heights: FloatArray

    @classmethod
    def of(cls, points: FloatArray, cell_m: float) -> HeightMap:
        """The map of `points` (n, 3): x and y in the plane, z the height. Its rim of cells is empty."""
        if len(points) == 0:
            return cls(np.zeros(2), cell_m, np.full((1, 1), UNSEEN))
        low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
        cell_m = max(cell_m, float(np.sqrt(np.prod(high - low + cell_m) / MAX_CELLS)))
        rows, columns = (((high - low) / cell_m).astype(np.intp) + 3).tolist()
        chart = cls(low - cell_m, cell_m, np.full((rows, columns), UNSEEN))
        np.maximum.at(chart.heights.reshape(-1), chart.cells_of(points[:, :2]), points[:, 2])
        return chart

    def averaged(self, points: FloatArray) -> HeightMap:
        """The same cells with the mean height of the `points` (n, 3) in each."""
        cell, size = self.cells_of(points[:, :2]), self.heights.size
        count = np.bincount(cell, minlength=size)
        total = np.bincount(cell, weights=points[:, 2], minlength=size)
        mean = np.where(count > 0, total / np.maximum(count, 1), UNSEEN)
        return HeightMap(self.origin, self.cell_m, mean.reshape(self.heights.shape))

    def at(self, points: FloatArray) -> FloatArray:
        """Heights (…) of the cells that hold `points` (…, 2)."""
        return np.asarray(self.heights.ravel()[self.cells_of(points)])

    def cells_of(self, points: FloatArray) -> IntArray:
        """Flat indices (…) of the cells that hold `points` (…, 2); those outside belong to the empty rim."""
        rows, columns = self.heights.shape
        index = ((points - self.origin) / self.cell_m).astype(np.intp)  # truncation below 0 ends in the rim, too
        row = np.clip(index[..., 0], 0, rows - 1)
        return np.asarray(row * columns + np.clip(index[..., 1], 0, columns - 1))
