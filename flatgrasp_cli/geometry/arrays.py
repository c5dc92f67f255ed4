"""Array types used throughout, and what numpy does slowly with them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]
Float32Array = NDArray[np.float32]
BoolArray = NDArray[np.bool_]
ByteArray = NDArray[np.uint8]


def true_entries(matrix: BoolArray) -> tuple[IntArray, IntArray]:
    """Rows and columns (k,) of the true entries of a `matrix` (m, n), in order: several times as fast as `nonzero`."""
    rows, columns = np.divmod(np.flatnonzero(matrix), matrix.shape[1])
    return rows, columns


def chunks(rows: int, columns: int, most: int) -> Iterator[slice]:
    """Slices of the rows of a matrix, each of no more than `most` entries, or of one row."""
    size = max(1, most // max(1, columns))
    return (slice(first, first + size) for first in range(0, rows, size))
