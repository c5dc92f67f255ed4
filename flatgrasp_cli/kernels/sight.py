"""What a sensor saw of places: whether the ray through each of them ended before it."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)


@cython.cfunc
@cython.inline
def _cell(
    place: cython.double, low: cython.double, cell_m: cython.double, count: cython.Py_ssize_t
) -> cython.Py_ssize_t:
    """The cell that holds a place, out of `count` from `low`."""
    return cython.cast(cython.Py_ssize_t, min(max((place - low) / cell_m, 0.0), count - 1.0))


def hidden(
    places: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    eye: cython.double[:, ::1],
    pixels: cython.double[::1],
    ranges: cython.double[:, ::1],
    ground: cython.double[:, ::1],
    cells: cython.double[::1],
    levels: cython.double[:, ::1],
    behind: cython.double[::1],
) -> NDArray[np.bool_]:
    """Which of `places`, columns (3, n), lie behind what their ray met, or on a ray with no end.

    The `eye` (4, 3) is where rays come from, then the axes of the image, the line of sight last; `ranges` are how far
    they got, infinite where nothing was met, in the `pixels` (3,): origin and size. Such a ray ends where the ground
    was seen: the plane z = 0 in a frame that has its origin and its axes in the rows of `ground` (4, 3), the `levels`
    of which are finite where it was, in `cells` (3,). Behind is what is farther by more than the first of `behind`
    (2,), and the second times the distance.
    """
    index: cython.Py_ssize_t
    found = np.empty(places.shape[1], dtype=np.uint8)
    is_hidden: cython.uchar[::1] = found
    for index in range(places.shape[1]):
        dx: cython.double = places[0, index] - eye[0, 0]
        dy: cython.double = places[1, index] - eye[0, 1]
        dz: cython.double = places[2, index] - eye[0, 2]
        x: cython.double = eye[1, 0] * dx + eye[1, 1] * dy + eye[1, 2] * dz
        y: cython.double = eye[2, 0] * dx + eye[2, 1] * dy + eye[2, 2] * dz
        z: cython.double = eye[3, 0] * dx + eye[3, 1] * dy + eye[3, 2] * dz
        away: cython.double = sqrt(x * x + y * y + z * z)
        got: cython.double = INFINITY
        if z > 0:
            row: cython.Py_ssize_t = _cell(x / max(z, 1e-9), pixels[0], pixels[2], ranges.shape[0])
            got = ranges[row, _cell(y / max(z, 1e-9), pixels[1], pixels[2], ranges.shape[1])]
        if got < INFINITY:
            is_hidden[index] = got < away - (behind[0] + behind[1] * away)
        else:
            is_hidden[index] = not _meets(places, index, eye, ground, cells, levels)
    return found.view(np.bool_)


@cython.cfunc
@cython.inline
def _meets(
    places: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    index: cython.Py_ssize_t,
    eye: cython.double[:, ::1],
    ground: cython.double[:, ::1],
    cells: cython.double[::1],
    levels: cython.double[:, ::1],
) -> cython.bint:
    """Whether the ray through a place meets the ground where that was seen."""
    axis: cython.Py_ssize_t
    high: cython.double = 0.0
    low: cython.double = 0.0
    for axis in range(3):
        high += ground[3, axis] * (eye[0, axis] - ground[0, axis])
        low += ground[3, axis] * (places[axis, index] - ground[0, axis])
    if high - low <= 0:
        return False
    share: cython.double = high / (high - low)
    x: cython.double = 0.0
    y: cython.double = 0.0
    for axis in range(3):
        met: cython.double = eye[0, axis] + share * (places[axis, index] - eye[0, axis]) - ground[0, axis]
        x += ground[1, axis] * met
        y += ground[2, axis] * met
    row: cython.Py_ssize_t = _cell(x, cells[0], cells[2], levels.shape[0])
    return levels[row, _cell(y, cells[1], cells[2], levels.shape[1])] > -INFINITY
