"""How far apart points lie."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.sampling import spread_indices

NEIGHBOURS = 6
KD_TREE = 4
"""FLANN's name for an exact search in one tree."""
SPACING_QUANTILE = 0.95
SPACING_SAMPLES = 1000


def spacing(points: FloatArray) -> float:
    """Distance within which 95 % of `points` (n, 2) have six neighbours, from an even sample of them."""
    sample = points[spread_indices(len(points), SPACING_SAMPLES)]
    reach = min(NEIGHBOURS + 1, len(points))  # a point is its own nearest neighbour
    tree = cv2.flann.Index(points.astype(np.float32), {"algorithm": KD_TREE, "leaf_max_size": 16})
    _, squares = tree.knnSearch(np.ascontiguousarray(sample, dtype=np.float32), reach, params={})
    return float(np.sqrt(np.sort(squares[:, -1])[round(SPACING_QUANTILE * (len(sample) - 1))]))
