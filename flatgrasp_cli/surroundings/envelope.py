"""Beyond the paper: between which heights the surface around an object lies, as far as the sensor's rays tell.

Where something was seen, the surface is there or, along another direction than the sensor's, before it. Where nothing
was, it may be as low as the support plane. It is no higher than the lowest ray that passed: behind an object that is
the top of its shadow. Where rays passed below it, below a rim, there is nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.kernels import sight as kernels
from flatgrasp_cli.surroundings.view import View


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """The bounds that the rays of a `view` set to the surface over each cell; `lowest` is the highest that was seen.

    The upper bound is asked for level by level: whatever level no ray passed may be inside something.
    """

    lowest: HeightMap
    view: View

    def going_on(self, level_m: float | FloatArray, chords: FloatArray, out: FloatArray, along: FloatArray) -> IntArray:
        """At how many of the distances `out` (d,) from `chords` (m, 6), from the first on, something may reach a level.

        There nothing that reaches `level_m`, one for all or one for each chord, was seen, but something may, at most of
        the places, shares `along` (a,) the chord: that is its middle, the way along it and the way inward.
        """
        levels = np.full(len(chords), level_m)
        if self.view.rays is None:
            return np.zeros(len(chords), dtype=np.intp)
        return kernels.going_on(
            chords, out, along, levels, self.lowest.heights, self.lowest.grid, *self.view.rays, self.view.behind
        )

    def free_below(self, tops: FloatArray, chords: FloatArray, inward_m: float, along: FloatArray) -> FloatArray:
        """Up to which height (m,) from the plane on rays show nothing below `tops` (m,), `inward_m` of `chords` (m, 6).

        That is so at most of the places, shares `along` (a,) the chord.
        """
        if self.view.rays is None:
            return np.zeros(len(chords))
        step_m = self.lowest.cell_m
        return kernels.free_below(chords, inward_m, along, tops, step_m, *self.view.rays, self.view.behind)
