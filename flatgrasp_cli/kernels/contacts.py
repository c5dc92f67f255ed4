"""§III.C, the final grasps: what their pads touch."""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)


def touched_aside(
    hands: cython.double[:, ::1],
    arcs: cython.double[:, :, ::1],
    candidates: cython.Py_ssize_t[::1],
    fingers: cython.double[::1],
    half: cython.double,
    tolerance: cython.double,
) -> NDArray[np.float64]:
    """How far beside the closing axis (p,) the middles lie of what the jaws of p hands touch.

    A hand (p, 4) is its centre and the unit axis out to the jaw, `candidates` (p,) name its part of the boundary among
    the `arcs` (m, k, 2). A pad touches what lies no farther than `half` from one of the jaw's `fingers` (f,), places
    across the axis, or what lies nearest to one; and of that what lies no more than `tolerance` below the highest.
    """
    hand: cython.Py_ssize_t
    point: cython.Py_ssize_t
    found = np.empty(hands.shape[0])
    middle: cython.double[::1] = found
    x: cython.double[::1] = np.empty(arcs.shape[1])
    y: cython.double[::1] = np.empty(arcs.shape[1])
    off: cython.double[::1] = np.empty(arcs.shape[1])
    for hand in range(hands.shape[0]):
        least: cython.double = INFINITY
        for point in range(arcs.shape[1]):
            dx: cython.double = arcs[candidates[hand], point, 0] - hands[hand, 0]
            dy: cython.double = arcs[candidates[hand], point, 1] - hands[hand, 1]
            x[point] = dy * hands[hand, 2] - dx * hands[hand, 3]
            y[point] = dx * hands[hand, 2] + dy * hands[hand, 3]
            off[point] = _off(x[point], fingers)
            least = min(least, off[point])
        least = max(least, half)
        highest: cython.double = -INFINITY
        for point in range(arcs.shape[1]):
            if off[point] <= least:
                highest = max(highest, y[point])
        total: cython.double = 0.0
        count: cython.double = 0.0
        for point in range(arcs.shape[1]):
            if off[point] <= least and y[point] >= highest - tolerance:
                total += x[point]
                count += 1.0
        middle[hand] = total / count
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _off(x: cython.double, fingers: cython.double[::1]) -> cython.double:
    """How far a place lies from the nearest of the fingers' middles."""
    finger: cython.Py_ssize_t
    least: cython.double = INFINITY
    for finger in range(fingers.shape[0]):
        least = min(least, abs(x - fingers[finger]))
    return least
