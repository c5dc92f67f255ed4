"""What pads rest on: profiles across an outline, in height maps, and how far walls lean.

A chord (6,) is its middle, the way along it and the unit way inward. Maps are on a `grid` (3,), origin and cell; of the
`surface`, the mean heights of an object, cells are −∞ where it was not seen, and `highest` are those of its points.
"""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

NARROW = cython.declare(cython.double, 1e-9)
"""Metres; stands for a rise of 0."""
UNSEEN = cython.declare(cython.double, -math.inf)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _cell(
    place: cython.double, low: cython.double, cell_m: cython.double, count: cython.Py_ssize_t
) -> cython.Py_ssize_t:
    """The cell that holds a place, out of `count` from `low`."""
    return cython.cast(cython.Py_ssize_t, min(max((place - low) / cell_m, 0.0), count - 1.0))


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _look(
    chords: cython.double[:, ::1],
    chord: cython.Py_ssize_t,
    inward: cython.double,
    along: cython.double[::1],
    surface: cython.double[:, ::1],
    highest: cython.double[:, ::1],
    grid: cython.double[::1],
    seen: cython.double[:, ::1],
) -> cython.void:
    """Write what is `seen` (2, a) of both maps so far inward, at the shares `along` (a,) a chord."""
    place: cython.Py_ssize_t
    for place in range(along.shape[0]):
        x: cython.double = chords[chord, 0] + along[place] * chords[chord, 2] + inward * chords[chord, 4]
        y: cython.double = chords[chord, 1] + along[place] * chords[chord, 3] + inward * chords[chord, 5]
        row: cython.Py_ssize_t = _cell(x, grid[0], grid[2], surface.shape[0])
        column: cython.Py_ssize_t = _cell(y, grid[1], grid[2], surface.shape[1])
        seen[0, place], seen[1, place] = surface[row, column], highest[row, column]


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _mean(values: cython.double[:, ::1], of: cython.Py_ssize_t) -> cython.double:
    """The mean of a row of what was seen, of the places where the surface was; NaN if there are none."""
    place: cython.Py_ssize_t
    count: cython.double = 0.0
    total: cython.double = 0.0
    for place in range(values.shape[1]):
        if values[0, place] > UNSEEN:
            count += 1.0
            total += values[of, place]
    return total / count if count > 0 else math.nan


def profile(
    chords: cython.double[:, ::1],
    inward: cython.double[::1],
    along: cython.double[::1],
    surface: cython.double[:, ::1],
    highest: cython.double[:, ::1],
    grid: cython.double[::1],
) -> NDArray[np.float64]:
    """Mean heights (d, m) of the highest points at distances `inward` (d,) from m chords; NaN where none was seen."""
    chord: cython.Py_ssize_t
    step: cython.Py_ssize_t
    seen: cython.double[:, ::1] = np.empty((2, along.shape[0]))
    found = np.empty((inward.shape[0], chords.shape[0]))
    mean: cython.double[:, ::1] = found
    for chord in range(chords.shape[0]):
        for step in range(inward.shape[0]):
            _look(chords, chord, inward[step], along, surface, highest, grid, seen)
            mean[step, chord] = _mean(seen, 1)
    return found


@cython.cfunc
def _median(values: cython.double[::1]) -> cython.double:
    """The middle one of an odd number of values, which are sorted in place."""
    place: cython.Py_ssize_t
    other: cython.Py_ssize_t
    for place in range(1, values.shape[0]):
        value: cython.double = values[place]
        other = place
        while other > 0 and values[other - 1] > value:
            values[other] = values[other - 1]
            other -= 1
        values[other] = value
    return values[values.shape[0] // 2]


def faces(
    chords: cython.double[:, ::1],
    inward: cython.double[::1],
    along: cython.double[::1],
    surface: cython.double[:, ::1],
    highest: cython.double[:, ::1],
    grid: cython.double[::1],
    level: cython.double,
    near: cython.Py_ssize_t,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Rows top, boundary and foot (3, m) of the walls before m chords; their crests (d, m); and means (d, m).

    The first `near` of the distances `inward` (d,) can show the wall's top and foot, medians along the pad, and are its
    boundary, a mean: the `level` where nothing was seen. The mean of an upright face is halfway between its ends.
    Crests are medians of the `highest` points, 0 where nothing was seen; means are those of `profile`.
    """
    chord: cython.Py_ssize_t
    step: cython.Py_ssize_t
    place: cython.Py_ssize_t
    seen: cython.double[:, ::1] = np.empty((2, along.shape[0]))
    pad: cython.double[::1] = np.empty(along.shape[0])
    ends: cython.double[:, ::1] = np.empty((2, along.shape[0]))
    figures = np.empty((3, chords.shape[0]))
    crests, means = np.empty((2, inward.shape[0], chords.shape[0]))
    wall: cython.double[:, ::1] = figures
    mean: cython.double[:, ::1] = means
    crest: cython.double[:, ::1] = crests
    for chord in range(chords.shape[0]):
        count: cython.double = 0.0
        total: cython.double = 0.0
        ends[0], ends[1] = UNSEEN, -UNSEEN
        for step in range(inward.shape[0]):
            _look(chords, chord, inward[step], along, surface, highest, grid, seen)
            mean[step, chord] = _mean(seen, 1)
            for place in range(along.shape[0]):
                pad[place] = seen[1, place] if seen[0, place] > UNSEEN else 0.0
            crest[step, chord] = _median(pad)
            for place in range(along.shape[0] if step < near else 0):
                ends[0, place] = max(ends[0, place], seen[0, place])
                if seen[0, place] > UNSEEN:
                    count += 1.0
                    total += seen[0, place]
                    ends[1, place] = min(ends[1, place], 2 * seen[0, place] - seen[1, place])
        for place in range(along.shape[0]):
            ends[0, place] = ends[0, place] if ends[0, place] > UNSEEN else level
            ends[1, place] = min(ends[1, place], ends[0, place])
        wall[0, chord], wall[2, chord] = _median(ends[0]), _median(ends[1])
        wall[1, chord] = total / count if count > 0 else level
    return figures, crests, means


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _recess(
    crests: cython.double[:, ::1], chord: cython.Py_ssize_t, inward: cython.double[::1], level: cython.double
) -> cython.double:
    """How far inward of its chord a wall comes up to a level; one that never does begins at the last place.

    Before the first place it goes on as between the first two: there a round side comes up to most of its height.
    """
    above: cython.Py_ssize_t = 1
    while above < inward.shape[0] - 1 and crests[above, chord] < level:
        above += 1
    low: cython.double = crests[above - 1, chord]
    share: cython.double = min((level - low) / max(crests[above, chord] - low, NARROW), 1.0)
    return max(inward[above - 1] + share * (inward[above] - inward[above - 1]), 0.0)


def leans(
    crests: cython.double[:, ::1],
    inward: cython.double[::1],
    pairs: cython.Py_ssize_t[:, ::1],
    tip: cython.double[::1],
    wall: cython.double[::1],
    raised: cython.Py_ssize_t,
    noise: cython.double,
) -> NDArray[np.float64]:
    """Tangents (p, raised) of the angle by which the walls of `pairs` (2, p) lean, over the lower half of the grip.

    The `crests` (d, m) are those of `faces`, at the distances `inward` (d,). Fingertips end at `tip` (p,), below the
    top of the `wall` (p,), or higher by equal shares of the grip, and walls lean at least as much there. Heights are
    known to some `noise`.
    """
    pair: cython.Py_ssize_t
    step: cython.Py_ssize_t
    found = np.empty((pairs.shape[1], raised))
    lean: cython.double[:, ::1] = found
    for pair in range(pairs.shape[1]):
        most: cython.double = UNSEEN
        for step in range(raised):
            end: cython.double = tip[pair] + step / cython.cast(cython.double, raised) * (wall[pair] - tip[pair])
            half: cython.double = 0.5 * max(wall[pair] - end, noise)
            one: cython.double = _recess(crests, pairs[0, pair], inward, end + half) / half
            other: cython.double = _recess(crests, pairs[1, pair], inward, end + half) / half
            # the tangent of half the sum of their angles
            aslant: cython.double = sqrt((1 + one * one) * (1 + other * other)) + 1 - one * other
            most = max(most, (one + other) / aslant)
            lean[pair, step] = most
    return found
