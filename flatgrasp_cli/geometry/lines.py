"""Straight lines through noisy values."""

from __future__ import annotations

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import lines as kernels


def fitted_lines(x: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Value at 0 and slope (m,) of least-squares lines through `values` (m, n) over `x` (n,), NaN left out.

    Where one value is known the slope is 0, where none is both are.
    """
    at_0, slope = kernels.fitted(x, values)
    return at_0, slope
