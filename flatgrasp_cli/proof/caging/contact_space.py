"""Contact space of two point fingers on a boundary: how far they must open to get from one grasp to another.

Two fingers that close on an object are caught unless they can get away without opening further. Moving both straight
toward each other takes any placement to one on the boundary, so it is enough to know the pairs of boundary points:
contact space, cut into rectangles, edge i × edge j. On a rectangle the distance σ of the two points is convex, so the
part of it below a level is connected, and joins the neighbouring rectangle's where the lowest σ on their common side
does: at the distance from a vertex to an edge. All levels are therefore exact.

Where a finger may leave the boundary straight toward the other one and land elsewhere, contact space lacks a way that
the plane has. Such tunnels are needed from its local minima only.

The method is that of Allen, Burdick & Rimon, "Two-finger caging of polygonal objects using contact space search"
(T-RO 2015); they search it from one grasp on, here one flood answers for all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray, true_entries
from flatgrasp_cli.proof.caging.boundary import Boundary
from flatgrasp_cli.proof.caging.merge_tree import (
    ESCAPE,
    Basins,
    Landscape,
    Links,
    MergeLevels,
    basins,
    merge_levels,
)

SAME = 1e-12
"""Levels that differ by less, as a share of the outline's size, are equal but for rounding."""
STOP = 1e-9
"""A finger this close to the other one, as a share of their distance, has met it."""


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """m placements: finger p at `vertex` (m,), q on `edge` (m,) at the share `where` (m,) of its length."""

    vertex: IntArray
    edge: IntArray
    where: FloatArray

    def points(self, boundary: Boundary) -> FloatArray:
        """Both fingers (m, 2, 2)."""
        q = boundary.start[self.edge] + self.where[:, None] * boundary.edge[self.edge]
        return np.stack([boundary.start[self.vertex], q], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Caging:
    """Escape and merge levels of every pair of a boundary's edges (squeezing) or vertices (stretching).

    For stretching all levels are −σ: what is a lower limit of the opening is an upper limit of that. `minima` are
    placements at the bottom of basins with a bottom above 0, or −∞; of those on parallel edges both ends.
    """

    boundary: Boundary
    land: Landscape
    basins: Basins
    levels: MergeLevels
    minima: Contacts
    stretching: bool


def squeezing(boundary: Boundary, told_apart: float) -> Caging:
    """Caging by fingers that close: escape is where both fingers meet."""
    distance, where = boundary.feet()
    follow, back = boundary.follow, boundary.back
    birth = np.minimum(distance, distance[follow])
    birth = np.minimum(birth, birth.T)
    np.fill_diagonal(birth, 0.0)
    land = Landscape(birth, distance[follow], follow, back)
    found = basins(land)
    coincide = np.unique(found.of_node.diagonal())
    ends = (coincide, np.full(len(coincide), ESCAPE), np.zeros(len(coincide)))
    of_side = found.of_node  # of vertex a and edge j: that of edges a and j, for they hold that placement
    floor = found.lowest[of_side]
    tolerance = SAME * boundary.size
    vertex, edge = true_entries((distance <= floor + tolerance) & (floor > tolerance))
    minima = Contacts(vertex, edge, where[vertex, edge])
    tunnels = _closing_tunnels(boundary, minima, distance[vertex, edge], of_side)
    levels = merge_levels(found.lowest, [found.links, ends, tunnels], max(told_apart, tolerance))
    return Caging(boundary=boundary, land=land, basins=found, levels=levels, minima=minima, stretching=False)


def _closing_tunnels(boundary: Boundary, minima: Contacts, sigma: FloatArray, basin: IntArray) -> Links:
    """Ways of either finger straight toward the other one, off the boundary to the next edge or to that finger."""
    vertex, edge = minima.vertex, minima.edge
    p, q = np.moveaxis(minima.points(boundary), 1, 0)
    toward = np.asarray((q - p) / sigma[:, None])
    here = basin[vertex, edge]
    start_of_p = boundary.opens(vertex, toward)
    # q lies on its edge or, at either end of it, on a vertex
    corner = np.where(minima.where >= 1.0, boundary.follow[edge], edge)
    at_corner = (minima.where <= 0.0) | (minima.where >= 1.0)
    rises = -(boundary.normal[edge] * toward).sum(axis=1) > 1e-9
    start_of_q = np.where(at_corner, boundary.opens(corner, -toward), rises)
    p_skips = np.column_stack([vertex, boundary.back[vertex]])
    q_skips = np.where(at_corner[:, None], np.column_stack([corner, boundary.back[corner]]), edge[:, None])
    parts = []
    for starts, origin, direction, skip, other in (
        (start_of_p, p, toward, p_skips, edge),
        (start_of_q, q, -toward, q_skips, vertex),
    ):
        way, hit = boundary.first_hits(origin[starts], direction[starts], skip[starts])
        meet = way >= (1 - STOP) * sigma[starts]
        parts.append((here[starts], np.where(meet, ESCAPE, basin[hit, other[starts]]), sigma[starts]))
    a, b, level = (np.concatenate(column) for column in zip(*parts, strict=True))
    return a, b, level
