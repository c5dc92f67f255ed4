"""What lies below the fingers of hands that come straight down: look-ups in height maps.

A map holds the highest point in each cell, −∞ where there is none, as all along its rim; places outside are on the rim.
"""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

UNSEEN = cython.declare(cython.double, -math.inf)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _bounded(cells: cython.double, count: cython.Py_ssize_t) -> cython.Py_ssize_t:
    """The row or column that holds a place so many cells from the first; those outside are on the rim."""
    return cython.cast(cython.Py_ssize_t, min(max(cells, 0.0), count - 1.0))


def under_fingers(
    hands: cython.double[:, ::1],
    fingers: cython.double[:, ::1],
    reach: cython.Py_ssize_t[:, ::1],
    at_contact: cython.Py_ssize_t,
    rest: cython.double[:, ::1],
    highest: cython.double[:, ::1],
    grid: cython.double[::1],
) -> NDArray[np.float64]:
    """Highest point, and length that no ray reached, metres, (2, m, p) below the fingers of p hands.

    A hand (p, 5) is its centre, its closing axis and half the opening; `fingers` (f, 2) are the places across a jaw
    that its fingers cover, each the jaw, 0 or 1, and its offset, those of jaw 0 first. From the pads outward the maps
    are looked up every half cell and each cell from there, as often as `reach` (m, p) says and once more; the first
    `at_contact` times in the map `rest`, then in the `highest`. Both maps are on the `grid` (3,): origin and cell.
    """
    hand: cython.Py_ssize_t
    jaw: cython.Py_ssize_t
    step: cython.Py_ssize_t
    row: cython.Py_ssize_t
    met: tuple[cython.double, cython.double]
    ends: cython.Py_ssize_t[::1] = _ends(fingers)
    found = np.full((2, reach.shape[0], reach.shape[1]), 0.0)
    found[0] = -math.inf
    answer: cython.double[:, :, ::1] = found
    for hand in range(hands.shape[0]):
        last: cython.Py_ssize_t = 0
        for row in range(reach.shape[0]):
            last = max(last, reach[row, hand])
        for jaw in range(2):
            most: cython.double = UNSEEN
            dark_m: cython.double = 0.0
            for step in range(last + 1):
                out: cython.double = (step + 0.5) * grid[2] + hands[hand, 4]
                along: cython.double = (2 * jaw - 1) * out
                # no view of whichever map it is: to take one takes as long as several look-ups
                if step < at_contact:
                    met = _across(hands, hand, fingers, ends[jaw], ends[jaw + 1], along, rest, grid)
                else:
                    met = _across(hands, hand, fingers, ends[jaw], ends[jaw + 1], along, highest, grid)
                most = max(most, met[0])
                dark_m += grid[2] * met[1]
                for row in range(reach.shape[0]):
                    if reach[row, hand] == step:
                        answer[0, row, hand] = max(answer[0, row, hand], most)
                        answer[1, row, hand] += dark_m
    return found


@cython.cfunc
def _ends(fingers: cython.double[:, ::1]) -> cython.Py_ssize_t[::1]:
    """Where the places of each jaw begin and end (3,)."""
    place: cython.Py_ssize_t
    first: cython.Py_ssize_t = 0
    for place in range(fingers.shape[0]):
        first += fingers[place, 0] == 0
    return np.array([0, first, fingers.shape[0]])


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _across(
    hands: cython.double[:, ::1],
    hand: cython.Py_ssize_t,
    fingers: cython.double[:, ::1],
    begin: cython.Py_ssize_t,
    end: cython.Py_ssize_t,
    along: cython.double,
    heights: cython.double[:, ::1],
    grid: cython.double[::1],
) -> tuple[cython.double, cython.double]:
    """What fingers, places `begin` to `end`, meet `along` the closing axis: the highest point, and the dark share."""
    place: cython.Py_ssize_t
    dark: cython.Py_ssize_t = 0
    most: cython.double = UNSEEN
    per_cell: cython.double = 1.0 / grid[2]
    row: cython.double = (hands[hand, 0] + along * hands[hand, 2] - grid[0]) * per_cell
    column: cython.double = (hands[hand, 1] + along * hands[hand, 3] - grid[1]) * per_cell
    down: cython.double = -hands[hand, 3] * per_cell
    right: cython.double = hands[hand, 2] * per_cell
    for place in range(begin, end):
        first: cython.Py_ssize_t = _bounded(row + fingers[place, 1] * down, heights.shape[0])
        height: cython.double = heights[first, _bounded(column + fingers[place, 1] * right, heights.shape[1])]
        most = max(most, height)
        dark += height == UNSEEN
    return most, cython.cast(cython.double, dark) / max(end - begin, 1)


def under_tips(
    hands: cython.double[:, ::1],
    fingers: cython.double[:, ::1],
    out: cython.double[::1],
    heights: cython.double[:, ::1],
    grid: cython.double[::1],
) -> NDArray[np.float64]:
    """Highest point, metres, and share that no ray reached (2, p), below the middles of the fingertips of p hands.

    Arguments are those of `under_fingers`; the map is looked up at the distances `out` (k,) from the pads.
    """
    hand: cython.Py_ssize_t
    jaw: cython.Py_ssize_t
    step: cython.Py_ssize_t
    ends: cython.Py_ssize_t[::1] = _ends(fingers)
    all_places: cython.double = fingers.shape[0] * out.shape[0]
    found = np.empty((2, hands.shape[0]))
    answer: cython.double[:, ::1] = found
    for hand in range(hands.shape[0]):
        most: cython.double = UNSEEN
        dark: cython.double = 0.0
        for jaw in range(2):
            share: cython.double = (ends[jaw + 1] - ends[jaw]) / all_places
            for step in range(out.shape[0]):
                along: cython.double = (2 * jaw - 1) * (hands[hand, 4] + out[step])
                met: tuple[cython.double, cython.double] = _across(
                    hands, hand, fingers, ends[jaw], ends[jaw + 1], along, heights, grid
                )
                most = max(most, met[0])
                dark += share * met[1]
        answer[0, hand], answer[1, hand] = most, dark
    return found
