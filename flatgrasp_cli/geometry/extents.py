"""Where points lie, as a whole: numpy takes many times as long over so short an axis as theirs."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import points as kernels


def mean_of(points: FloatArray) -> FloatArray:
    """The mean (c,) of `points` (n, c)."""
    found: FloatArray = kernels.mean(points)
    return found


def bounds_of(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The least and the largest coordinates (c,), (c,) of `points` (n, c)."""
    low, high = kernels.bounds(points)
    return low, high


def extent_of(points: FloatArray) -> FloatArray:
    """How far `points` (n, c) reach along each axis (c,)."""
    low, high = kernels.bounds(points)
    return np.asarray(high - low)
