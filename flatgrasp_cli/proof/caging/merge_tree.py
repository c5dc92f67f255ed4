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
    n = len(land.birth)
    i, j = np.triu_indices(n)
    node = np.empty((n, n), dtype=np.intp)
    node[i, j] = node[j, i] = np.arange(len(i))
    follow, back, step, birth = land.follow, land.back, land.step, land.birth[i, j]
    neighbours = np.stack([node[follow[i], j], node[i, follow[j]], node[back[i], j], node[i, back[j]]])
    levels = np.stack([step[i, j], step[j, i], step[back[i], j], step[back[j], i]])
    lowest = levels.argmin(axis=0)
    here = np.arange(len(i))
    drains = levels[lowest, here] <= birth
    ways = np.where(drains, neighbours[lowest, here], here)  # one out of each node
    label = _components(ways)
    count = int(label.max()) + 1
    bottom = np.full(count, np.inf)
    np.minimum.at(bottom, label, birth)
    ends = np.broadcast_to(label, (2, len(label)))
    return Basins(label[node], bottom, _lowest(label[neighbours[:2]], ends, levels[:2], count))


def _components(ways: IntArray) -> IntArray:
    """Numbers (k,) from 0, in order of appearance, of the connected parts of a graph with one way out of each node.

    Each node leads into one cycle, whose least node names the part. scipy.sparse.csgraph does the same, but importing
    it takes longer than planning a grasp.
    """
    ahead, least = ways, np.arange(len(ways))
    for _ in range(len(ways).bit_length()):  # twice as far each time: to the cycle, and around it
        least = np.minimum(least, least[ahead])
        ahead = ahead[ahead]
    _, first, label = np.unique(least[ahead], return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[label]


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
    flood = _Flood(lowest, told_apart)
    for x, y, at in zip(a.tolist(), b.tolist(), level.tolist(), strict=True):
        flood.join(x, y, at)
    flood.end()
    return MergeLevels(np.array(flood.escape), np.array(flood.merge), np.array(flood.ends_in))


class _Flood:
    """Pools that rise and join; numbers one by one, so lists instead of arrays."""

    def __init__(self, lowest: FloatArray, told_apart: float) -> None:
        count = len(lowest)
        self.told_apart = told_apart
        self.parent = list(range(count + 1))
        self.low = [*lowest.tolist(), -np.inf]
        self.dry = [[k] for k in range(count)] + [[]]  # those of a pool that have not escaped
        self.open = [[k] for k in range(count)] + [[]]  # those that have not met another basin
        self.escape, self.merge = [np.inf] * count, [np.inf] * count
        self.deepest = list(range(count + 1))  # of a pool
        self.ends_in = list(range(count))

    def join(self, a: int, b: int, level: float) -> None:
        """Let the pools of basins `a` and `b` become one at `level`, unless they are."""
        x, y = self._root(a), self._root(b)
        if x == y:
            return
        out = self._root(len(self.parent) - 1)
        if y == out or (x != out and len(self.dry[x]) < len(self.dry[y])):
            x, y = y, x  # x swallows y
        if x == out:
            for k in self.dry[y]:
                self.escape[k] = level
            self.dry[y] = []
            self._settle(y, level)
        else:
            mixed = not (self.open[x] and self.open[y])  # one holds several basins already
            if mixed or level - max(self.low[x], self.low[y]) > self.told_apart:
                self._settle(x, level)
                self._settle(y, level)
        self.parent[y] = x
        if self.low[y] < self.low[x]:
            self.low[x], self.deepest[x] = self.low[y], self.deepest[y]
        self.dry[x] += self.dry[y]
        self.open[x] += self.open[y]

    def end(self) -> None:
        """What has met nothing to the end ends in the deepest of its whole pool."""
        for pool, open_basins in enumerate(self.open):
            if open_basins and self._root(pool) == pool:
                self._settle(pool, np.inf)

    def _settle(self, pool: int, level: float) -> None:
        for k in self.open[pool]:
            self.merge[k], self.ends_in[k] = level, self.deepest[pool]
        self.open[pool] = []

    def _root(self, k: int) -> int:
        parent = self.parent
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k
