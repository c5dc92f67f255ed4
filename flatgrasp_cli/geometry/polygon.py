"""Closed polygon loops: arrays (n, 2) of distinct vertices in serial order, the last joined to the first.

Regions are tuples of loops: the outer one counter-clockwise, inner ones (holes) clockwise, so that the region always
lies to the left of the walk.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.kernels import outline

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
    length, normals = np.sqrt(x * x + y * y), np.empty((len(x), 2))
    normals[:, 0], normals[:, 1] = -y / length, x / length
    return normals


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
    arc: FloatArray = outline.arc_lengths(loop)
    return arc


def points_at(loop: FloatArray, positions: FloatArray) -> FloatArray:
    """Points (..., 2) of the loop at arc lengths `positions` (...), taken modulo the perimeter."""
    found: FloatArray = outline.places(loop, arc_positions(loop), np.ravel(positions))
    return found.reshape(*np.shape(positions), 2)


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
    return outline.contains(*edges(loops), points)


def share_inside(loops: Sequence[FloatArray], starts: FloatArray, ends: FloatArray) -> FloatArray:
    """Share (m,) of each segment `starts`→`ends` (m, 2) that lies in the region, 0 to 1.

    Segments are shortened by a ten-thousandth at each end, for contacts lie on the boundary itself.
    """
    along = (1 - 2 * END_SHARE) * (ends - starts)
    return outline.shares_inside(*edges(loops), starts + END_SHARE * (ends - starts), along)


def circle_exits(loop: FloatArray, positions: FloatArray, radius: FloatArray | float) -> FloatArray:
    """Arc length (m,) at which the loop, followed from each of `positions` (m,), first leaves the circle around it.

    `radius` is that of all circles, or of each (m,).

    The paper's eq. (1), d₁ₙ ≤ r ≤ d₁ₙ₊₁, solved exactly on the edge (n, n+1) with the smallest serial number ahead: a
    disc is convex, so the first edge that leaves it is the first whose end lies outside. Answers lie ahead of
    `positions` by at most one perimeter and are not reduced modulo it; NaN where the loop never leaves the circle.
    """
    radii = np.full(positions.shape, radius, dtype=np.float64)
    return outline.circle_exits(loop, arc_positions(loop), positions, points_at(loop, positions), radii)


def chord_walk(loop: FloatArray, radius: float) -> FloatArray:
    """Arc lengths (s,) of points met by stepping `radius` in a straight line from vertex 0 once around the loop.

    Each step is an exit as in `circle_exits`, but the next starts where it ends.
    """
    return outline.chord_walk(loop, arc_positions(loop), radius)


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
