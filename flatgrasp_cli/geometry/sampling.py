"""Samples of points that do not depend on how a sensor wrote them down."""

from __future__ import annotations

from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray

Scalar = TypeVar("Scalar", bound=np.generic)

GOLDEN = 0.6180339887498949
"""The golden ratio's fraction: its multiples never fall into step with the rows of an image."""


@lru_cache(maxsize=16)
def spread_indices(count: int, size: int) -> IntArray:
    """Indices (min(size, count),) of an even sample of `count` things in any order: one from each of equal stretches.

    Where in its stretch each lies follows the golden ratio's multiples (a Weyl sequence). Every n-th would do for a
    shuffled cloud, but of an image whose rows are a multiple of n long it takes a few columns only.
    """
    stretch = np.arange(min(size, count))
    if count > size:
        weyl = GOLDEN * stretch
        weyl -= np.floor(weyl)  # a remainder takes twice as long
        stretch = ((stretch + weyl) * (count / size)).astype(np.intp)
    stretch.flags.writeable = False  # the same is asked for again and again of a frame
    return stretch


def even_sample(points: NDArray[Scalar], size: int) -> NDArray[Scalar]:
    """An even sample (min(size, n), …) of `points` (n, …)."""
    return points.take(spread_indices(len(points), size), axis=0)  # several times as fast as an index


def one_a_cell(points: FloatArray, cell_m: float) -> IntArray:
    """Indices (k,), rising, of the first of `points` (n, 3) in each cube of `cell_m` metres that holds any."""
    cubes = np.zeros(len(points), dtype=np.int64)
    for steps in np.floor(points.T / cell_m).astype(np.int64):  # numbered axis by axis, so that no number is too large
        apart = steps - steps.min(initial=0)
        _, cubes = np.unique(cubes * (apart.max(initial=0) + 1) + apart, return_inverse=True)
    _, first = np.unique(cubes, return_index=True)
    return np.sort(first)
