"""Heights above a support plane, averaged over square cells: they tell what single noisy points do not."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.kernels.sorting import into_cells

POINTS_PER_CELL = 4.0
"""Points that a cell should hold: their mean has half of a point's noise, and nine cells' a sixth."""
SMOOTH_CELLS = 3
"""Side of the window over which cells are averaged, in cells: the mean of nine has a third of one cell's noise."""
LEVEL_WINDOW_M = 0.08
"""Side of the square over which the plane's own level is averaged, metres: wider than a low object, and narrower than
the waves of a sensor's distortion, of some 20 cm."""


@dataclass(frozen=True, slots=True, eq=False)
class SortedPoints:
    """Points sorted into a `raster` of the plane, each in the `cell` (n,) with that flat index and at one of `heights`.

    `count` is how many each cell holds, `total` the sum of their heights, (rows, columns) each. Points that are left
    out have the index 0, a cell of the rim, which holds none.
    """

    raster: Raster
    cell: IntArray
    heights: FloatArray
    count: IntArray
    total: FloatArray

    @classmethod
    def of(cls, points: FloatArray, frame: Frame, raster: Raster, limits_m: tuple[float, float]) -> SortedPoints:
        """Those of `points` (n, 3) that lie in a raster of the `frame`'s plane, and higher than the first limit.

        Heights are cut off at the second one.
        """
        cell, heights = np.empty(len(points), dtype=np.intp), np.empty(len(points))
        planes = np.column_stack([frame.axes, frame.axes @ frame.origin])
        count, total = into_cells(
            points, planes, raster.grid, np.array(raster.shape), np.array(limits_m), cell, heights
        )
        return cls(raster, cell, heights, count, total)


def fitting_cell_m(x: FloatArray, y: FloatArray, coarse_m: float, every: float = 1.0) -> float:
    """Side of cells that hold a few points each, metres; x and y (n,) are those of one point in `every`.

    The points' density is measured in cells of side `coarse_m`: wider than points are apart, and narrower than the gaps
    and shadows between which a plane is seen.
    """
    low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
    coarse = Raster.over(low, high, coarse_m * np.sqrt(every))
    count = coarse.count(coarse.cells_within(x, y))
    density = every * float(np.median(count[count > 0])) / coarse.cell_m**2
    return float(np.sqrt(POINTS_PER_CELL / density))


def smoothed(values: FloatArray, where: BoolArray | IntArray, cells: int) -> FloatArray:
    """Mean of `values` over windows of `cells` × `cells`, weighted by `where`; 0 where a window has no weight."""
    weight = where.astype(np.float32)  # the windows' sums are in double precision all the same
    share = cv2.blur(weight, (cells, cells), borderType=cv2.BORDER_CONSTANT)
    total = cv2.blur(weight * values.astype(np.float32), (cells, cells), borderType=cv2.BORDER_CONSTANT)
    return np.where(share > 1e-6, total / np.maximum(share, 1e-6), 0.0).astype(np.float64)
