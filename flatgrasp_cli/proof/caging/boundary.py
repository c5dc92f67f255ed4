"""The outline that fingers slide along: its edges, and what straight moves beside it meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.polygon import cross, dot
from flatgrasp_cli.kernels.rays import first_hits, met

TANGENT = 1e-9
"""Sine below which a direction counts as along an edge."""


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
        return first_hits(self.start, self.edge, self.follow, np.column_stack([origin, direction]), skip)

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
        lines, way = np.column_stack([points[:, 0], direction]), -1.0 if outward else 1.0
        outline = self.start, self.edge, self.follow, lines
        one, other = met(*outline, np.zeros(len(lines)), way, -way), met(*outline, sigma, -way, way)
        edges, (at, depth) = np.stack([one[0], other[0]], axis=1), np.stack([one[1], other[1]], axis=2)
        if not outward:  # nothing stands between the two
            edges[(at[:, 0] > at[:, 1]) | (edges < 0).any(axis=1)] = -1
        return edges, at, depth
