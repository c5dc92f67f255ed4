"""The highest point over each cell of a plane: what a hand that comes down on it can meet."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, true_entries
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.kernels import looking_up, palm

UNSEEN = -np.inf


@dataclass(frozen=True, eq=False)
class HeightMap:
    """Heights (rows, columns) over the cells of a `raster`; −inf where no point lies, as all along the rim."""

    raster: Raster
    heights: FloatArray

    @property
    def cell_m(self) -> float:
        """Side of the cells."""
        return self.raster.cell_m

    @property
    def grid(self) -> FloatArray:
        """Where the cells begin, and their size (3,)."""
        return self.raster.grid

    @cached_property
    def tops(self) -> FloatArray:
        """The highest of each square of so many cells as a search passes over at once."""
        return palm.tops(self.heights)

    @classmethod
    def of(cls, points: FloatArray, cell_m: float) -> HeightMap:
        """The map of the highest of `points` (n, 3): x and y in the plane, z the height."""
        if len(points) == 0:
            return cls(Raster(np.zeros(2), cell_m, (1, 1)), np.full((1, 1), UNSEEN))
        return cls.around(points, cell_m).raised(points)

    @classmethod
    def around(cls, points: FloatArray, cell_m: float, reach_m: float = 0.0) -> HeightMap:
        """An empty map of the area of `points` (n, 3) and of `reach_m` on all sides of it."""
        raster = Raster.around(points, cell_m, reach_m)
        return cls(raster, np.full(raster.shape, UNSEEN))

    def raised(self, points: FloatArray) -> HeightMap:
        """The same cells with `points` (n, 3) added to what is there; those outside are left out."""
        heights = self.heights.copy()
        self.raster.raise_to(heights, *points.T)
        return replace(self, heights=self.raster.rimmed(heights, UNSEEN))

    def filled(self, other: HeightMap, frame: Frame, other_frame: Frame) -> HeightMap:
        """The same cells with the empty ones filled from a map in `other_frame`, whose plane may be aslant.

        Each cell takes what its axis, along z of `frame`, meets of the other plane and of the heights over it.
        """
        along = frame.axes @ other_frame.axes.T  # (3, 3): this frame's axes in the other's
        corner = other_frame.to_local(frame.origin) + (self.raster.origin + 0.5 * self.cell_m) @ along[:2]
        heights, ground = self.heights.copy(), other.raster
        looking_up.filled(heights, self.cell_m, corner, along, other.heights, ground.origin, ground.cell_m)
        return replace(self, heights=self.raster.rimmed(heights, UNSEEN))

    def averaged(self, points: FloatArray) -> HeightMap:
        """The same cells with the mean height of the `points` (n, 3) in each."""
        x, y, z = points.T
        return replace(self, heights=self.raster.mean(x, y, z, UNSEEN))

    def over(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Heights (…) of the cells that hold points, given by columns x and y (…)."""
        return self.raster.looked_up(self.heights, x, y)

    def higher_than(self, height: float) -> FloatArray:
        """Middles and heights (k, 3) of the cells higher than `height`."""
        row, column = true_entries(self.heights > height)
        return np.column_stack([self.raster.middles(row, column), self.heights[row, column]])
