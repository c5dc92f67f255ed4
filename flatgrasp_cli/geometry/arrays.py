"""Array types used throughout, and what numpy does slowly with them."""

from __future__ import annotations

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
