"""Profiles of walls: compiled and as written. What they should find, tests/surroundings asks for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import walls
from tests.kernels.interpreted import interpreted
from tests.kernels.test_below import GRID, heights

INWARD, ALONG = np.array([0.001, 0.004, 0.009, 0.02]), np.array([-0.3, 0.0, 0.3])


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_find_the_same(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("walls")
    turn = rng.uniform(0, 2 * np.pi, 5)
    inward = np.column_stack([np.cos(turn), np.sin(turn)])
    chords = np.column_stack([rng.uniform(-0.06, 0.06, (5, 2)), 0.02 * inward[:, ::-1] * [1, -1], inward])
    surface = heights(rng)
    maps = (surface, surface + rng.uniform(0, 0.02, surface.shape), GRID)
    mean = walls.profile(chords, INWARD, ALONG, *maps)
    assert np.array_equal(mean, twin.profile(chords, INWARD, ALONG, *maps), equal_nan=True)
    figures, profiles, means = walls.faces(chords, INWARD, ALONG, *maps, 0.02, 2)
    others = twin.faces(chords, INWARD, ALONG, *maps, 0.02, 2)
    assert np.array_equal(figures, others[0])
    assert np.array_equal(profiles, others[1])
    assert np.array_equal(means, others[2], equal_nan=True)
    assert np.array_equal(means, mean, equal_nan=True)
    pairs, tip = np.array([[0, 1, 2], [3, 4, 1]]), rng.uniform(0, 0.05, 3)
    grips = (pairs, tip, tip + rng.uniform(-0.01, 0.05, 3), 3, 0.001)
    leans = walls.leans(profiles, INWARD, *grips)
    assert np.array_equal(leans, twin.leans(profiles, INWARD, *grips))
    assert (np.diff(leans, axis=1) >= 0).all()
