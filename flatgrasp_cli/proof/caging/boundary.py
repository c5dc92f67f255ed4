"""The outline that fingers slide along: its edges, and what straight moves beside it meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.polygon import cross, dot

TANGENT = 1e-9
"""Sine below which a direction counts as along an edge."""
PARALLEL = 1e-200
"""Lines that slant by less never meet, in a number that a double holds."""
MAX_CELLS = 20_000
"""Moves × edges worked on at once: as much as stays in a processor's cache."""


@dataclass(frozen=True, slots=True, eq=False)
class Boundary:
    """Edges of all loops of a region, n in number, the region to their left.

    Edge k leads from `start[k]` to `start[follow[k]]` (n, 2) by `edge[k]`; `back` undoes `follow`; `normal` (n, 2) are
    the unit normals out of the region. Vertex k is the start of edge k.
    """

    start: FloatArray
    follow: IntArray
    back: IntArray
    edge: FloatArray
    normal: FloatArray

    @classmethod
    def of(cls, loops: Sequence[FloatArray]) -> Boundary:
        """The boundary of `loops` (n_l, 2): the outer one counter-clockwise, holes clockwise, nothing repeated."""
        firsts = np.cumsum([0, *(len(loop) for loop in loops)])
        ranges = [np.arange(a, b) for a, b in pairwise(firsts)]
        follow = np.concatenate([np.roll(each, -1) for each in ranges])
        back = np.concatenate([np.roll(each, 1) for each in ranges])
        start = np.concatenate(loops)
        edge = start[follow] - start
        normal = np.column_stack([edge[:, 1], -edge[:, 0]]) / np.linalg.norm(edge, axis=1, keepdims=True)
        return cls(start, follow, back, edge, normal)

    def __len__(self) -> int:
        """Number of edges."""
        return len(self.start)

    @property
    def size(self) -> float:
        """The longer side of the box around it."""
        return float(np.ptp(self.start, axis=0).max())

    @property
    def convex(self) -> BoolArray:
        """Whether the region's angle at each vertex (n,) is below 180°."""
        return np.asarray(cross(self.edge[self.back], self.edge) > 0)

    def feet(self) -> tuple[FloatArray, FloatArray]:
        """Distance (n, n) from vertex a to edge k, and where on that edge the nearest point lies, 0 to 1."""
        squared = dot(self.edge, self.edge)
        where = self.start @ self.edge.T - dot(self.start, self.edge)
        where = np.clip(where / squared, 0.0, 1.0)
        x = self.start[:, :1] - self.start[:, 0] - where * self.edge[:, 0]
        y = self.start[:, 1:] - self.start[:, 1] - where * self.edge[:, 1]
        return np.sqrt(x * x + y * y), where

    def opens(self, vertex: IntArray, direction: FloatArray) -> BoolArray:
        """Whether a move from each vertex (m,) along the unit `direction` (m, 2) starts out of the region."""
        out = [dot(self.normal[k], direction) > TANGENT for k in (vertex, self.back[vertex])]
        return np.asarray(np.where(self.convex[vertex], out[0] | out[1], out[0] & out[1]))

    def first_hits(self, origin: FloatArray, direction: FloatArray, skip: IntArray) -> tuple[FloatArray, IntArray]:
        """How far (m,) points `origin` (m, 2) move along unit `direction` (m, 2) until an edge, and that edge (m,).

        Infinity where nothing is met. The edges `skip` (m, s) do not count: those that the points lie on. A move that
        touches a vertex and no more passes or stops there; both are right, for it can do both.
        """
        distance, edge = np.empty(len(origin)), np.empty(len(origin), dtype=np.intp)
        size = max(1, MAX_CELLS // len(self))
        for first in range(0, len(origin), size):
            part = slice(first, first + size)
            ahead, crosses = self._crossings(origin[part], direction[part])
            ahead[~crosses | (ahead <= 0)] = np.inf
            np.put_along_axis(ahead, skip[part], np.inf, axis=1)
            edge[part] = ahead.argmin(axis=1)
            distance[part] = np.take_along_axis(ahead, edge[part, None], axis=1)[:, 0]
        return distance, edge

    def _crossings(self, origin: FloatArray, direction: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Where (m, n) the lines through `origin` along unit `direction` (m, 2) meet the edges' lines, and if in them.

        An edge is met when exactly one end lies strictly left of the line, so that a vertex on it counts once.
        """
        (ox, oy), (ux, uy) = origin.T[:, :, None], direction.T[:, :, None]
        (ax, ay), (ex, ey) = self.start.T, self.edge.T
        left = ux * ay - uy * ax > ux * oy - uy * ox
        crosses = left != left[:, self.follow]
        slant = ux * ey - uy * ex
        return ((ax - ox) * ey - (ay - oy) * ex) / np.where(np.abs(slant) < PARALLEL, 1.0, slant), crosses

    def grips(self, points: FloatArray, outward: bool = False) -> tuple[IntArray, FloatArray, FloatArray]:
        """Edges that two fingers first meet when they move straight toward each other, or `outward` apart.

        Of placements `points` (m, 2, 2): the edges (m, 2), −1 for a finger that meets none; the fingers' distance
        (m, 2) along the line from the first point to where they meet them; and how deep (m, 2) each finger stands in
        the region along that line, 0 when it is free. One that stands in it counts as withdrawn to the boundary that
        it would have met.
        """
        apart = points[:, 1] - points[:, 0]
        sigma = np.linalg.norm(apart, axis=1)
        direction = apart / np.where(sigma > 0, sigma, 1.0)[:, None]
        where, crosses = self._crossings(points[:, 0], direction)
        entering = direction @ self.normal.T < 0
        first = _met(where, crosses, entering if not outward else ~entering, forward=not outward)
        second = _met(sigma[:, None] - where, crosses, ~entering if not outward else entering, forward=not outward)
        edges = np.stack([first[0], second[0]], axis=1)
        at = np.stack([first[1], sigma - second[1]], axis=1)
        if not outward:  # nothing stands between the two
            edges[(at[:, 0] > at[:, 1]) | (edges < 0).any(axis=1)] = -1
        return edges, at, np.stack([first[2], second[2]], axis=1)


def _met(
    where: FloatArray, crosses: BoolArray, facing: BoolArray, *, forward: bool
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Edge (m,), place (m,) and depth (m,) at which movers at 0, going to +∞ or to −∞, meet a `facing` (m, n) edge."""
    ahead = where if forward else -where
    inside = (crosses & (ahead > 0)).sum(axis=1) % 2 == 1
    facing = crosses & facing
    behind = np.where(facing & (ahead <= 0), -ahead, np.inf)
    before = np.where(facing & (ahead > 0), ahead, np.inf)
    distance = np.where(inside[:, None], behind, before)
    edge = distance.argmin(axis=1)
    least = np.take_along_axis(distance, edge[:, None], axis=1)[:, 0]
    signed = np.where(inside, -least, least)
    place = signed if forward else -signed
    return np.where(np.isfinite(least), edge, -1), place, np.where(inside & np.isfinite(least), least, 0.0)
