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
@cython.exceptval(check=False)
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
        x: cython.double = places[0, index]
        y: cython.double = places[1, index]
        is_hidden[index] = _hides(x, y, places[2, index], eye, pixels, ranges, ground, cells, levels, behind)
    return found.view(np.bool_)


def going_on(
    chords: cython.double[:, ::1],
    out: cython.double[::1],
    along: cython.double[::1],
    heights: cython.double[::1],
    lowest: cython.double[:, ::1],
    grid: cython.double[::1],
    eye: cython.double[:, ::1],
    pixels: cython.double[::1],
    ranges: cython.double[:, ::1],
    ground: cython.double[:, ::1],
    cells: cython.double[::1],
    levels: cython.double[:, ::1],
    behind: cython.double[::1],
) -> NDArray[np.intp]:
    """At how many of the distances `out` (d,) from each of `chords` (m, 6), from the first on, something may stand.

    A chord is its middle, the way along it and the unit vector inward. Something may stand at a distance if it may at
    most of the places there, shares `along` (a,) the chord: where nothing was seen that is higher than the chord's one
    of `heights` (m,) in the map `lowest`, on the `grid` (3,), and where that height is hidden. Other arguments are
    those of `hidden`.
    """
    chord: cython.Py_ssize_t
    step: cython.Py_ssize_t
    place: cython.Py_ssize_t
    found = np.zeros(chords.shape[0], dtype=np.intp)
    far: cython.Py_ssize_t[::1] = found
    for chord in range(chords.shape[0]):
        for step in range(out.shape[0]):
            may: cython.Py_ssize_t = 0
            for place in range(along.shape[0]):
                x: cython.double = chords[chord, 0] + along[place] * chords[chord, 2] - out[step] * chords[chord, 4]
                y: cython.double = chords[chord, 1] + along[place] * chords[chord, 3] - out[step] * chords[chord, 5]
                row: cython.Py_ssize_t = _cell(x, grid[0], grid[2], lowest.shape[0])
                if lowest[row, _cell(y, grid[1], grid[2], lowest.shape[1])] <= heights[chord]:
                    may += _hides(x, y, heights[chord], eye, pixels, ranges, ground, cells, levels, behind)
            if 2 * may <= along.shape[0]:
                break
            far[chord] += 1
    return found


def free_below(
    chords: cython.double[:, ::1],
    inward: cython.double,
    along: cython.double[::1],
    tops: cython.double[::1],
    step: cython.double,
    eye: cython.double[:, ::1],
    pixels: cython.double[::1],
    ranges: cython.double[:, ::1],
    ground: cython.double[:, ::1],
    cells: cython.double[::1],
    levels: cython.double[:, ::1],
    behind: cython.double[::1],
) -> NDArray[np.float64]:
    """Up to which height (m,) from the plane on nothing stands so far `inward` of each of `chords` (m, 6).

    It is looked step by step, to the first that ends above the chord's one of `tops` (m,): a height is free unless most
    of its places, shares `along` (a,) the chord, are hidden. Other arguments are those of `hidden`.
    """
    chord: cython.Py_ssize_t
    place: cython.Py_ssize_t
    found = np.empty(chords.shape[0])
    free: cython.double[::1] = found
    for chord in range(chords.shape[0]):
        free[chord] = 0.0
        while free[chord] < tops[chord]:
            hidden_ones: cython.Py_ssize_t = 0
            z: cython.double = free[chord] + 0.5 * step
            for place in range(along.shape[0]):
                x: cython.double = chords[chord, 0] + along[place] * chords[chord, 2] + inward * chords[chord, 4]
                y: cython.double = chords[chord, 1] + along[place] * chords[chord, 3] + inward * chords[chord, 5]
                hidden_ones += _hides(x, y, z, eye, pixels, ranges, ground, cells, levels, behind)
            if 2 * hidden_ones > along.shape[0]:
                break
            free[chord] += step
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _hides(
    px: cython.double,
    py: cython.double,
    pz: cython.double,
    eye: cython.double[:, ::1],
    pixels: cython.double[::1],
    ranges: cython.double[:, ::1],
    ground: cython.double[:, ::1],
    cells: cython.double[::1],
    levels: cython.double[:, ::1],
    behind: cython.double[::1],
) -> cython.bint:
    """Whether a place lies behind what its ray met, or on a ray with no end; arguments as in `hidden`."""
    dx: cython.double = px - eye[0, 0]
    dy: cython.double = py - eye[0, 1]
    dz: cython.double = pz - eye[0, 2]
    x: cython.double = eye[1, 0] * dx + eye[1, 1] * dy + eye[1, 2] * dz
    y: cython.double = eye[2, 0] * dx + eye[2, 1] * dy + eye[2, 2] * dz
    z: cython.double = eye[3, 0] * dx + eye[3, 1] * dy + eye[3, 2] * dz
    away: cython.double = sqrt(x * x + y * y + z * z)
    got: cython.double = INFINITY
    if z > 0:
        row: cython.Py_ssize_t = _cell(x / max(z, 1e-9), pixels[0], pixels[2], ranges.shape[0])
        got = ranges[row, _cell(y / max(z, 1e-9), pixels[1], pixels[2], ranges.shape[1])]
    if got < INFINITY:
        return got < away - (behind[0] + behind[1] * away)
    return not _meets(px, py, pz, eye, ground, cells, levels)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _meets(
    px: cython.double,
    py: cython.double,
    pz: cython.double,
    eye: cython.double[:, ::1],
    ground: cython.double[:, ::1],
    cells: cython.double[::1],
    levels: cython.double[:, ::1],
) -> cython.bint:
    """Whether the ray through a place meets the ground where that was seen."""
    high: cython.double = _over(eye[0, 0], eye[0, 1], eye[0, 2], ground, 3)
    low: cython.double = _over(px, py, pz, ground, 3)
    if high - low <= 0:
        return False
    share: cython.double = high / (high - low)
    px = eye[0, 0] + share * (px - eye[0, 0])
    py = eye[0, 1] + share * (py - eye[0, 1])
    pz = eye[0, 2] + share * (pz - eye[0, 2])
    row: cython.Py_ssize_t = _cell(_over(px, py, pz, ground, 1), cells[0], cells[2], levels.shape[0])
    column: cython.Py_ssize_t = _cell(_over(px, py, pz, ground, 2), cells[1], cells[2], levels.shape[1])
    return levels[row, column] > -INFINITY


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _over(
    x: cython.double, y: cython.double, z: cython.double, frame: cython.double[:, ::1], axis: cython.Py_ssize_t
) -> cython.double:
    """Where a place lies along an axis, a row from 1 on, of a frame whose origin is row 0."""
    dx: cython.double = x - frame[0, 0]
    dy: cython.double = y - frame[0, 1]
    return frame[axis, 0] * dx + frame[axis, 1] * dy + frame[axis, 2] * (z - frame[0, 2])
