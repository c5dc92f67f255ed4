"""Holes of a silhouette that are gaps in the data: two skins of the object lie beside them, and no wall between."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)


def two_skins(
    places: cython.double[:, ::1],
    points: cython.double[:, ::1],
    heights: cython.double[:],
    reach: cython.double,
    apart: cython.double,
) -> NDArray[np.bool_]:
    """Near which of the `places` (m, 2) the `heights` (n,) of `points` (n, 2) leave a gap of more than `apart`.

    Near are those within `reach`. Heights are sorted into boxes of the size of the gap: in one box none is so wide, so
    it is enough to know the lowest and the highest of each.
    """
    place: cython.Py_ssize_t
    point: cython.Py_ssize_t
    box: cython.Py_ssize_t
    bottom: cython.double = INFINITY
    top: cython.double = -INFINITY
    for point in range(points.shape[0]):
        bottom, top = min(bottom, heights[point]), max(top, heights[point])
    boxes: cython.Py_ssize_t = 1 + cython.cast(cython.Py_ssize_t, max(top - bottom, 0.0) / apart)
    lowest: cython.double[::1] = np.empty(boxes)
    highest: cython.double[::1] = np.empty(boxes)
    found = np.zeros(places.shape[0], dtype=np.uint8)
    has_gap: cython.uchar[::1] = found
    for place in range(places.shape[0]):
        for box in range(boxes):
            lowest[box], highest[box] = INFINITY, -INFINITY
        for point in range(points.shape[0]):
            x: cython.double = points[point, 0] - places[place, 0]
            if abs(x) > reach:
                continue
            y: cython.double = points[point, 1] - places[place, 1]
            if sqrt(x * x + y * y) <= reach:
                box = cython.cast(cython.Py_ssize_t, (heights[point] - bottom) / apart)
                lowest[box], highest[box] = min(lowest[box], heights[point]), max(highest[box], heights[point])
        below: cython.double = INFINITY
        for box in range(boxes):
            if lowest[box] < INFINITY:
                if lowest[box] - below > apart:
                    has_gap[place] = 1
                below = highest[box]
    return found.view(np.bool_)
