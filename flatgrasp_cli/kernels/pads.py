"""§III.B.3 and B.5: how far boundaries reach out to the pads, and where sweeping fingers come to rest."""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)


def extents(
    middle: cython.double[:, ::1],
    axis: cython.double[:, ::1],
    arcs: cython.double[:, :, ::1],
    pairs: cython.Py_ssize_t[:, ::1],
) -> NDArray[np.float64]:
    """How far (2, p) the boundaries of `pairs` (2, p) reach out along −axis and along +axis, metres.

    Pairs have a `middle` and a closing `axis` (p, 2); `arcs` (m, k, 2) are points on each candidate's boundary.
    """
    pair: cython.Py_ssize_t
    side: cython.Py_ssize_t
    point: cython.Py_ssize_t
    found = np.full((2, middle.shape[0]), -math.inf)
    reach: cython.double[:, ::1] = found
    for pair in range(middle.shape[0]):
        for side in range(2):
            sign: cython.double = 2 * side - 1
            arc: cython.Py_ssize_t = pairs[side, pair]
            for point in range(arcs.shape[1]):
                dx: cython.double = arcs[arc, point, 0] - middle[pair, 0]
                dy: cython.double = arcs[arc, point, 1] - middle[pair, 1]
                reach[side, pair] = max(reach[side, pair], sign * (dx * axis[pair, 0] + dy * axis[pair, 1]))
    return found


def swept(
    points: cython.double[:, ::1],
    edges: cython.Py_ssize_t[::1],
    hands: cython.double[:, ::1],
    fingers: cython.double[:, ::1],
    half: cython.double,
    level: cython.double[:, ::1],
) -> NDArray[np.float64]:
    """Where the pads of p hands come to rest and how far each jaw could back off (2, 2, p), by the whole silhouette.

    Edges lead from the `points` (n, 2) that `edges` (e,) name to the next ones. A hand (p, 4) is its middle and its
    closing axis; each of the `fingers` (f, 2) is of jaw 0 or 1, which are out along −axis and +axis, has its offset
    across the axis and is twice `half` wide. A pad rests on the outermost boundary before its finger up to `level`
    (2, p). The next one ends the room; there is none where boundary runs on through the level, or nothing is touched.
    """
    hand: cython.Py_ssize_t
    jaw: cython.Py_ssize_t
    finger: cython.Py_ssize_t
    found = np.zeros((2, 2, hands.shape[0]))
    answer: cython.double[:, :, ::1] = found
    seen: cython.double[:, ::1] = np.empty((points.shape[0], 2))
    rest: cython.double[::1] = np.empty(2)  # the pad, and the obstacle behind it
    for hand in range(hands.shape[0]):
        _see(points, hands, hand, seen)
        for jaw in range(2):
            rest[0], rest[1] = -INFINITY, INFINITY
            for finger in range(fingers.shape[0]):
                if fingers[finger, 0] == jaw:
                    _sweep(seen, edges, 2 * jaw - 1, fingers[finger, 1], half, level[jaw, hand], rest)
            if rest[0] > -INFINITY:
                answer[0, jaw, hand] = rest[0]
                answer[1, jaw, hand] = max(rest[1] - rest[0], 0.0)
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _see(
    points: cython.double[:, ::1], hands: cython.double[:, ::1], hand: cython.Py_ssize_t, seen: cython.double[:, ::1]
) -> cython.void:
    """Write the points as they are `seen` (n, 2) from a hand: x across the closing axis, and y along it."""
    row: cython.Py_ssize_t
    for row in range(points.shape[0]):
        dx: cython.double = points[row, 0] - hands[hand, 0]
        dy: cython.double = points[row, 1] - hands[hand, 1]
        seen[row, 0] = dy * hands[hand, 2] - dx * hands[hand, 3]
        seen[row, 1] = dx * hands[hand, 2] + dy * hands[hand, 3]


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _sweep(
    seen: cython.double[:, ::1],
    edges: cython.Py_ssize_t[::1],
    side: cython.double,
    offset: cython.double,
    half: cython.double,
    level: cython.double,
    rest: cython.double[::1],
) -> cython.void:
    """Move the pad out and the obstacle in by what one finger meets, y out to its jaw, which is on that `side`."""
    index: cython.Py_ssize_t
    row: cython.Py_ssize_t
    inside: cython.bint = False
    low: cython.double = offset - half
    high: cython.double = offset + half
    for index in range(edges.shape[0]):
        row = edges[index]
        ax: cython.double = seen[row, 0]
        bx: cython.double = seen[row + 1, 0]
        if (ax >= high and bx >= high) or (ax <= low and bx <= low):
            continue
        ay: cython.double = side * seen[row, 1]
        by: cython.double = side * seen[row + 1, 1]
        slope: cython.double = (by - ay) / (bx - ax if bx != ax else 1.0)
        if (ax > offset) != (bx > offset) and ay + (offset - ax) * slope > level:
            inside = not inside
        begin: cython.double = ay + slope * (min(max(ax, low), high) - ax)
        end: cython.double = by + slope * (min(max(bx, low), high) - bx)
        if max(begin, end) <= level:
            rest[0] = max(rest[0], max(begin, end))
        else:
            rest[1] = min(rest[1], min(begin, end))
    if rest[1] < level or inside:
        rest[1] = -INFINITY
