"""What a jaw comes to that closes in the plane: for the probability that a grasp holds."""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
ON_EDGE_M = cython.declare(cython.double, 1e-6)
"""A contact nearer than this to the pad's edge, metres, is on it: rounding moves it by less."""
SHORTEST_M = cython.declare(cython.double, 1e-6)
"""The least breadth that a slope is taken over, metres."""


def touched(
    points: cython.double[:, ::1],
    edges: cython.Py_ssize_t[::1],
    hands: cython.double[:, ::1],
    fingers: cython.double[:, ::1],
    tip: cython.double[::1],
    tolerance: cython.double,
) -> NDArray[np.float64]:
    """What the two jaws of p hands come to that close on a silhouette: rows free, reach, slope of each (2, 3, p).

    Edges of the silhouette lead from the `points` (n, 2) that `edges` (e,) name to the next ones. A hand (p, 5) is its
    centre, its closing axis and half its opening. Each of the `fingers` (f, 2) is of jaw 0 or 1 and has its offset
    across the closing axis. Its `tip` is (4,): half its width; half the width of its core; and how far its core is from
    the pad's face, its near and its far end. Points within `tolerance` of the outermost are touched alike.

    `free` is 1 where the open fingers stand beside the object, otherwise 0. The pads come to rest at `reach`, −∞ if
    nothing stops them. If they touch the object only with an edge, `slope` is how steep its side is there.
    """
    hand: cython.Py_ssize_t
    jaw: cython.Py_ssize_t
    place: cython.Py_ssize_t
    found: cython.Py_ssize_t
    met: cython.Py_ssize_t
    free: cython.bint
    result = np.empty((2, 3, hands.shape[0]))
    answer: cython.double[:, :, ::1] = result
    seen: cython.double[:, ::1] = np.empty((edges.shape[0], 4))
    # one row for each edge below a pad: its ends' x, y; and the pad's middle
    pads: cython.double[:, ::1] = np.empty((edges.shape[0] * fingers.shape[0], 5))
    widest: cython.double = tip[0]
    for place in range(fingers.shape[0]):
        widest = max(widest, abs(fingers[place, 1]) + tip[0])
    for hand in range(hands.shape[0]):
        met = _seen(points, edges, hands[hand], widest, seen)
        for jaw in range(2):
            free, found = True, 0
            for place in range(fingers.shape[0]):
                if fingers[place, 0] == jaw:
                    found = _finger(seen[:met], 2 * jaw - 1, fingers[place, 1], tip, hands[hand, 4], pads, found)
                    if found < 0:  # it comes down on the object
                        free, found = False, -1 - found
            answer[jaw, 0, hand] = 1.0 if free else 0.0
            answer[jaw, 1, hand] = _reach(pads, found)
            answer[jaw, 2, hand] = _slope(pads, found, answer[jaw, 1, hand], tip[0], tolerance)
    return result


@cython.cfunc
def _seen(
    points: cython.double[:, ::1],
    edges: cython.Py_ssize_t[::1],
    hand: cython.double[::1],
    reach: cython.double,
    seen: cython.double[:, ::1],
) -> cython.Py_ssize_t:
    """Write the edges that pass within `reach` of the closing axis into `seen`, their ends' x across it and y along it.

    Returns how many there are.
    """
    index: cython.Py_ssize_t
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    last: cython.Py_ssize_t = -1
    cx: cython.double = hand[0]
    cy: cython.double = hand[1]
    ux: cython.double = hand[2]
    uy: cython.double = hand[3]
    bx: cython.double = 0.0
    for index in range(edges.shape[0]):
        row = edges[index]
        ax: cython.double = bx
        if row != last:
            ax = (points[row, 1] - cy) * ux - (points[row, 0] - cx) * uy
        bx = (points[row + 1, 1] - cy) * ux - (points[row + 1, 0] - cx) * uy
        last = row + 1
        if (ax < reach or bx < reach) and (ax > -reach or bx > -reach):
            seen[found, 0] = ax
            seen[found, 1] = (points[row, 0] - cx) * ux + (points[row, 1] - cy) * uy
            seen[found, 2] = bx
            seen[found, 3] = (points[row + 1, 0] - cx) * ux + (points[row + 1, 1] - cy) * uy
            found += 1
    return found


@cython.cfunc
def _finger(
    seen: cython.double[:, ::1],
    side: cython.double,
    offset: cython.double,
    tip: cython.double[::1],
    face: cython.double,
    pads: cython.double[:, ::1],
    found: cython.Py_ssize_t,
) -> cython.Py_ssize_t:
    """Write the parts of edges below the pad of the finger at `offset` into `pads`, from row `found` on.

    The jaw is on the `side` −1 or +1 along the closing axis, and y is out to it. Returns the row behind the last one,
    or −1 less that if the finger comes down on the object.
    """
    index: cython.Py_ssize_t
    free: cython.bint = True
    inside: cython.bint = False
    near: cython.double = face + tip[2]
    far: cython.double = face + tip[3]
    for index in range(seen.shape[0]):
        ax: cython.double = seen[index, 0]
        bx: cython.double = seen[index, 2]
        if (ax >= offset + tip[0] and bx >= offset + tip[0]) or (ax <= offset - tip[0] and bx <= offset - tip[0]):
            continue
        ay: cython.double = side * seen[index, 1]
        by: cython.double = side * seen[index, 3]
        slope: cython.double = (by - ay) / (bx - ax if bx != ax else 1.0)
        if (ax > offset) != (bx > offset) and ay + (offset - ax) * slope > 0.5 * (near + far):
            inside = not inside
        if (ax < offset + tip[1] or bx < offset + tip[1]) and (ax > offset - tip[1] or bx > offset - tip[1]):
            from_y: cython.double = ay + slope * (_clipped(ax, offset, tip[1]) - ax)
            to_y: cython.double = by + slope * (_clipped(bx, offset, tip[1]) - bx)
            if max(from_y, to_y) > near and min(from_y, to_y) < far:
                free = False
        pads[found, 0] = _clipped(ax, offset, tip[0])
        pads[found, 1] = ay + slope * (pads[found, 0] - ax)
        pads[found, 2] = _clipped(bx, offset, tip[0])
        pads[found, 3] = by + slope * (pads[found, 2] - bx)
        pads[found, 4] = offset
        if max(pads[found, 1], pads[found, 3]) <= near:
            found += 1
    return found if free and not inside else -1 - found


@cython.cfunc
@cython.inline
def _clipped(x: cython.double, middle: cython.double, half: cython.double) -> cython.double:
    """The place nearest to `x` in a strip."""
    return min(max(x, middle - half), middle + half)


@cython.cfunc
def _reach(pads: cython.double[:, ::1], found: cython.Py_ssize_t) -> cython.double:
    """How far out the first `found` parts of edges reach."""
    index: cython.Py_ssize_t
    reach: cython.double = -INFINITY
    for index in range(found):
        reach = max(reach, max(pads[index, 1], pads[index, 3]))
    return reach


@cython.cfunc
def _slope(
    pads: cython.double[:, ::1],
    found: cython.Py_ssize_t,
    reach: cython.double,
    half: cython.double,
    tolerance: cython.double,
) -> cython.double:
    """How steeply the object's side rises toward +x where it touches the pads only at their edge; otherwise 0."""
    index: cython.Py_ssize_t
    end: cython.Py_ssize_t
    level: cython.double = reach - tolerance
    low_x: cython.double = INFINITY
    high_x: cython.double = -INFINITY
    low_y: cython.double = INFINITY
    at_left: cython.double = 0.0
    at_right: cython.double = 0.0
    for index in range(found):
        rise: cython.double = pads[index, 3] - pads[index, 1]
        run: cython.double = (pads[index, 2] - pads[index, 0]) / (rise if rise != 0 else 1.0)
        if max(pads[index, 1], pads[index, 3]) < level:
            continue
        for end in range(1, 5, 2):
            y: cython.double = max(pads[index, end], level)
            x: cython.double = pads[index, 0] + run * (y - pads[index, 1])
            low_x, high_x, low_y = min(low_x, x), max(high_x, x), min(low_y, y)
            if y >= reach - ON_EDGE_M and x <= pads[index, 4] - half + ON_EDGE_M:
                at_left = 1.0
            if y >= reach - ON_EDGE_M and x >= pads[index, 4] + half - ON_EDGE_M:
                at_right = 1.0
    if low_x > high_x:
        return 0.0
    return (at_right - at_left) * (reach - low_y) / max(high_x - low_x, SHORTEST_M)
