"""Heights above a support plane, averaged over square cells: they tell what single noisy points do not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.kernels.sorting import into_cells, standing

POINTS_PER_CELL = 4.0
"""Points that a cell should hold: their mean has half of a point's noise, and nine cells' a sixth."""
SMOOTH_CELLS = 3
"""Side of the window over which cells are averaged, in cells: the mean of nine has a third of one cell's noise."""
LEVEL_WINDOW_M = 0.08
"""Side of the square over which the plane's own level is averaged, metres: wider than a low object, and narrower than
the waves of a sensor's distortion, of some 20 cm."""


@dataclass(frozen=True, slots=True, eq=False)
class SortedPoints:
    """Points (n, 3) sorted into a `raster` of a frame's plane, each in the `cell` (n,) with that flat index.

    `count` is how many each cell holds, `total` the sum of their heights, (rows, columns) each, which are cut off at
    `highest_m`. Points that are left out have the index 0, a cell of the rim, which holds none.
    """

    points: FloatArray
    planes: FloatArray
    """The plane's x, y and normal, with the origin's place along them (3, 4)."""
    raster: Raster
    highest_m: float
    cell: NDArray[np.int32]
    count: IntArray
    total: FloatArray

    @classmethod
    def of(cls, points: FloatArray, frame: Frame, raster: Raster, limits_m: tuple[float, float]) -> SortedPoints:
        """Those of `points` (n, 3) that lie in a raster of the `frame`'s plane, and higher than the first limit.

        Heights are cut off at the second one.
        """
        cell = np.empty(len(points), dtype=np.int32)
        planes = np.column_stack([frame.axes, frame.axes @ frame.origin])
        count, total = into_cells(points, planes, raster.grid, np.array(raster.shape), np.array(limits_m), cell)
        return cls(points, planes, raster, limits_m[1], cell, count, total)

    def standing(self, floor: FloatArray) -> tuple[IntArray, FloatArray]:
        """Rows of the points that are higher than the `floor` (rows, columns) of their cell, and how high (k,), (k,).

        Where nothing stands the floor is infinite.
        """
        rows, heights = standing(self.points, self.cell, floor.ravel(), self.planes[2].copy(), self.highest_m)
        return rows, heights


def fitting_cell_m(x: FloatArray, y: FloatArray, coarse_m: float, every: float = 1.0) -> float:
    """Side of cells that hold a few points each, metres; x and y (n,) are those of one point in `every`.

    The points' density is measured in cells of side `coarse_m`: wider than points are apart, and narrower than the gaps
    and shadows between which a plane is seen.
    """
    low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
    coarse = Raster.over(low, high, coarse_m * np.sqrt(every))
    count = coarse.count(coarse.cells_within(x, y))
    density = every * usual(count) / coarse.cell_m**2
    return float(np.sqrt(POINTS_PER_CELL / density))


def usual(count: IntArray) -> float:
    """The median of the counts (rows, columns) that are not 0: told by how often each occurs, for most are small."""
    up_to = np.cumsum(np.bincount(count.ravel())[1:])
    middles = [(up_to[-1] - 1) // 2, up_to[-1] // 2]
    return float(1 + np.searchsorted(up_to, middles, side="right").mean())
