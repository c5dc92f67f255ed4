"""Basins of a landscape over pairs of boundary parts, and pools that rise and join: Kruskal's algorithm."""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
NONE = cython.declare(cython.Py_ssize_t, -1)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _node(i: cython.Py_ssize_t, j: cython.Py_ssize_t, n: cython.Py_ssize_t) -> cython.Py_ssize_t:
    """The flat index of the node (i, j), which is (j, i), too."""
    return min(i, j) * n + max(i, j)


def drained(
    birth: cython.double[:, ::1],
    step: cython.double[:, ::1],
    follow: cython.Py_ssize_t[::1],
    back: cython.Py_ssize_t[::1],
) -> tuple[NDArray[np.intp], int]:
    """The numbers (n, n) of the basins that the nodes of a landscape drain to, in order of appearance; and how many.

    Each node leads over the lowest of its four links, if that is no higher than itself, and at last into a cycle.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    n: cython.Py_ssize_t = birth.shape[0]
    count: cython.Py_ssize_t = 0
    names = np.full((n, n), -1, dtype=np.intp)
    name: cython.Py_ssize_t[::1] = names.reshape(-1)
    way: cython.Py_ssize_t[::1] = np.empty(n * n, dtype=np.intp)
    for i in range(n):
        for j in range(i, n):
            least: cython.double = step[i, j]
            there: cython.Py_ssize_t = _node(follow[i], j, n)
            if step[j, i] < least:
                least, there = step[j, i], _node(i, follow[j], n)
            if step[back[i], j] < least:
                least, there = step[back[i], j], _node(back[i], j, n)
            if step[back[j], i] < least:
                least, there = step[back[j], i], _node(i, back[j], n)
            way[_node(i, j, n)] = there if least <= birth[i, j] else _node(i, j, n)
    for i in range(n):
        for j in range(i, n):
            count += _named(_node(i, j, n), way, name, count)
            name[j * n + i] = name[i * n + j]
    return names, count


@cython.cfunc
def _named(
    node: cython.Py_ssize_t, way: cython.Py_ssize_t[::1], name: cython.Py_ssize_t[::1], new: cython.Py_ssize_t
) -> cython.Py_ssize_t:
    """Name all nodes on the way from one: as what they lead to is named already, or `new`; 1 if it is that."""
    here: cython.Py_ssize_t = node
    while name[here] == NONE:
        name[here] = -2  # on the way
        here = way[here]
    answer: cython.Py_ssize_t = name[here]
    is_new: cython.bint = answer == -2
    if is_new:
        answer = new
    here = node
    while name[here] == -2:
        name[here] = answer
        here = way[here]
    return 1 if is_new else 0


def borders(
    basin: cython.Py_ssize_t[:, ::1], step: cython.double[:, ::1], follow: cython.Py_ssize_t[::1]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """The links between different basins: the two (2, m), and the levels (m,)."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    side: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    n: cython.Py_ssize_t = basin.shape[0]
    ends = np.empty((2, n * (n + 1)), dtype=np.intp)
    levels = np.empty(n * (n + 1))
    end: cython.Py_ssize_t[:, ::1] = ends
    level: cython.double[::1] = levels
    for side in range(2):
        for i in range(n):
            for j in range(i, n):
                there: cython.Py_ssize_t = basin[follow[i], j] if side == 0 else basin[i, follow[j]]
                if there != basin[i, j]:
                    end[0, found], end[1, found] = there, basin[i, j]
                    level[found] = step[i, j] if side == 0 else step[j, i]
                    found += 1
    return ends[:, :found], levels[:found]


def risen(
    lowest: cython.double[::1],
    links: cython.Py_ssize_t[:, ::1],
    levels: cython.double[::1],
    told_apart: cython.double,
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """What becomes of b basins, the deepest points `lowest` (b,) of which are given, as water rises.

    The `links` (2, m) join basins, or one with the way out, called b, at rising `levels` (m,). Answers are the levels
    (2, b) at which a basin joins the way out, and at which it first joins that or another basin that is told apart from
    it: both are deeper than `told_apart` where they meet. And the basin (b,) with the lowest point of all that it has
    joined up to there.
    """
    index: cython.Py_ssize_t
    pool: cython.Py_ssize_t
    count: cython.Py_ssize_t = lowest.shape[0]
    joined = np.full((2, count), math.inf)
    deepest = np.arange(count)
    low: cython.double[::1] = np.append(lowest, -math.inf)
    # of each pool: its parent and its deepest basin; of those in it that have not escaped, and of those that have met
    # no other basin, how many there are, the first and the last; and of each basin the next of both
    trees: cython.Py_ssize_t[:, ::1] = np.tile(np.arange(count + 1), (10, 1))
    for pool in range(count + 1):
        for index in range(2):
            trees[2 + 4 * index, pool] = 1 if pool < count else 0
            trees[5 + 4 * index, pool] = NONE
    for index in range(levels.shape[0]):
        _join(trees, low, links[0, index], links[1, index], levels[index], told_apart, joined, deepest)
    for pool in range(count + 1):
        if trees[0, pool] == pool:
            _settle(trees, 1, pool, INFINITY, joined, deepest)
    return joined, deepest


@cython.cfunc
def _join(
    trees: cython.Py_ssize_t[:, ::1],
    low: cython.double[::1],
    one: cython.Py_ssize_t,
    other: cython.Py_ssize_t,
    level: cython.double,
    told_apart: cython.double,
    joined: cython.double[:, ::1],
    deepest: cython.Py_ssize_t[::1],
) -> cython.void:
    """Let the pools of two basins become one at a level, unless they are."""
    x: cython.Py_ssize_t = _root(trees, one)
    y: cython.Py_ssize_t = _root(trees, other)
    if x == y:
        return
    out: cython.Py_ssize_t = _root(trees, low.shape[0] - 1)
    if y == out or (x != out and trees[2, x] < trees[2, y]):
        x, y = y, x  # x swallows y
    if x == out:
        _settle(trees, 0, y, level, joined, deepest)
        _settle(trees, 1, y, level, joined, deepest)
    else:
        mixed: cython.bint = trees[6, x] == 0 or trees[6, y] == 0  # one holds several basins already
        if mixed or level - max(low[x], low[y]) > told_apart:
            _settle(trees, 1, x, level, joined, deepest)
            _settle(trees, 1, y, level, joined, deepest)
    trees[0, y] = x
    if low[y] < low[x]:
        low[x], trees[1, x] = low[y], trees[1, y]
    _append(trees, 0, x, y)
    _append(trees, 1, x, y)


@cython.cfunc
def _root(trees: cython.Py_ssize_t[:, ::1], pool: cython.Py_ssize_t) -> cython.Py_ssize_t:
    """The pool that a basin is in."""
    while trees[0, pool] != pool:
        trees[0, pool] = trees[0, trees[0, pool]]
        pool = trees[0, pool]
    return pool


@cython.cfunc
def _settle(
    trees: cython.Py_ssize_t[:, ::1],
    what: cython.Py_ssize_t,
    pool: cython.Py_ssize_t,
    level: cython.double,
    joined: cython.double[:, ::1],
    deepest: cython.Py_ssize_t[::1],
) -> cython.void:
    """Note at which level the basins of a pool that have not yet escaped (0), or met another one (1), do so."""
    basin: cython.Py_ssize_t = trees[3 + 4 * what, pool]
    while trees[2 + 4 * what, pool] > 0:
        joined[what, basin] = level
        if what == 1:
            deepest[basin] = trees[1, pool]
        trees[2 + 4 * what, pool] -= 1
        basin = trees[5 + 4 * what, basin]


@cython.cfunc
def _append(
    trees: cython.Py_ssize_t[:, ::1], what: cython.Py_ssize_t, pool: cython.Py_ssize_t, other: cython.Py_ssize_t
) -> cython.void:
    """Add the basins that the `other` pool still holds to those of a pool."""
    first: cython.Py_ssize_t = 2 + 4 * what
    if trees[first, other] == 0:
        return
    if trees[first, pool] == 0:
        trees[first + 1, pool] = trees[first + 1, other]
    else:
        trees[first + 3, trees[first + 2, pool]] = trees[first + 1, other]
    trees[first + 2, pool] = trees[first + 2, other]
    trees[first, pool] += trees[first, other]
