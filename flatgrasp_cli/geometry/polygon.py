"""Closed polygon loops: arrays (n, 2) of distinct vertices in serial order, the last joined to the first.

Regions are tuples of loops: the outer one counter-clockwise, inner ones (holes) clockwise, so that the region always
lies to the left of the walk.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray, true_entries

END_SHARE = 1e-4


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Cross product's z component of plane vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar product of plane vectors (..., 2); several times faster than a sum over so short an axis."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])


def distance_to_segment(points: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """Distance (m,) of each of `points` to its segment `starts`→`ends`, all (m, 2)."""
    along = ends - starts
    squared = dot(along, along)
    where = np.clip(dot(points - starts, along) / np.where(squared > 0, squared, 1.0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - starts - where[:, None] * along, axis=1))


def in_frames(points: FloatArray, origins: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """X and y (e, p) of points (e, 2) in p frames at `origins` (p, 2) whose y axes are the unit vectors `along`."""
    across = left_normal(along)
    return points @ across.T - dot(origins, across), points @ along.T - dot(origins, along)


def left_normal(directions: FloatArray) -> FloatArray:
    """Unit normals (n, 2) to the left of `directions` (n, 2)."""
    x, y = directions.T
    length = np.hypot(x, y)
    return np.stack([-y / length, x / length], axis=1)


def signed_area(loop: FloatArray) -> float:
    """Shoelace area, positive when the loop runs counter-clockwise."""
    return 0.5 * float(cross(loop, following(loop)).sum())


def edges(loops: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Start and end points (n, 2) of all edges of all loops."""
    return np.concatenate(loops), np.concatenate([following(loop) for loop in loops])


def following(loop: FloatArray) -> FloatArray:
    """The vertex (n, 2) after each: numpy's roll takes several times as long."""
    return np.concatenate([loop[1:], loop[:1]])


def arc_positions(loop: FloatArray) -> FloatArray:
    """Arc length (n + 1,) at each vertex, the last entry being the perimeter."""
    x, y = (following(loop) - loop).T
    arc = np.zeros(len(loop) + 1)
    np.cumsum(np.hypot(x, y), out=arc[1:])
    return arc


def points_at(loop: FloatArray, positions: FloatArray) -> FloatArray:
    """Points (..., 2) of the loop at arc lengths `positions` (...), taken modulo the perimeter."""
    arc = arc_positions(loop)
    x, y = np.concatenate([loop, loop[:1]]).T
    where = np.mod(positions, arc[-1])
    points = np.empty((*np.shape(positions), 2))
    points[..., 0], points[..., 1] = np.interp(where, arc, x), np.interp(where, arc, y)
    return points


def area_centroid(loops: Sequence[FloatArray]) -> FloatArray:
    """Centre of area (2,) of the region."""
    start, end = edges(loops)
    origin = start.mean(axis=0)  # keeps the products small far from the frame's origin
    start, end = start - origin, end - origin
    twice_area = cross(start, end)
    centroid: FloatArray = origin + ((start + end) * twice_area[:, None]).sum(axis=0) / (3 * twice_area.sum())
    return centroid


def contains(loops: Sequence[FloatArray], points: FloatArray) -> BoolArray:
    """Which `points` (m, 2) lie in the region: even-odd crossing number with the half-open rule.

    An edge counts for a horizontal ray when exactly one end lies above it, so a ray through a vertex counts once
    (Haines, "Point in Polygon Strategies", Graphics Gems IV, 1994).
    """
    start, end = edges(loops)
    (ax, ay), (bx, by), (x, y) = _columns(start), _columns(end), points.T  # (n, 1) against (m,)
    edge, point = true_entries((ay > y) != (by > y))  # few of all: what follows runs over those alone
    ax, ay, bx, by, x, y = ax[edge, 0], ay[edge, 0], bx[edge, 0], by[edge, 0], x[point], y[point]
    right = x < ax + (bx - ax) / (by - ay) * (y - ay)
    return np.asarray(np.bincount(point[right], minlength=len(points)) % 2 == 1)


def share_inside(loops: Sequence[FloatArray], starts: FloatArray, ends: FloatArray) -> FloatArray:
    """Share (m,) of each segment `starts`→`ends` (m, 2) that lies in the region, 0 to 1.

    Summing the segment's parameter over its crossings, + where it leaves the region and − where it enters, measures the
    length inside; a segment that ends inside adds 1. One pass over edges, no sorting. Segments are shortened by a
    ten-thousandth at each end, for contacts lie on the boundary itself.
    """
    along = (1 - 2 * END_SHARE) * (ends - starts)
    starts = starts + END_SHARE * (ends - starts)
    a, b = edges(loops)
    (ax, ay), (ex, ey) = _columns(a), _columns(b - a)  # (n, 1) against (m,)
    (sx, sy), (lx, ly) = starts.T, along.T
    fx, fy = ax - sx, ay - sy
    side = lx * fy - ly * fx  # of each edge's start, and below of its end, against the segment's line
    determinant = lx * ey - ly * ex
    edge, segment = true_entries((side > 0) != (side + determinant > 0))  # few of all
    leaves = determinant[edge, segment]  # the region lies left of the edge: + leaves it
    t = (fx[edge, segment] * ey[edge, 0] - fy[edge, segment] * ex[edge, 0]) / leaves
    signed = np.where((t > 0) & (t < 1), np.copysign(t, leaves), 0.0)
    inside = np.bincount(segment, weights=signed, minlength=len(starts)) + contains(loops, starts + along)
    return np.asarray(np.clip(inside, 0.0, 1.0))


def _columns(points: FloatArray) -> FloatArray:
    """X and y of `points` (n, 2) as columns, (2, n, 1), to be held against rows."""
    return np.ascontiguousarray(points.T)[:, :, None]


def circle_exits(loop: FloatArray, positions: FloatArray, radius: FloatArray | float) -> FloatArray:
    """Arc length (m,) at which the loop, followed from each of `positions` (m,), first leaves the circle around it.

    `radius` is that of all circles, or of each (m,).

    The paper's eq. (1), d₁ₙ ≤ r ≤ d₁ₙ₊₁, solved exactly on the edge (n, n+1) with the smallest serial number ahead: a
    disc is convex, so the first edge that leaves it is the first whose end lies outside. Answers lie ahead of
    `positions` by at most one perimeter and are not reduced modulo it; NaN where the loop never leaves the circle.
    """
    arc, n = arc_positions(loop), len(loop)
    centres = points_at(loop, positions)
    dx, dy = loop.T[:, None] - _columns(centres)  # (m, n)
    outside = dx * dx + dy * dy > np.square(radius).reshape(-1, 1)
    ahead = outside & (np.arange(n) >= np.searchsorted(arc, positions, side="right")[:, None])
    end = np.where(ahead.any(axis=1), ahead.argmax(axis=1), outside.argmax(axis=1))  # in this round or the next
    start = (end - 1) % n
    unit = (loop[end] - loop[start]) / (arc[start + 1] - arc[start])[:, None]
    to_centre = centres - loop[start]
    along = dot(to_centre, unit) + np.sqrt(np.maximum(radius**2 - cross(to_centre, unit) ** 2, 0.0))
    exits = positions + np.mod(arc[start] + along - positions, arc[-1])
    return np.where(outside.any(axis=1), exits, np.nan)


def chord_walk(loop: FloatArray, radius: float) -> FloatArray:
    """Arc lengths (s,) of points met by stepping `radius` in a straight line from vertex 0 once around the loop.

    Each step is an exit as in `circle_exits`, but the next starts where it ends: numbers one by one, so no numpy.
    """
    vertices: list[tuple[float, float]] = [(x, y) for x, y in [*loop.tolist(), loop[0].tolist()]]
    arc: list[float] = arc_positions(loop).tolist()
    positions = [0.0]
    centre = vertices[0]
    for (ax, ay), (bx, by), begin, end in zip(vertices, vertices[1:], arc, arc[1:], strict=False):
        ux, uy = (bx - ax) / (end - begin), (by - ay) / (end - begin)
        while math.hypot(bx - centre[0], by - centre[1]) > radius:
            px, py = centre[0] - ax, centre[1] - ay
            off = px * uy - py * ux
            along = px * ux + py * uy + math.sqrt(max(radius * radius - off * off, 0.0))
            positions.append(begin + along)
            centre = (ax + along * ux, ay + along * uy)
    return np.array(positions)


def ray_parity_inside(loop: FloatArray, point: FloatArray, far_points: FloatArray) -> bool:
    """Whether most segments from `point` (2,) to `far_points` (m, 2) outside cross the loop an odd number of times.

    The paper's §III.A.3.3 asks all rays to be odd; one that grazes a vertex then flips the answer, so the majority
    decides.
    """
    a, b = edges([loop])
    ray, edge = far_points - point, b - a
    side_a, side_b = cross(ray[:, None], a - point), cross(ray[:, None], b - point)
    side_point, side_far = cross(edge, point - a), cross(edge, far_points[:, None] - a)
    crossings = ((side_a > 0) != (side_b > 0)) & ((side_point > 0) != (side_far > 0))
    return bool(np.count_nonzero(crossings.sum(axis=1) % 2 == 1) * 2 > len(far_points))


def vertices_between(loop: FloatArray, starts: FloatArray, ends: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs (row, vertex) of the loop's vertices strictly between arc lengths `starts` and `ends` (m,), cyclic."""
    arc = arc_positions(loop)
    ahead = np.mod(arc[:-1] - starts[:, None], arc[-1])
    row, vertex = np.nonzero((ahead > 0) & (ahead < (ends - starts)[:, None]))
    return row, vertex
