"""What jaws come to that close in the plane: for the probability that a grasp holds."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
ON_EDGE_M = cython.declare(cython.double, 1e-6)
"""A contact nearer than this to the pad's edge, metres, is on it: rounding moves it by less."""
SHORTEST_M = cython.declare(cython.double, 1e-6)
"""The least breadth that a slope is taken over, metres."""


def closed(
    starts: cython.double[:, ::1],
    ends: cython.double[:, ::1],
    hands: cython.double[:, :, ::1],
    fingers: cython.double[:, ::1],
    tip: cython.double[::1],
    tolerance: cython.double,
) -> NDArray[np.float64]:
    """What k grasps' hands come to that close on a silhouette: rows free, room, between, wedge (4, k, s).

    The silhouette's edges lead from `starts` to `ends` (e, 2). Of `hands` (k, s, 5), s of each grasp that stand near
    each other, are known the centre, the closing axis and half the opening. Each of the `fingers` (f, 2) is of jaw 0 or
    1 and has its offset across the closing axis. Its `tip` is (5,): half its width; half the width of its core; how far
    its core is from the pad's face, its near and its far end; and how far the widest jaw reaches across. Points within
    `tolerance` of the outermost are touched alike.

    `free` is 1 where the open fingers stand beside the object, with `room` between the nearer pad and it; `between` is
    1 where it is between the pads. Where these touch it only with an edge its sides make a wedge, of half of whose
    angle `wedge` is the tangent.
    """
    grasp: cython.Py_ssize_t
    hand: cython.Py_ssize_t
    jaw: cython.Py_ssize_t
    result = np.empty((4, hands.shape[0], hands.shape[1]))
    answer: cython.double[:, :, ::1] = result
    near: cython.double[:, ::1] = np.empty((starts.shape[0], 4))
    seen: cython.double[:, ::1] = np.empty((starts.shape[0], 4))
    pads: cython.double[:, ::1] = np.empty((starts.shape[0] * fingers.shape[0], 5))  # edges' ends; pad's middle
    met: cython.double[:, ::1] = np.empty((2, 3))
    for grasp in range(hands.shape[0]):
        close: cython.Py_ssize_t = _near(starts, ends, hands, grasp, tip[4], near)
        for hand in range(hands.shape[1]):
            count: cython.Py_ssize_t = _seen(near, close, hands, grasp, hand, tip[4], seen)
            for jaw in range(2):
                _jaw(seen, count, jaw, fingers, tip, hands[grasp, hand, 4], tolerance, pads, met)
            width: cython.double = met[0, 1] + met[1, 1]
            bend: cython.double = met[0, 2] * met[1, 2]
            long: cython.double = sqrt((1 + met[0, 2] * met[0, 2]) * (1 + met[1, 2] * met[1, 2]))
            answer[0, grasp, hand] = met[0, 0] * met[1, 0]
            answer[1, grasp, hand] = hands[grasp, hand, 4] + tip[2] - max(met[0, 1], met[1, 1])
            answer[2, grasp, hand] = 1.0 if width > 0 else 0.0
            answer[3, grasp, hand] = abs(met[0, 2] + met[1, 2]) / (long + 1 - bend)
    return result


@cython.cfunc
def _near(
    starts: cython.double[:, ::1],
    ends: cython.double[:, ::1],
    hands: cython.double[:, :, ::1],
    grasp: cython.Py_ssize_t,
    reach: cython.double,
    near: cython.double[:, ::1],
) -> cython.Py_ssize_t:
    """Write the edges that may pass within `reach` of the closing axis of any of a grasp's hands; returns how many.

    Seen from their mean, hands are aside by what they miss across their axes and by what their turns make of the way.
    """
    hand: cython.Py_ssize_t
    edge: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    share: cython.double = 1.0 / hands.shape[1]
    mx, my, mux, muy = 0.0, 0.0, 0.0, 0.0
    for hand in range(hands.shape[1]):
        mx, my = mx + share * hands[grasp, hand, 0], my + share * hands[grasp, hand, 1]
        mux, muy = mux + share * hands[grasp, hand, 2], muy + share * hands[grasp, hand, 3]
    aside: cython.double = SHORTEST_M  # rounding makes them differ, too
    turned: cython.double = 0.0
    for hand in range(hands.shape[1]):
        ux, uy = hands[grasp, hand, 2], hands[grasp, hand, 3]
        across: cython.double = (hands[grasp, hand, 1] - my) * ux
        aside = max(aside, abs(across - (hands[grasp, hand, 0] - mx) * uy))
        turned = max(turned, max(abs(ux - mux), abs(uy - muy)))
    for edge in range(starts.shape[0]):
        ax, ay = starts[edge, 0] - mx, starts[edge, 1] - my
        bx, by = ends[edge, 0] - mx, ends[edge, 1] - my
        limit: cython.double = reach + aside + turned * max(abs(ax) + abs(ay), abs(bx) + abs(by))
        from_x: cython.double = ay * mux - ax * muy
        to_x: cython.double = by * mux - bx * muy
        if (from_x < limit or to_x < limit) and (from_x > -limit or to_x > -limit):
            near[found, 0], near[found, 1] = starts[edge, 0], starts[edge, 1]
            near[found, 2], near[found, 3] = ends[edge, 0], ends[edge, 1]
            found += 1
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _seen(
    near: cython.double[:, ::1],
    count: cython.Py_ssize_t,
    hands: cython.double[:, :, ::1],
    grasp: cython.Py_ssize_t,
    hand: cython.Py_ssize_t,
    reach: cython.double,
    seen: cython.double[:, ::1],
) -> cython.Py_ssize_t:
    """Write the ends of edges that are `near`, x across the closing axis and y along it; how many are in `reach`."""
    edge: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    for edge in range(count):
        from_x: cython.double = near[edge, 0] - hands[grasp, hand, 0]
        from_y: cython.double = near[edge, 1] - hands[grasp, hand, 1]
        to_x: cython.double = near[edge, 2] - hands[grasp, hand, 0]
        to_y: cython.double = near[edge, 3] - hands[grasp, hand, 1]
        ax: cython.double = from_y * hands[grasp, hand, 2] - from_x * hands[grasp, hand, 3]
        bx: cython.double = to_y * hands[grasp, hand, 2] - to_x * hands[grasp, hand, 3]
        if (ax < reach or bx < reach) and (ax > -reach or bx > -reach):
            seen[found, 0], seen[found, 1] = ax, from_x * hands[grasp, hand, 2] + from_y * hands[grasp, hand, 3]
            seen[found, 2], seen[found, 3] = bx, to_x * hands[grasp, hand, 2] + to_y * hands[grasp, hand, 3]
            found += 1
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _jaw(
    seen: cython.double[:, ::1],
    count: cython.Py_ssize_t,
    jaw: cython.Py_ssize_t,
    fingers: cython.double[:, ::1],
    tip: cython.double[::1],
    face: cython.double,
    tolerance: cython.double,
    pads: cython.double[:, ::1],
    met: cython.double[:, ::1],
) -> cython.void:
    """Write what a jaw has `met` (2, 3): whether it is free; how far out it reaches, −∞ if nothing stops it; the slope.

    The first `count` edges are `seen`, and the pads' `face` is so far out along the closing axis, to the jaw's side.
    """
    place: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    met[jaw, 0], met[jaw, 1] = 1.0, -INFINITY
    for place in range(fingers.shape[0]):
        if fingers[place, 0] == jaw:
            found = _finger(seen, count, jaw, fingers[place, 1], tip, face, tolerance, pads, found, met)
    met[jaw, 2] = _slope(pads, found, met[jaw, 1], tip[0], tolerance)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _finger(
    seen: cython.double[:, ::1],
    count: cython.Py_ssize_t,
    jaw: cython.Py_ssize_t,
    offset: cython.double,
    tip: cython.double[::1],
    face: cython.double,
    tolerance: cython.double,
    pads: cython.double[:, ::1],
    found: cython.Py_ssize_t,
    met: cython.double[:, ::1],
) -> cython.Py_ssize_t:
    """Write parts of edges below the pad of the finger at `offset` into `pads`, from row `found` on, and their reach.

    The jaw is not free if it comes down on the object. Returns the row behind the last one.
    """
    index: cython.Py_ssize_t
    inside: cython.bint = False
    side: cython.double = 2 * jaw - 1
    near, far = face + tip[2], face + tip[3]
    for index in range(count):
        ax, bx = seen[index, 0], seen[index, 2]
        if (ax >= offset + tip[0] and bx >= offset + tip[0]) or (ax <= offset - tip[0] and bx <= offset - tip[0]):
            continue
        ay, by = side * seen[index, 1], side * seen[index, 3]
        if max(ay, by) < met[jaw, 1] - tolerance - ON_EDGE_M:  # farther in than what is touched
            continue
        slope: cython.double = (by - ay) / (bx - ax if bx != ax else 1.0)
        if (ax > offset) != (bx > offset) and ay + (offset - ax) * slope > 0.5 * (near + far):
            inside = not inside
        if (ax < offset + tip[1] or bx < offset + tip[1]) and (ax > offset - tip[1] or bx > offset - tip[1]):
            from_y: cython.double = ay + slope * (_clipped(ax, offset, tip[1]) - ax)
            to_y: cython.double = by + slope * (_clipped(bx, offset, tip[1]) - bx)
            if max(from_y, to_y) > near and min(from_y, to_y) < far:
                met[jaw, 0] = 0.0
        pads[found, 0] = _clipped(ax, offset, tip[0])
        pads[found, 1] = ay + slope * (pads[found, 0] - ax)
        pads[found, 2] = _clipped(bx, offset, tip[0])
        pads[found, 3] = by + slope * (pads[found, 2] - bx)
        pads[found, 4] = offset
        if max(pads[found, 1], pads[found, 3]) <= near:
            met[jaw, 1] = max(met[jaw, 1], max(pads[found, 1], pads[found, 3]))
            found += 1
    if inside:
        met[jaw, 0] = 0.0
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _clipped(x: cython.double, middle: cython.double, half: cython.double) -> cython.double:
    """The place nearest to `x` in a strip."""
    return min(max(x, middle - half), middle + half)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
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
    at_left, at_right = 0.0, 0.0
    for index in range(found):
        if max(pads[index, 1], pads[index, 3]) < level:
            continue
        rise: cython.double = pads[index, 3] - pads[index, 1]
        run: cython.double = (pads[index, 2] - pads[index, 0]) / (rise if rise != 0 else 1.0)
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
