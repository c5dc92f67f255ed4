"""Axes of a set of points: by their covariance, and by the smallest rectangle around their projection."""

from __future__ import annotations

from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import cross_product
from flatgrasp_cli.geometry.rectangle import minimum_area_axis

FLATTEST_RATIO = 1e-4
"""Ratio of the middle standard deviation to the major one below which points lie on a line: a tenth of a millimetre to
a metre, which no depth sensor resolves."""
SMALLEST_SPREAD_M = 1e-7
"""Middle standard deviation below which all points are one, metres: single precision, in which clouds are recorded,
resolves no less at a metre."""


def principal_axes(centred: FloatArray) -> FloatArray | None:
    """Unit axes (3, 3), minor, middle and major, its rows, of points (3, n) about their mean; None if on a line."""
    variances, axes = np.linalg.eigh(centred @ centred.T / centred.shape[1])
    spread = np.sqrt(np.maximum(variances, 0.0))
    return None if spread[1] <= max(FLATTEST_RATIO * spread[2], SMALLEST_SPREAD_M) else axes.T


def main_axes(
    centred: FloatArray, normal: FloatArray, major: FloatArray, method: Literal["pca", "min_area"]
) -> FloatArray:
    """Right-handed unit axes (3, 3), its rows, the last one `normal` (3,), for points (3, n) about their mean.

    `pca`: the first one is `major` (3,). `min_area`: it is a side of the smallest rectangle around the projection
    along the normal, which does not turn with the density of the points.
    """
    if method == "min_area":
        middle = cross_product(normal, major)
        along = minimum_area_axis((np.stack([major, middle]) @ centred).T)
        major = along[0] * major + along[1] * middle
    return np.array([major, cross_product(normal, major), normal])
