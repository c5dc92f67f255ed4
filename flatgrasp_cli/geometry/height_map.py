"""The highest point over each cell of a plane: what a hand that comes down on it can meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import Float32Array, FloatArray, IntArray, true_entries
from flatgrasp_cli.geometry.frames import Frame

UNSEEN = -np.inf
RIM = 1 + 1e-6
"""Cells before the first point: a little more than one, for rounding must not put it into the rim."""
MAX_CELLS = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class HeightMap:
    """Highest heights (rows, columns) in square cells of side `cell_m` from `origin` (2,); −inf where no point lies.

    The cells of the rim are empty.
    """

    origin: FloatArray
    cell_m: float
    heights: FloatArray

    @classmethod
    def of(cls, points: FloatArray, cell_m: float) -> HeightMap:
        """The map of `points` (n, 3): x and y in the plane, z the height."""
        if len(points) == 0:
            return cls(np.zeros(2), cell_m, np.full((1, 1), UNSEEN))
        return cls.around(points, cell_m).raised(points)

    @classmethod
    def around(cls, points: FloatArray, cell_m: float, reach_m: float = 0.0) -> HeightMap:
        """An empty map of the area of `points` (n, 3) and of `reach_m` on all sides of it."""
        x, y, _ = points.T
        low, high = np.array([x.min(), y.min()]) - reach_m, np.array([x.max(), y.max()]) + reach_m
        cell_m = max(cell_m, float(np.sqrt(np.prod(high - low + cell_m) / MAX_CELLS)))
        rows, columns = (((high - low) / cell_m).astype(np.intp) + 4).tolist()
        return cls(low - RIM * cell_m, cell_m, np.full((rows, columns), UNSEEN))

    def raised(self, points: FloatArray) -> HeightMap:
        """The same cells with `points` (n, 3) added to what is there; those outside are left out."""
        heights = self.heights.copy()
        np.maximum.at(heights.reshape(-1), self.cells_of(points), points[:, 2])
        return HeightMap(self.origin, self.cell_m, _rimmed(heights))

    def filled(self, other: HeightMap, frame: Frame, other_frame: Frame) -> HeightMap:
        """The same cells with the empty ones filled from a map in another frame of the same plane."""
        along = frame.axes[:2] @ other_frame.axes[:2].T  # (2, 2): this frame's x and y in the other's
        x, y = other_frame.to_local(frame.origin)[:2] + (self.origin + 0.5 * self.cell_m) @ along
        down = self.cell_m * np.arange(self.heights.shape[0])[:, None] * along[0, :, None, None]
        right = self.cell_m * np.arange(self.heights.shape[1]) * along[1, :, None, None]
        floor = other.over(x + down[0] + right[0], y + down[1] + right[1])
        return HeightMap(self.origin, self.cell_m, _rimmed(np.where(self.heights == UNSEEN, floor, self.heights)))

    def averaged(self, points: FloatArray) -> HeightMap:
        """The same cells with the mean height of the `points` (n, 3) in each."""
        cell, size = self.cells_of(points), self.heights.size
        count = np.bincount(cell, minlength=size)
        total = np.bincount(cell, weights=points[:, 2], minlength=size)
        mean = np.full(size, UNSEEN)
        np.divide(total, count, out=mean, where=count > 0)
        return HeightMap(self.origin, self.cell_m, mean.reshape(self.heights.shape))

    def over(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Heights (…) of the cells that hold points, given by columns x and y (…)."""
        return np.asarray(self.heights.take(self.cells(x, y)))

    def higher_than(self, height: float) -> FloatArray:
        """Middles and heights (k, 3) of the cells higher than `height`."""
        row, column = true_entries(self.heights > height)
        middle = self.origin + self.cell_m * (np.column_stack([row, column]) + 0.5)
        return np.column_stack([middle, self.heights[row, column]])

    def cells_of(self, points: FloatArray) -> IntArray:
        """Flat indices (…) of the cells that hold `points` (…, 2 or more); those outside belong to the empty rim."""
        return self.cells(points[..., 0], points[..., 1])

    def cells(self, x: FloatArray | Float32Array, y: FloatArray | Float32Array) -> IntArray:
        """The same for points given by columns x and y (…)."""
        rows, columns = self.heights.shape
        cell = _bounded(x, self.origin[0], self.cell_m, rows)
        cell *= columns
        cell += _bounded(y, self.origin[1], self.cell_m, columns)
        return cell


def _rimmed(heights: FloatArray) -> FloatArray:
    """The heights with an empty rim, to which everything outside is sent."""
    heights[[0, -1]] = UNSEEN
    heights[:, [0, -1]] = UNSEEN
    return heights


def _bounded(values: FloatArray | Float32Array, low: float, cell_m: float, count: int) -> IntArray:
    """Indices (…) of values in `count` cells from `low`."""
    index = np.asarray(values - values.dtype.type(low))
    index /= cell_m
    return index.clip(0, count - 1, out=index).astype(np.intp)
