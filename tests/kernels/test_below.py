"""Look-ups below hands: compiled and as written. What they should find, tests/surroundings asks for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import below, palm
from tests.kernels.interpreted import interpreted

GRID = np.array([-0.05, -0.04, 0.005])
FINGERS = np.array([[0, -0.005], [0, 0.0], [0, 0.005], [1, -0.02], [1, 0.02]])


def heights(rng: np.random.Generator) -> FloatArray:
    """A map with holes in it."""
    found = rng.uniform(0, 0.1, (20, 16))
    found[rng.random(found.shape) < 0.3] = -np.inf
    return found


def hands(rng: np.random.Generator, count: int = 4) -> FloatArray:
    """Some that reach beyond the map."""
    turn = rng.uniform(0, 2 * np.pi, count)
    axes = np.column_stack([np.cos(turn), np.sin(turn)])
    return np.column_stack([rng.uniform(-0.06, 0.06, (count, 2)), axes, rng.uniform(0, 0.05, count)])


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_find_the_same(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("below")
    where, rest, highest = hands(rng), heights(rng), heights(rng)
    reach = rng.integers(0, 8, (3, 4))
    fingers = (where, FINGERS, reach, 2, rest, highest, GRID)
    assert np.array_equal(below.under_fingers(*fingers), twin.under_fingers(*fingers))
    tips = (where, FINGERS, np.array([0.002, 0.006]), rest, GRID)
    assert np.array_equal(below.under_tips(*tips), twin.under_tips(*tips))


@given(seed=st.integers(0, 999))
def test_the_highest_below_a_palm_is_found_square_by_square(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("palm")
    where, highest = hands(rng), heights(rng)
    tops = palm.tops(highest)
    assert np.array_equal(tops, twin.tops(highest))
    asked = (GRID, 0.05, 0.03, rng.uniform(0, 0.05, (2, 4)))
    found = palm.under_palm(where, highest, tops, *asked)
    assert np.array_equal(found, twin.under_palm(where, highest, tops, *asked))
    assert np.array_equal(found, plain_palm(where, highest, *asked))


def plain_palm(
    hands: FloatArray, heights: FloatArray, grid: FloatArray, least: float, across: float, along: FloatArray
) -> FloatArray:
    """The highest of all cells below each palm."""
    x, y = (grid[axis] + grid[2] * (np.arange(heights.shape[axis]) + 0.5) for axis in (0, 1))
    found = np.full(along.shape, -np.inf)
    for hand, (cx, cy, ux, uy, _) in enumerate(hands):
        dx, dy = x[:, None] - cx, y - cy
        beside = (np.abs(dy * ux - dx * uy) <= across) & (heights > least)
        for row, reach in enumerate(along[:, hand]):
            found[row, hand] = heights[beside & (np.abs(dx * ux + dy * uy) <= reach)].max(initial=-np.inf)
    return found


def test_a_place_on_the_edge_of_two_cells_is_in_the_farther_one() -> None:
    chart = np.full((4, 4), -np.inf)
    chart[2, 2] = 0.1
    at = np.array([[0.5, 0.5, 1.0, 0.0, 0.0]])
    fingers, grid = np.array([[0, 0.0], [1, 0.0]]), np.array([0.0, 0.0, 0.25])
    found = below.under_tips(at, fingers, np.zeros(1), chart, grid)
    assert found[:, 0].tolist() == [0.1, 0.0]
