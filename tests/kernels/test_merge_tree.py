"""Basins and rising water: compiled, as written, and basins by scipy's parts of a graph."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.kernels import merge_tree
from tests.kernels.interpreted import interpreted


def landscape(seed: int) -> tuple[FloatArray, FloatArray, IntArray, IntArray]:
    """A landscape of two loops; many heights are the same."""
    rng = np.random.default_rng(seed)
    sizes = rng.integers(1, 6, 2)
    follow = np.concatenate([np.roll(np.arange(sizes[0]), -1), sizes[0] + np.roll(np.arange(sizes[1]), -1)])
    step = rng.integers(2, 9, (len(follow), len(follow))).astype(np.float64)
    birth = np.minimum(step, rng.integers(1, 9, step.shape))
    return np.minimum(birth, birth.T), step, follow, np.argsort(follow)


@given(seed=st.integers(0, 999))
def test_basins_are_the_parts_of_a_graph(seed: int) -> None:
    birth, step, follow, back = landscape(seed)
    i, j = np.triu_indices(len(birth))
    node = np.empty(birth.shape, dtype=np.intp)
    node[i, j] = node[j, i] = np.arange(len(i))
    ways = np.stack([node[follow[i], j], node[i, follow[j]], node[back[i], j], node[i, back[j]]])
    levels = np.stack([step[i, j], step[j, i], step[back[i], j], step[back[j], i]])
    here, lowest = np.arange(len(i)), levels.argmin(axis=0)
    out = np.where(levels[lowest, here] <= birth[i, j], ways[lowest, here], here)
    graph = csr_matrix((np.ones(len(i)), out, np.arange(len(i) + 1)), shape=(len(i), len(i)))
    count, parts = connected_components(graph, directed=False)
    names, found = merge_tree.drained(birth, step, follow, back)
    assert found == count
    assert np.array_equal(names, parts[node])


@given(seed=st.integers(0, 999), told_apart=st.sampled_from([0.0, 1.0, 3.0]))
def test_compiled_and_as_written_they_are_the_same(seed: int, told_apart: float) -> None:
    twin, (birth, step, follow, back) = interpreted("merge_tree"), landscape(seed)
    names, count = merge_tree.drained(birth, step, follow, back)
    again, twin_count = twin.drained(birth, step, follow, back)
    assert np.array_equal(names, again)
    assert count == twin_count
    links, levels = merge_tree.borders(names, step, follow)
    twin_links, twin_levels = twin.borders(names, step, follow)
    assert np.array_equal(links, twin_links)
    assert np.array_equal(levels, twin_levels)
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, names.ravel(), birth.ravel())
    out = np.array([[names[0, 0]], [count]])  # one basin has a way out
    order = np.argsort(np.append(levels, 5.0), kind="stable")
    rising = np.ascontiguousarray(np.hstack([links, out])[:, order]), np.append(levels, 5.0)[order]
    found, bottom = merge_tree.risen(lowest, *rising, told_apart)
    twin_found, twin_bottom = twin.risen(lowest, *rising, told_apart)
    assert np.array_equal(found, twin_found)
    assert np.array_equal(bottom, twin_bottom)
    assert (found[1] <= found[0]).all()  # what escapes has met the way out
