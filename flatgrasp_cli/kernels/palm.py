"""What lies below the palm of hands that come straight down: a search for the highest cell of a height map.

A map holds the highest point in each cell, −∞ where there is none. Squares of cells are passed over by their tops.
"""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

TILE = cython.declare(cython.Py_ssize_t, 8)
"""Cells along the side of a square that is passed over as a whole: it decides how long that takes, and nothing else."""


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
    middles: cython.double[:, ::1] = np.empty((tiles.shape[0], 2))
    for index in range(tiles.shape[0]):
        middles[index, 0] = grid[0] + grid[2] * TILE * (tiles[index, 0] + 0.5)
        middles[index, 1] = grid[1] + grid[2] * TILE * (tiles[index, 1] + 0.5)
    found = np.full((along.shape[0], along.shape[1]), -math.inf)
    answer: cython.double[:, ::1] = found
    for hand in range(hands.shape[0] if tiles.shape[0] > 0 else 0):
        longest: cython.double = 0.0
        x, y, ux, uy = hands[hand, 0], hands[hand, 1], hands[hand, 2], hands[hand, 3]
        half: cython.double = 0.5 * TILE * grid[2] * (abs(ux) + abs(uy))  # of a tile, seen along the closing axis
        for row in range(along.shape[0]):
            longest = max(longest, along[row, hand])
        for index in range(tiles.shape[0]):
            dx: cython.double = middles[index, 0] - x
            dy: cython.double = middles[index, 1] - y
            if abs(dy * ux - dx * uy) > across + half or abs(dx * ux + dy * uy) > longest + half:
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
@cython.exceptval(check=False)
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
    # numbers that no array holds: a compiler cannot know that writing to one does not change another
    ux, uy = hands[hand, 2], hands[hand, 3]
    x, y, low_x, low_y, size = hands[hand, 0], hands[hand, 1], grid[0], grid[1], grid[2]
    for row in range(first_row, min(first_row + TILE, heights.shape[0])):
        dx: cython.double = low_x + size * (row + 0.5) - x
        for column in range(first_column, min(first_column + TILE, heights.shape[1])):
            if heights[row, column] <= least:
                continue
            dy: cython.double = low_y + size * (column + 0.5) - y
            if abs(dy * ux - dx * uy) > across:
                continue
            ahead: cython.double = abs(dx * ux + dy * uy)
            for opening in range(along.shape[0]):
                if ahead <= along[opening, hand]:
                    answer[opening, hand] = max(answer[opening, hand], heights[row, column])
