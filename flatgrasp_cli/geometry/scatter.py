"""How far values scatter, told by most of them: outliers must not decide it."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray


def deviation(values: FloatArray) -> float:
    """Standard deviation of normally distributed values (n,) about 0, by their median absolute one."""
    three_quarters = NormalDist().inv_cdf(0.75)  # half of all values lie within so many deviations
    return median(np.abs(values)) / three_quarters


def median(values: FloatArray) -> float:
    """The median of values (n,), n > 0, none of which is NaN: what numpy asks besides takes longer for a few."""
    middle = len(values) // 2
    parted = np.partition(values, middle)
    if len(values) % 2 == 1:
        return float(parted[middle])
    return 0.5 * float(parted[:middle].max() + parted[middle])  # numpy takes six times as long for two places


def quantile(values: FloatArray, share: float) -> float:
    """The value below which such a `share` of values (n,), n > 0, lies, in a straight line between the nearest two."""
    place = share * (len(values) - 1)
    low = int(place)
    parted = np.partition(values, low)
    below = float(parted[low])
    return below if place == low else below + (place - low) * (float(parted[low + 1 :].min()) - below)
