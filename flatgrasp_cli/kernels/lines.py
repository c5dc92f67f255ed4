"""Straight lines through noisy values, many of them over the same few places."""

from __future__ import annotations

import cython
import numpy as np
from cython.cimports.libc.math import isfinite
from numpy.typing import NDArray


def fitted(
    x: cython.const[cython.double][:],  # type: ignore[valid-type]
    values: cython.const[cython.double][:, :],  # type: ignore[valid-type]
) -> NDArray[np.float64]:
    """Value at 0 and slope (2, m) of least-squares lines through `values` (m, n) over `x` (n,), NaN left out.

    Where one value is known the slope is 0, where none is both are.
    """
    line: cython.Py_ssize_t
    place: cython.Py_ssize_t
    found = np.empty((2, values.shape[0]))
    answer: cython.double[:, ::1] = found
    for line in range(values.shape[0]):
        count: cython.Py_ssize_t = 0
        mean_x: cython.double = 0.0
        mean: cython.double = 0.0
        for place in range(values.shape[1]):
            if isfinite(values[line, place]):
                count += 1
                mean_x += x[place]
                mean += values[line, place]
        mean_x, mean = mean_x / max(count, 1), mean / max(count, 1)
        spread: cython.double = 0.0
        product: cython.double = 0.0
        for place in range(values.shape[1]):
            if isfinite(values[line, place]):
                dx: cython.double = x[place] - mean_x
                spread += dx * dx
                product += dx * values[line, place]
        answer[1, line] = product / (spread if spread > 0 else 1.0)
        answer[0, line] = mean - answer[1, line] * mean_x
    return found
