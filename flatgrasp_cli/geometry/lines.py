"""Straight lines through noisy values."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray


def fitted_lines(x: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Value at 0 and slope (m,) of least-squares lines through `values` (m, n) over `x` (n,), NaN left out.

    Where one value is known the slope is 0, where none is both are.
    """
    known = np.isfinite(values)
    count = np.maximum(known.sum(axis=1), 1)
    mean_x = np.where(known, x, 0.0).sum(axis=1) / count
    mean = np.where(known, values, 0.0).sum(axis=1) / count
    dx = np.where(known, x - mean_x[:, None], 0.0)
    spread = (dx**2).sum(axis=1)
    slope = (dx * np.where(known, values, 0.0)).sum(axis=1) / np.where(spread > 0, spread, 1.0)
    return mean - slope * mean_x, slope
