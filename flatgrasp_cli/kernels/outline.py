"""§III.A.3: walking along a boundary, and what lies inside it.

Loops are (n, 2), closed by their first vertex. Regions are the edges of all their loops, from `starts` to `ends`
(n, 2), and lie to the left of them.
"""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import copysign, fmod, sqrt
from numpy.typing import NDArray

NAN = cython.declare(cython.double, math.nan)


def contains(
    starts: cython.double[:, ::1], ends: cython.double[:, ::1], points: cython.double[:, :]
) -> NDArray[np.bool_]:
    """Which of the `points` (m, 2) lie in a region."""
    point: cython.Py_ssize_t
    found = np.empty(points.shape[0], dtype=np.uint8)
    inside: cython.uchar[::1] = found
    for point in range(points.shape[0]):
        inside[point] = _inside(starts, ends, points[point, 0], points[point, 1])
    return found.view(np.bool_)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _inside(
    starts: cython.double[:, ::1], ends: cython.double[:, ::1], x: cython.double, y: cython.double
) -> cython.bint:
    """Even-odd crossing number with the half-open rule: a ray through a vertex counts once."""
    edge: cython.Py_ssize_t
    odd: cython.bint = False
    for edge in range(starts.shape[0]):
        ay: cython.double = starts[edge, 1]
        by: cython.double = ends[edge, 1]
        if (ay > y) != (by > y):
            slope: cython.double = (ends[edge, 0] - starts[edge, 0]) / (by - ay)
            if x < starts[edge, 0] + slope * (y - ay):
                odd = not odd
    return odd


def shares_inside(
    starts: cython.double[:, ::1],
    ends: cython.double[:, ::1],
    begins: cython.double[:, ::1],
    along: cython.double[:, ::1],
) -> NDArray[np.float64]:
    """The share (m,) of each segment, from `begins` on and `along` (m, 2), that lies in a region.

    Summing the segment's parameter over its crossings, + where it leaves the region and − where it enters, measures the
    length inside; a segment that ends inside adds 1.
    """
    edge: cython.Py_ssize_t
    segment: cython.Py_ssize_t
    found = np.empty(begins.shape[0])
    share: cython.double[::1] = found
    for segment in range(begins.shape[0]):
        lx: cython.double = along[segment, 0]
        ly: cython.double = along[segment, 1]
        total: cython.double = _inside(starts, ends, begins[segment, 0] + lx, begins[segment, 1] + ly)
        for edge in range(starts.shape[0]):
            fx: cython.double = starts[edge, 0] - begins[segment, 0]
            fy: cython.double = starts[edge, 1] - begins[segment, 1]
            ex: cython.double = ends[edge, 0] - starts[edge, 0]
            ey: cython.double = ends[edge, 1] - starts[edge, 1]
            side: cython.double = lx * fy - ly * fx  # of the edge's start against the segment's line
            leaves: cython.double = lx * ey - ly * ex  # the region lies left of the edge: + leaves it
            if (side > 0) != (side + leaves > 0):
                t: cython.double = (fx * ey - fy * ex) / leaves
                if 0 < t < 1:
                    total += copysign(t, leaves)
        share[segment] = min(max(total, 0.0), 1.0)
    return found


def arc_lengths(loop: cython.const[cython.double][:, :]) -> NDArray[np.float64]:  # type: ignore[valid-type]
    """Arc length (n + 1,) at each vertex, the last entry being the perimeter."""
    vertex: cython.Py_ssize_t
    found = np.zeros(loop.shape[0] + 1)
    arc: cython.double[::1] = found
    for vertex in range(loop.shape[0]):
        after: cython.Py_ssize_t = vertex + 1 if vertex + 1 < loop.shape[0] else 0
        x: cython.double = loop[after, 0] - loop[vertex, 0]
        y: cython.double = loop[after, 1] - loop[vertex, 1]
        arc[vertex + 1] = arc[vertex] + sqrt(x * x + y * y)
    return found


def places(
    loop: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    arc: cython.double[::1],
    positions: cython.const[cython.double][::1],  # type: ignore[valid-type]
) -> NDArray[np.float64]:
    """Points (m, 2) of the loop at arc lengths `positions` (m,), modulo the perimeter; its vertices are at `arc`."""
    index: cython.Py_ssize_t
    edge: cython.Py_ssize_t = 0
    count: cython.Py_ssize_t = loop.shape[0]
    found = np.empty((positions.shape[0], 2))
    place: cython.double[:, ::1] = found
    for index in range(positions.shape[0]):
        at: cython.double = fmod(positions[index], arc[count])
        at = at + arc[count] if at < 0 else at
        while at < arc[edge]:  # as a rule the next one is near
            edge -= 1
        while edge + 1 < count and arc[edge + 1] <= at:
            edge += 1
        after: cython.Py_ssize_t = edge + 1 if edge + 1 < count else 0
        length: cython.double = arc[edge + 1] - arc[edge]
        place[index, 0] = (loop[after, 0] - loop[edge, 0]) / length * (at - arc[edge]) + loop[edge, 0]
        place[index, 1] = (loop[after, 1] - loop[edge, 1]) / length * (at - arc[edge]) + loop[edge, 1]
    return found


def chord_walk(loop: cython.double[:, :], arc: cython.double[::1], radius: cython.double) -> NDArray[np.float64]:
    """Arc lengths (s,) of points met by stepping `radius` in a straight line from vertex 0 once around the loop.

    `arc` (n + 1,) is the arc length at each vertex, and the perimeter. Eq. (1) of the paper, d₁ₙ ≤ r ≤ d₁ₙ₊₁.
    """
    vertex: cython.Py_ssize_t
    following: cython.Py_ssize_t
    found: cython.Py_ssize_t = 1
    walked = np.zeros(
        int(arc[loop.shape[0]] / radius) + 2
    )  # steps along the boundary are no shorter than straight ones
    positions: cython.double[::1] = walked
    cx: cython.double = loop[0, 0]
    cy: cython.double = loop[0, 1]
    for vertex in range(loop.shape[0]):
        following = vertex + 1 if vertex + 1 < loop.shape[0] else 0
        length: cython.double = arc[vertex + 1] - arc[vertex]
        ax: cython.double = loop[vertex, 0]
        ay: cython.double = loop[vertex, 1]
        ux: cython.double = (loop[following, 0] - ax) / length
        uy: cython.double = (loop[following, 1] - ay) / length
        while _is_beyond(loop[following, 0] - cx, loop[following, 1] - cy, radius) and found < positions.shape[0]:
            along: cython.double = _leaves(cx - ax, cy - ay, ux, uy, radius)
            positions[found] = arc[vertex] + along
            found += 1
            cx = ax + along * ux
            cy = ay + along * uy
    walked_on: NDArray[np.float64] = walked[:found]
    return walked_on


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _is_beyond(x: cython.double, y: cython.double, radius: cython.double) -> cython.bint:
    """Whether a place lies outside the circle around the origin."""
    return x * x + y * y > radius * radius


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _leaves(
    px: cython.double, py: cython.double, ux: cython.double, uy: cython.double, radius: cython.double
) -> cython.double:
    """How far along the unit vector u a line through the origin leaves the circle around p."""
    off: cython.double = px * uy - py * ux
    return px * ux + py * uy + sqrt(max(radius * radius - off * off, 0.0))


def circle_exits(
    loop: cython.double[:, :],
    arc: cython.double[::1],
    positions: cython.double[::1],
    centres: cython.double[:, ::1],
    radius: cython.double[::1],
) -> NDArray[np.float64]:
    """Arc length (m,) at which the loop, followed from `positions` (m,), first leaves the circle around it.

    The circles have their `centres` (m, 2) there, and a `radius` (m,). A disc is convex: the first edge that leaves it
    is the first whose end lies outside. NaN where the loop never does.
    """
    step: cython.Py_ssize_t
    place: cython.Py_ssize_t
    count: cython.Py_ssize_t = loop.shape[0]
    perimeter: cython.double = arc[count]
    found = np.empty(positions.shape[0])
    exits: cython.double[::1] = found
    for place in range(positions.shape[0]):
        exits[place] = NAN
        first: cython.Py_ssize_t = 0
        while first <= count and arc[first] <= positions[place]:
            first += 1
        for step in range(count):
            end: cython.Py_ssize_t = (first + step) % count
            dx: cython.double = loop[end, 0] - centres[place, 0]
            dy: cython.double = loop[end, 1] - centres[place, 1]
            if _is_beyond(dx, dy, radius[place]):
                start: cython.Py_ssize_t = end - 1 if end > 0 else count - 1
                length: cython.double = arc[start + 1] - arc[start]
                px: cython.double = centres[place, 0] - loop[start, 0]
                py: cython.double = centres[place, 1] - loop[start, 1]
                ux: cython.double = (loop[end, 0] - loop[start, 0]) / length
                uy: cython.double = (loop[end, 1] - loop[start, 1]) / length
                ahead: cython.double = arc[start] + _leaves(px, py, ux, uy, radius[place]) - positions[place]
                ahead = fmod(ahead, perimeter)
                exits[place] = positions[place] + (ahead if ahead >= 0 else ahead + perimeter)
                break
    return found
