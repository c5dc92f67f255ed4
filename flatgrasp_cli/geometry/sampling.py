"""Samples of points that do not depend on how a sensor wrote them down."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import IntArray

GOLDEN = 0.6180339887498949
"""The golden ratio's fraction: its multiples never fall into step with the rows of an image."""


def spread_indices(count: int, size: int) -> IntArray:
    """Indices (min(size, count),) of an even sample of `count` things in any order: one from each of equal stretches.

    Where in its stretch each lies follows the golden ratio's multiples (a Weyl sequence). Every n-th would do for a
    shuffled cloud, but of an image whose rows are a multiple of n long it takes a few columns only.
    """
    if count <= size:
        return np.arange(count)
    stretch = np.arange(size)
    return np.asarray((stretch + (GOLDEN * stretch) % 1.0) * (count / size), dtype=np.intp)
