"""§III.A.1: the oriented bounding box and its main plane."""

from __future__ import annotations

from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.rectangle import minimum_area_axis
from flatgrasp_cli.model import OrientedBox

FLATTEST_RATIO = 1e-4
"""Middle over major standard deviation under which points count as lying on a line."""
SMALLEST_SPREAD_M = 1e-7
"""Middle standard deviation under which all points count as one."""


def principal_axes(centred: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Standard deviations (3,), ascending, and unit axes (3, 3), its columns, of points (3, n) about their mean."""
    variances, axes = np.linalg.eigh(centred @ centred.T / centred.shape[1])
    return np.sqrt(np.maximum(variances, 0.0)), axes


def oriented_box(points: FloatArray, viewpoint: FloatArray, method: Literal["pca", "min_area"]) -> OrientedBox | None:
    """Oriented bounding box of `points` (n, 3), its z axis toward `viewpoint` (3,); None if they span no plane.

    The minor axis is the covariance's smallest eigenvector. The axes of the main plane are the two others (`pca`: what
    PCL's MomentOfInertiaEstimation does, which the paper describes), or those of the smallest rectangle around the
    projection (`min_area`), which does not turn with the density of the points.
    """
    if len(points) < 3:
        return None
    mean = points.mean(axis=0)
    centred = np.ascontiguousarray((points - mean).T)  # (3, n): reductions run fast over a long last axis
    spread, vectors = principal_axes(centred)
    if spread[1] <= max(FLATTEST_RATIO * spread[2], SMALLEST_SPREAD_M):
        return None
    normal = vectors[:, 0]
    if normal @ (viewpoint - mean) < 0:
        normal = -normal
    major = vectors[:, 2]
    if method == "min_area":
        middle = np.cross(normal, major)
        along = minimum_area_axis((np.stack([major, middle]) @ centred).T)
        major = along[0] * major + along[1] * middle
    axes = np.stack([major, np.cross(normal, major), normal])
    local = axes @ centred
    low, high = local.min(axis=1), local.max(axis=1)
    frame = Frame(mean + 0.5 * (low + high) @ axes, axes)
    aabb = mean + np.stack([centred.min(axis=1), centred.max(axis=1)])
    return OrientedBox(frame, high - low, aabb)
