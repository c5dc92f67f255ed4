"""Beyond the paper: between which heights the surface around an object lies, as far as the sensor's rays tell.

Where something was seen, the surface is there. Where nothing was, it may be as low as the support plane, and as high as
the lowest ray that passed: behind an object that is the top of its shadow.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, true_entries
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.surroundings.view import View


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """The `lowest` and the `highest` surface, over the same cells, that the rays allow.

    Both are what was seen there. Where nothing was, the lowest is −inf: nobody knows of anything.
    """

    lowest: HeightMap
    highest: HeightMap

    @classmethod
    def of(cls, seen: HeightMap, view: View, top_m: float) -> Envelope:
        """The envelope around what was `seen`; hidden things are believed to be no higher than `top_m`, the object's.

        From a sensor above, what lies lower in a cell is hidden sooner: halving finds how high that goes, to a cell.
        """
        row, column = true_entries(seen.heights == UNSEEN)
        x, y = seen.raster.middles(row, column).T
        hidden, free = np.zeros(len(x)), np.full(len(x), top_m)
        for _ in range(max(1, int(np.ceil(np.log2(max(top_m, seen.cell_m) / seen.cell_m))))):
            middle = 0.5 * (hidden + free)
            behind = view.hides(np.stack([x, y, middle]))
            hidden, free = np.where(behind, middle, hidden), np.where(behind, free, middle)
        heights = seen.heights.copy()
        heights[row, column] = hidden
        return cls(seen, replace(seen, heights=heights))

    def may_reach(self, level_m: float, x: FloatArray, y: FloatArray) -> BoolArray:
        """Where (…) nothing was seen, and what was not seen may be higher than `level_m`."""
        cells = self.lowest.raster.cells(x, y)
        return np.asarray((self.lowest.heights.take(cells) == UNSEEN) & (self.highest.heights.take(cells) > level_m))
