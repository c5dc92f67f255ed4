"""§III.A.1: the oriented bounding box and its main plane."""

from __future__ import annotations

from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.rectangle import minimum_area_axis
from flatgrasp_cli.model import OrientedBox, SupportPlane

FLATTEST_RATIO = 1e-4
"""Ratio of the middle standard deviation to the major one below which points lie on a line: a tenth of a millimetre to
a metre, which no depth sensor resolves."""
SMALLEST_SPREAD_M = 1e-7
"""Middle standard deviation below which all points are one, metres: single precision, in which clouds are recorded,
resolves no less at a metre."""


def principal_axes(centred: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Standard deviations (3,), ascending, and unit axes (3, 3), its columns, of points (3, n) about their mean."""
    variances, axes = np.linalg.eigh(centred @ centred.T / centred.shape[1])
    return np.sqrt(np.maximum(variances, 0.0)), axes


def _flattened(centred: FloatArray, normal: FloatArray) -> FloatArray:
    """Points (3, n) projected along a unit `normal` (3,) to the plane through the origin."""
    return np.asarray(centred - np.outer(normal, normal @ centred))


def oriented_box(
    points: FloatArray,
    toward: FloatArray,
    method: Literal["pca", "min_area"],
    support: SupportPlane | None = None,
) -> OrientedBox | None:
    """Oriented bounding box of `points` (n, 3), its z axis to the side of `toward` (3,); None if they span no plane.

    The minor axis is the covariance's smallest eigenvector. The axes of the main plane are the two others (`pca`: what
    PCL's MomentOfInertiaEstimation does, which the paper describes), or those of the smallest rectangle around the
    projection (`min_area`), which does not turn with the density of the points.

    On a `support` plane the main plane is parallel to it and the box stands on it: a sensor above sees too little of
    an object to tell its minor axis, and nothing of its bottom.
    """
    if len(points) < 3:
        return None
    mean = points.mean(axis=0)
    centred = np.ascontiguousarray((points - mean).T)  # (3, n): reductions run fast over a long last axis
    spread, vectors = principal_axes(centred if support is None else _flattened(centred, support.normal))
    if spread[1] <= max(FLATTEST_RATIO * spread[2], SMALLEST_SPREAD_M):
        return None
    normal, major = vectors[:, 0], vectors[:, 2]
    if support is not None:
        normal = support.normal
    elif normal @ toward < 0:
        normal = -normal
    if method == "min_area":
        middle = np.cross(normal, major)
        along = minimum_area_axis((np.stack([major, middle]) @ centred).T)
        major = along[0] * major + along[1] * middle
    axes = np.stack([major, np.cross(normal, major), normal])
    local = axes @ centred
    low, high = local.min(axis=1), local.max(axis=1)
    if support is not None:
        low[2] = support.offset_m - support.normal @ mean
    frame = Frame(mean + 0.5 * (low + high) @ axes, axes)
    return OrientedBox(frame, high - low, mean + np.stack([centred.min(axis=1), centred.max(axis=1)]))
