"""How far values scatter, told by most of them: outliers must not decide it."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray


def deviation(values: FloatArray) -> float:
    """Standard deviation of normally distributed values (n,) about 0, by their median absolute one."""
    three_quarters = NormalDist().inv_cdf(0.75)  # half of all values lie within so many deviations
    return float(np.median(np.abs(values))) / three_quarters
