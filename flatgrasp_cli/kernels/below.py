"""What lies below the fingers and the palm of hands that come straight down: look-ups in height maps.

A map holds the highest point in each cell, −∞ where there is none, as all along its rim; places outside are on the rim.
"""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

UNSEEN = cython.declare(cython.double, -math.inf)
TILE = cython.declare(cython.Py_ssize_t, 8)
"""Cells along the side of a square that is passed over as a whole: it decides how long that takes, and nothing else."""


@cython.cfunc
@cython.inline
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
    that its fingers cover, each the jaw, 0 or 1, and its offset. From the pads outward the maps are looked up every
    half cell and each cell from there, as often as `reach` (m, p) says and once more; the first `at_contact` times in
    the map `rest`, then in the `highest`. Both maps are on the `grid` (3,): origin and cell.
    """
    hand: cython.Py_ssize_t
    jaw: cython.Py_ssize_t
    step: cython.Py_ssize_t
    row: cython.Py_ssize_t
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
                heights: cython.double[:, ::1] = rest if step < at_contact else highest
                met: tuple[cython.double, cython.double] = _across(
                    hands, hand, fingers, jaw, (2 * jaw - 1) * out, heights, grid
                )
                most = max(most, met[0])
                dark_m += grid[2] * met[1]
                for row in range(reach.shape[0]):
                    if reach[row, hand] == step:
                        answer[0, row, hand] = max(answer[0, row, hand], most)
                        answer[1, row, hand] += dark_m
    return found


@cython.cfunc
@cython.inline
def _across(
    hands: cython.double[:, ::1],
    hand: cython.Py_ssize_t,
    fingers: cython.double[:, ::1],
    jaw: cython.Py_ssize_t,
    along: cython.double,
    heights: cython.double[:, ::1],
    grid: cython.double[::1],
) -> tuple[cython.double, cython.double]:
    """What a jaw's fingers meet `along` the closing axis: the highest point, and the share that is dark."""
    place: cython.Py_ssize_t
    count: cython.double = 0.0
    dark: cython.double = 0.0
    most: cython.double = UNSEEN
    per_cell: cython.double = 1.0 / grid[2]
    row: cython.double = (hands[hand, 0] + along * hands[hand, 2] - grid[0]) * per_cell
    column: cython.double = (hands[hand, 1] + along * hands[hand, 3] - grid[1]) * per_cell
    down: cython.double = -hands[hand, 3] * per_cell
    right: cython.double = hands[hand, 2] * per_cell
    for place in range(fingers.shape[0]):
        if fingers[place, 0] == jaw:
            first: cython.Py_ssize_t = _bounded(row + fingers[place, 1] * down, heights.shape[0])
            height: cython.double = heights[first, _bounded(column + fingers[place, 1] * right, heights.shape[1])]
            most = max(most, height)
            dark += height == UNSEEN
            count += 1.0
    return most, dark / max(count, 1.0)


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
    place: cython.Py_ssize_t
    share: cython.double[::1] = np.zeros(2)  # of all places, those of each jaw
    for place in range(fingers.shape[0]):
        share[1 if fingers[place, 0] == 1 else 0] += 1.0 / (fingers.shape[0] * out.shape[0])
    found = np.empty((2, hands.shape[0]))
    answer: cython.double[:, ::1] = found
    for hand in range(hands.shape[0]):
        most: cython.double = UNSEEN
        dark: cython.double = 0.0
        for jaw in range(2):
            for step in range(out.shape[0]):
                along: cython.double = (2 * jaw - 1) * (hands[hand, 4] + out[step])
                met: tuple[cython.double, cython.double] = _across(hands, hand, fingers, jaw, along, heights, grid)
                most = max(most, met[0])
                dark += share[jaw] * met[1]
        answer[0, hand], answer[1, hand] = most, dark
    return found


def tops(heights: cython.double[:, ::1]) -> NDArray[np.float64]:
    """The highest of each square of TILE × TILE cells of a map."""
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    shape = (heights.shape[0] + TILE - 1) // TILE, (heights.shape[1] + TILE - 1) // TILE
    found = np.full(shape, -math.inf)
    top: cython.double[:, ::1] = found
    for row in range(heights.shape[0]):
        for column in range(heights.shape[1]):
            top[row // TILE, column // TILE] = max(top[row // TILE, column // TILE], heights[row, column])
    return found


def under_palm(
    hands: cython.double[:, ::1],
    heights: cython.double[:, ::1],
    tops: cython.double[:, ::1],
    grid: cython.double[::1],
    least: cython.double,
    across: cython.double,
    along: cython.double[:, ::1],
) -> NDArray[np.float64]:
    """Highest point (m, p) below palms that reach `across` and `along` (m, p) the closing axis to each side, metres.

    A hand (p, 4 or more) is its centre and its closing axis. Only cells that are higher than `least` count, by their
    middles; −∞ if there is none below a palm. The map's `tops` tell which squares have any.
    """
    hand: cython.Py_ssize_t
    row: cython.Py_ssize_t
    index: cython.Py_ssize_t
    tiles: cython.Py_ssize_t[:, ::1] = _tiles(hands, tops, grid, least, across, along)
    radius: cython.double = TILE * grid[2]  # of a circle around a tile, and some more
    found = np.full((along.shape[0], along.shape[1]), -math.inf)
    answer: cython.double[:, ::1] = found
    for hand in range(hands.shape[0] if tiles.shape[0] > 0 else 0):
        longest: cython.double = 0.0
        for row in range(along.shape[0]):
            longest = max(longest, along[row, hand])
        for index in range(tiles.shape[0]):
            dx: cython.double = grid[0] + grid[2] * TILE * (tiles[index, 0] + 0.5) - hands[hand, 0]
            dy: cython.double = grid[1] + grid[2] * TILE * (tiles[index, 1] + 0.5) - hands[hand, 1]
            if abs(dy * hands[hand, 2] - dx * hands[hand, 3]) > across + radius:
                continue
            if abs(dx * hands[hand, 2] + dy * hands[hand, 3]) > longest + radius:
                continue
            lowest: cython.double = math.inf
            for row in range(along.shape[0]):
                lowest = min(lowest, answer[row, hand])
            if tops[tiles[index, 0], tiles[index, 1]] > lowest:
                _in_tile(hands, hand, heights, grid, tiles, index, least, across, along, answer)
    return found


@cython.cfunc
def _tiles(
    hands: cython.double[:, ::1],
    tops: cython.double[:, ::1],
    grid: cython.double[::1],
    least: cython.double,
    across: cython.double,
    along: cython.double[:, ::1],
) -> cython.Py_ssize_t[:, ::1]:
    """Rows and columns (k, 2) of the squares that are higher than `least`, and in the box around all palms."""
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    hand: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    tiles: cython.Py_ssize_t[:, ::1] = np.empty((tops.shape[0] * tops.shape[1], 2), dtype=np.intp)
    box: cython.double[::1] = np.array([math.inf, -math.inf, math.inf, -math.inf])
    for hand in range(hands.shape[0]):
        for row in range(along.shape[0]):
            reach: cython.double = across + along[row, hand] + TILE * grid[2]
            box[0], box[1] = min(box[0], hands[hand, 0] - reach), max(box[1], hands[hand, 0] + reach)
            box[2], box[3] = min(box[2], hands[hand, 1] - reach), max(box[3], hands[hand, 1] + reach)
    for row in range(tops.shape[0]):
        x: cython.double = grid[0] + grid[2] * TILE * (row + 0.5)
        for column in range(tops.shape[1] if box[0] < x < box[1] else 0):
            y: cython.double = grid[1] + grid[2] * TILE * (column + 0.5)
            if tops[row, column] > least and box[2] < y < box[3]:
                tiles[found, 0], tiles[found, 1] = row, column
                found += 1
    return tiles[:found]


@cython.cfunc
@cython.inline
def _in_tile(
    hands: cython.double[:, ::1],
    hand: cython.Py_ssize_t,
    heights: cython.double[:, ::1],
    grid: cython.double[::1],
    tiles: cython.Py_ssize_t[:, ::1],
    tile: cython.Py_ssize_t,
    least: cython.double,
    across: cython.double,
    along: cython.double[:, ::1],
    answer: cython.double[:, ::1],
) -> cython.void:
    """Raise a hand's column of the `answer` to the highest cell of a tile that lies below its palm."""
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    opening: cython.Py_ssize_t
    first_row: cython.Py_ssize_t = TILE * tiles[tile, 0]
    first_column: cython.Py_ssize_t = TILE * tiles[tile, 1]
    for row in range(first_row, min(first_row + TILE, heights.shape[0])):
        dx: cython.double = grid[0] + grid[2] * (row + 0.5) - hands[hand, 0]
        for column in range(first_column, min(first_column + TILE, heights.shape[1])):
            if heights[row, column] <= least:
                continue
            dy: cython.double = grid[1] + grid[2] * (column + 0.5) - hands[hand, 1]
            if abs(dy * hands[hand, 2] - dx * hands[hand, 3]) > across:
                continue
            y: cython.double = abs(dx * hands[hand, 2] + dy * hands[hand, 3])
            for opening in range(along.shape[0]):
                if y <= along[opening, hand]:
                    answer[opening, hand] = max(answer[opening, hand], heights[row, column])
