"""The limits of the opening within which placements of two fingers are caged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.proof.caging.boundary import Boundary
from flatgrasp_cli.proof.caging.contact_space import Caging


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """Of m placements (m,), all openings are finger distances σ in metres.

    `opening` is the placement's own, of fingers withdrawn to the outline where they stand in it. The fingers stay with
    the object on this side of `escape` (below for closing fingers, above for opening ones) and in this grasp's basin on
    this side of `merge`; going on, they end at `bottom` or where a dent stops them. `caged` is whether they are at
    their own opening, `meets` whether either finger meets anything at all.
    """

    opening: FloatArray
    escape: FloatArray
    merge: FloatArray
    bottom: FloatArray
    meets: BoolArray
    caged: BoolArray


def limits(caging: Caging, points: FloatArray) -> Limits:
    """The limits of the openings for fingers at `points` (m, 2, 2)."""
    outward = caging.stretching
    sign = -1.0 if outward else 1.0
    edges, at, depth = caging.boundary.grips(points, outward=outward)
    meets = np.asarray((edges >= 0).all(axis=1))
    sigma = np.linalg.norm(points[:, 1] - points[:, 0], axis=1)
    withdrawn = np.where(meets & (depth > 0).any(axis=1), _withdrawn(at, sigma, depth), sigma)
    node = _rising_corners(caging.boundary, points, edges, at) if outward else edges
    basin = caging.basins.of_node[node[:, 0], node[:, 1]]
    birth = caging.land.birth[node[:, 0], node[:, 1]]
    levels = caging.levels
    escape, merge = (np.where(meets, np.maximum(each[basin], birth), -np.inf) for each in (levels.escape, levels.merge))
    return Limits(
        opening=withdrawn,
        escape=sign * escape,
        merge=sign * merge,
        bottom=np.where(meets, sign * caging.basins.lowest[levels.deepest[basin]], np.nan),
        meets=meets,
        caged=sign * withdrawn < escape,
    )


def _withdrawn(at: FloatArray, sigma: FloatArray, depth: FloatArray) -> FloatArray:
    """Distance (m,) of the fingers when those inside go back to the boundary that they would have met."""
    first = np.where(depth[:, 0] > 0, at[:, 0], 0.0)
    second = np.where(depth[:, 1] > 0, at[:, 1], sigma)
    return np.asarray(np.where(np.isfinite(first) & np.isfinite(second), second - first, sigma))


def _rising_corners(boundary: Boundary, points: FloatArray, edges: IntArray, at: FloatArray) -> IntArray:
    """Vertices (m, 2) that fingers at the ends of their ways apart reach along `edges` (m, 2) without coming closer."""
    apart = points[:, 1] - points[:, 0]
    sigma = np.linalg.norm(apart, axis=1, keepdims=True)
    direction = apart / np.where(sigma > 0, sigma, 1.0)
    at = np.where(edges >= 0, at, 0.0)
    first, second = (points[:, 0] + at[:, k : k + 1] * direction for k in (0, 1))
    p = _rising_end(boundary, edges[:, 0], first, second)
    q = _rising_end(boundary, edges[:, 1], second, boundary.start[p])
    return np.stack([p, q], axis=1)


def _rising_end(boundary: Boundary, edge: IntArray, here: FloatArray, other: FloatArray) -> IntArray:
    """The end (m,) of each edge toward which the distance from `here` on it to `other` (m, 2) grows all the way."""
    grows = ((here - other) * boundary.edge[edge]).sum(axis=1) > 0  # at `here`; a convex function then grows on
    return np.where(grows, boundary.follow[edge], edge)
