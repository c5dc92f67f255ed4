"""§III.A.1: the oriented bounding box and its main plane."""

from __future__ import annotations

from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.geometry.principal_axes import main_axes, principal_axes
from flatgrasp_cli.model import OrientedBox


def oriented_box(points: FloatArray, toward: FloatArray, method: Literal["pca", "min_area"]) -> OrientedBox | None:
    """Oriented bounding box of `points` (n, 3), its z axis to the side of `toward` (3,); None if they span no plane.

    The minor axis is the covariance's smallest eigenvector. The axes of the main plane are the two others (`pca`: what
    PCL's MomentOfInertiaEstimation does, which the paper describes), or those of the smallest rectangle around the
    projection (`min_area`).
    """
    if len(points) < 3:
        return None
    mean = mean_of(points)
    centred = np.subtract(points.T, mean[:, None], order="C")  # (3, n): numpy runs fast along long rows
    axes = principal_axes(centred)
    if axes is None:
        return None
    minor, _, major = axes
    normal = -minor if minor @ toward < 0 else minor
    return OrientedBox.around(mean, centred, main_axes(centred, normal, major, method))
