"""Beyond the paper: between which heights the surface around an object lies, as far as the sensor's rays tell.

Where something was seen, the surface is there or, along another direction than the sensor's, before it. Where nothing
was, it may be as low as the support plane. It is no higher than the lowest ray that passed: behind an object that is
the top of its shadow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.surroundings.view import View


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """The bounds that the rays of a `view` set to the surface over each cell; `lowest` is the highest that was seen.

    The upper bound is asked for level by level: whatever level no ray passed may be inside something.
    """

    lowest: HeightMap
    view: View

    def may_reach(self, level_m: float | FloatArray, x: FloatArray, y: FloatArray) -> BoolArray:
        """Where (…) nothing that reaches `level_m`, one for all or one for each place, was seen, but something may."""
        unsure = np.asarray(self.lowest.over(x, y) <= level_m)
        rows = np.flatnonzero(unsure)
        levels = np.broadcast_to(level_m, x.shape).take(rows)
        places = np.stack([x.ravel()[rows], y.ravel()[rows], levels])
        unsure.ravel()[rows] = self.view.hides(places)
        return unsure
