"""Points sorted into cells: compiled and as written. What they should find, tests/scene/test_cells.py asks for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.frames import frame_on_plane
from flatgrasp_cli.kernels import sorting
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_find_the_same(seed: int) -> None:
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=3)
    frame = frame_on_plane(normal / np.linalg.norm(normal), 0.1)
    planes = np.column_stack([frame.axes, frame.axes @ frame.origin])
    points, grid = rng.uniform(-0.3, 0.3, (50, 3)), np.array([-0.2, -0.25, 0.1])
    floor = rng.choice([-0.2, 0.0, np.inf], 24)
    found = []
    for kernel in (sorting, interpreted("sorting")):
        cell, shape = np.empty(50, dtype=np.int32), np.array([4, 6])
        count, total = kernel.into_cells(points, planes, grid, shape, np.array([-0.1, 0.02]), cell)
        rows, heights = kernel.standing(points, cell, floor, planes[2].copy(), 0.02)
        found.append(np.concatenate([cell, count.ravel(), total.ravel(), rows, heights]))
        height = np.minimum(points @ normal / np.linalg.norm(normal) - 0.1, 0.02)
        assert rows.tolist() == np.flatnonzero(height > floor[cell]).tolist()
        assert np.allclose(heights, height[rows], atol=1e-12)
        assert count.sum() == np.count_nonzero(cell)
        assert not count[[0, -1]].any()
        assert not count[:, [0, -1]].any()
    assert np.array_equal(found[0], found[1])


@given(seed=st.integers(0, 999))
def test_the_highest_is_seen_from_above(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cell, heights, names = rng.integers(0, 6, 30), rng.integers(0, 9, 30).astype(np.float64), rng.integers(0, 4, 30)
    found = []
    for kernel in (sorting, interpreted("sorting")):
        owner, highest = np.full(8, -1), np.full(8, -np.inf)
        kernel.from_above(cell, heights, names, owner, highest)
        found.append(np.stack([owner, highest]))
    assert np.array_equal(found[0], found[1])
    order = np.argsort(heights, kind="stable")  # the highest is written last
    owner[cell[order]], highest[cell[order]] = names[order], heights[order]
    assert np.array_equal(found[0], np.stack([owner, highest]))


@given(low=st.floats(-1, 1), size=st.floats(0.001, 0.1))
def test_places_on_the_edge_of_the_rim_are_not_in_it(low: float, size: float) -> None:
    """However they are rounded: they are in the raster or not, but no cell of the rim holds any."""
    edges = np.array([low + size, low + 5 * size])
    points, planes = np.column_stack([edges, edges, np.ones(2)]), np.eye(3, 4)
    cell, shape = np.empty(2, dtype=np.int32), np.array([6, 6])
    count, _ = sorting.into_cells(points, planes, np.array([low, low, size]), shape, np.array([0.0, 2.0]), cell)
    assert count.sum() == count[1:-1, 1:-1].sum() == np.count_nonzero(cell)
