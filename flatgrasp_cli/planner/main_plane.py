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


def principal_axes(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Standard deviations (3,), ascending, and unit axes (3, 3), its columns, of `points` (n, 3)."""
    centred = points - points.mean(axis=0)
    variances, axes = np.linalg.eigh(centred.T @ centred / len(points))
    return np.sqrt(np.maximum(variances, 0.0)), axes


def is_line(points: FloatArray) -> bool:
    """Whether `points` (n, 3) span no plane: fewer than three, all equal, or all on a line."""
    if len(points) < 3:
        return True
    spread, _ = principal_axes(points)
    return bool(spread[1] <= max(FLATTEST_RATIO * spread[2], 1e-9))


def oriented_box(points: FloatArray, viewpoint: FloatArray, method: Literal["pca", "min_area"]) -> OrientedBox:
    """Oriented bounding box of `points` (n, 3), which span a plane; its z axis points toward `viewpoint` (3,).

    The minor axis is the covariance's smallest eigenvector. The axes of the main plane are the two others (`pca`: what
    PCL's MomentOfInertiaEstimation does, which the paper describes), or those of the smallest rectangle around the
    projection (`min_area`), which does not turn with the density of the points.
    """
    mean = points.mean(axis=0)
    _, vectors = principal_axes(points)
    normal = vectors[:, 0]
    if normal @ (viewpoint - mean) < 0:
        normal = -normal
    major = vectors[:, 2]
    if method == "min_area":
        middle = np.cross(normal, major)
        in_plane = (points - mean) @ np.column_stack([major, middle])
        along = minimum_area_axis(in_plane)
        major = along[0] * major + along[1] * middle
    axes = np.stack([major, np.cross(normal, major), normal])
    local = (points - mean) @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    frame = Frame(mean + 0.5 * (low + high) @ axes, axes)
    return OrientedBox(frame, high - low, np.stack([points.min(axis=0), points.max(axis=0)]))
