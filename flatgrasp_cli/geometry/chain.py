"""Polygon loops seen in many frames at once, laid end to end so that edges are neighbouring rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray


def closed_chain(loops: Sequence[FloatArray]) -> tuple[FloatArray, IntArray]:
    """All loops end to end, each closed by its first vertex (n, 2), and the rows that begin no edge but end a loop.

    Edges then join neighbouring rows, which slices reach without copying.
    """
    points = np.concatenate([np.vstack([loop, loop[:1]]) for loop in loops])
    return points, np.cumsum([len(loop) + 1 for loop in loops])[:-1] - 1


def _slopes(x: FloatArray, y: FloatArray) -> FloatArray:
    """Slope (n − 1, p) of the edges of a chain with vertices x, y (n, p); of upright ones their length."""
    run = np.diff(x, axis=0)
    run[run == 0] = 1.0
    return np.asarray(np.diff(y, axis=0) / run)


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """A closed chain seen in p frames.

    Vertices `x` and `y` are (n, p), the edges' `slope` (n − 1, p); `breaks` are the rows that begin no edge.
    """

    x: FloatArray
    y: FloatArray
    slope: FloatArray
    breaks: IntArray

    @classmethod
    def of(cls, x: FloatArray, y: FloatArray, breaks: IntArray) -> Chain:
        """The chain with these vertices (n, p)."""
        return cls(x, y, _slopes(x, y), breaks)

    def clipped(self, low: float, high: float) -> tuple[BoolArray, FloatArray, FloatArray]:
        """Which edges (n − 1, p) meet the strip low ≤ x ≤ high, and the lowest and highest y of each that does."""
        below, above = self.x < high, self.x > low
        meets = (below[:-1] | below[1:]) & (above[:-1] | above[1:])
        meets[self.breaks] = False
        shift = self.x.clip(low, high) - self.x
        begin, end = self.y[:-1] + self.slope * shift[:-1], self.y[1:] + self.slope * shift[1:]
        return meets, np.minimum(begin, end), np.maximum(begin, end)
