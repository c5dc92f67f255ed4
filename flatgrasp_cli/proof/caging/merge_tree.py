"""Basins of a landscape over pairs of boundary parts, and the levels at which flooding joins them.

The landscape is a grid of nodes (i, j), n × n, wrapped around by `follow` on both axes. The two fingers are alike, so
(i, j) and (j, i) are one node. Flooding up to a level joins two nodes by a link of at most that level; no link lies
lower than its nodes. `ESCAPE` stands for the way out.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.kernels import merge_tree as kernels

ESCAPE = -1
Links = tuple[IntArray, IntArray, FloatArray]
"""Two nodes or basins (m,) each, and the levels (m,) at which they join."""


@dataclass(frozen=True, slots=True, eq=False)
class Landscape:
    """Heights of the nodes, `birth` (n, n), symmetric, and of the links (i, j)–(follow[i], j), `step` (n, n)."""

    birth: FloatArray
    step: FloatArray
    follow: IntArray
    back: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Basins:
    """Which basin each node belongs to, (n, n), and the links between the b basins, each of its two once."""

    of_node: IntArray
    lowest: FloatArray
    links: Links


@dataclass(frozen=True, slots=True, eq=False)
class MergeLevels:
    """For each of b basins (b,): the level at which it joins `ESCAPE`, and what happens to it before.

    `merge` is the level at which it first joins `ESCAPE` or a basin that is told apart from it, and `deepest` the basin
    with the lowest point of all that it has joined up to there, itself if it is no mere dent. Infinite where it never
    does.
    """

    escape: FloatArray
    merge: FloatArray
    deepest: IntArray


def basins(land: Landscape) -> Basins:
    """Every node belongs to where it drains to: over the lowest of its links, as long as that is no higher than itself.

    What is left out this way are links that flooding has joined already when it reaches them.
    """
    birth, step = np.ascontiguousarray(land.birth), np.ascontiguousarray(land.step)
    of_node, count = kernels.drained(birth, step, land.follow, land.back)
    bottom = np.full(count, np.inf)
    np.minimum.at(bottom, of_node.ravel(), birth.ravel())
    (a, b), level = kernels.borders(of_node, step, land.follow)
    return Basins(of_node, bottom, _lowest(a, b, level, count))


def _lowest(a: IntArray, b: IntArray, level: FloatArray, count: int) -> Links:
    """Of many links the lowest between each two different ones of `count` basins, in ascending order."""
    differ = a != b
    a, b, level = a[differ], b[differ], level[differ]
    order = np.argsort(level)
    key = np.minimum(a, b)[order] * np.intp(count) + np.maximum(a, b)[order]
    first = np.sort(np.unique(key, return_index=True)[1])
    return key[first] // count, key[first] % count, level[order][first]


def merge_levels(lowest: FloatArray, links: Iterable[Links], told_apart: float) -> MergeLevels:
    """Flood the basins, the deepest points `lowest` (b,) of which are given, over all links (Kruskal's algorithm).

    Two basins count as different when both are deeper than `told_apart` where they meet; a shallower one is a dent in
    its neighbour's floor.
    """
    a, b, level = (np.concatenate(column) for column in zip(*links, strict=True))
    count = len(lowest) + 1  # ESCAPE is the last
    a, b, level = _lowest(a % count, b % count, level, count)
    (escape, merge), deepest = kernels.risen(lowest, np.stack([a, b]), level, told_apart)
    return MergeLevels(escape, merge, deepest)
