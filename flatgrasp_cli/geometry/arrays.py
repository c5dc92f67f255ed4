"""Array types used throughout, and what numpy does slowly with them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]
BoolArray = NDArray[np.bool_]
ByteArray = NDArray[np.uint8]

IN_CACHE = 20_000
"""Entries of a few matrices at once that stay in a processor's cache: a result does not depend on it."""


def true_entries(matrix: BoolArray) -> tuple[IntArray, IntArray]:
    """Rows and columns (k,) of the true entries of a `matrix` (m, n), in order: several times as fast as `nonzero`."""
    rows, columns = np.divmod(np.flatnonzero(matrix), matrix.shape[1])
    return rows, columns


def chunks(rows: int, columns: int) -> Iterator[slice]:
    """Slices of the rows of a matrix, each of as many entries as stay in a processor's cache, or of one row."""
    size = max(1, IN_CACHE // max(1, columns))
    return (slice(first, first + size) for first in range(0, rows, size))
