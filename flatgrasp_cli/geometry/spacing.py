"""How far apart points lie."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.kernels.neighbours import squared_reach

NEIGHBOURS = 6
SPACING_QUANTILE = 0.95
SPACING_SAMPLES = 1000


def spacing(points: FloatArray) -> float:
    """Distance within which 95 % of `points` (n, 2) have six neighbours, from an even sample of them."""
    sample = spread_indices(len(points), SPACING_SAMPLES)
    count = min(NEIGHBOURS + 1, len(points))  # a point is its own nearest neighbour
    squares = squared_reach(points, sample, count)
    return float(np.sqrt(np.sort(squares)[round(SPACING_QUANTILE * (len(sample) - 1))]))
