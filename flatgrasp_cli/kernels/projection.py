"""Points in the image of a sensor."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray


def projected(
    columns: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    viewpoint: cython.const[cython.double][:],  # type: ignore[valid-type]
    axes: cython.const[cython.double][:, :],  # type: ignore[valid-type]
) -> NDArray[np.float64]:
    """Image coordinates x and y at distance 1, and ranges (3, n), of points, `columns` (3, n), from a `viewpoint` (3,).

    The `axes` (3, 3) are the image's x and y, and its line of sight; of points behind the viewpoint x is infinite.
    """
    point: cython.Py_ssize_t
    found = np.empty((3, columns.shape[1]))
    image: cython.double[:, ::1] = found
    for point in range(columns.shape[1]):
        dx: cython.double = columns[0, point] - viewpoint[0]
        dy: cython.double = columns[1, point] - viewpoint[1]
        dz: cython.double = columns[2, point] - viewpoint[2]
        x: cython.double = axes[0, 0] * dx + axes[0, 1] * dy + axes[0, 2] * dz
        y: cython.double = axes[1, 0] * dx + axes[1, 1] * dy + axes[1, 2] * dz
        z: cython.double = axes[2, 0] * dx + axes[2, 1] * dy + axes[2, 2] * dz
        depth: cython.double = max(z, 1e-9)
        image[0, point] = x / depth if z > 0 else math.inf
        image[1, point] = y / depth
        image[2, point] = sqrt(x * x + y * y + z * z)
    return found


def image(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    viewpoint: cython.const[cython.double][:],  # type: ignore[valid-type]
    axes: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    nearest: cython.double,
) -> NDArray[np.float64]:
    """The same with depths along the line of sight in place of ranges (3, n), of `points` (n, 3).

    What is not as deep as the `nearest`, or behind the viewpoint, is in the image as if it were so deep.
    """
    point: cython.Py_ssize_t
    axis: cython.Py_ssize_t
    found = np.empty((3, points.shape[0]))
    columns: cython.double[:, ::1] = found
    for point in range(points.shape[0]):
        x: cython.double = points[point, 0] - viewpoint[0]
        y: cython.double = points[point, 1] - viewpoint[1]
        z: cython.double = points[point, 2] - viewpoint[2]
        for axis in range(3):
            columns[axis, point] = axes[axis, 0] * x + axes[axis, 1] * y + axes[axis, 2] * z
        ahead: cython.double = max(columns[2, point], nearest)
        columns[0, point] /= ahead
        columns[1, point] /= ahead
    return found
