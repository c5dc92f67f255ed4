"""Sides out of sight: compiled, as written, and neighbours by all distances."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import flanks
from tests.kernels.interpreted import interpreted

INWARD = np.arange(0.5, 12) * 0.003


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_go_on_alike(seed: int) -> None:
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.01, 0.05, 8)
    gone = np.clip(1 - INWARD[:, None] / radius, 0, 1)
    heights = radius * (1 + np.sqrt(1 - (0.8 * gone) ** 2)) + rng.normal(0, 0.0003, (12, 8))
    heights[rng.random(heights.shape) < 0.2] = np.nan
    slope = rng.uniform(-0.5, 3.0, 8)
    arguments = (INWARD, heights, slope, 0.012, 1e-8)
    found = flanks.going_on(*arguments)
    assert np.array_equal(found, interpreted("flanks").going_on(*arguments))
    assert not found[slope <= 0].any()


@given(seed=st.integers(0, 999))
def test_the_most_nearby_is_that_of_the_definition(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0, 2 * np.pi, 12)
    extent, contact, width = rng.uniform(0, 0.05, 12), rng.uniform(0, 0.05, (12, 2)), rng.uniform(0.01, 0.03, 12)
    direction = np.column_stack([np.cos(turn), np.sin(turn)])
    found = flanks.most_nearby(extent, contact, direction, width)
    assert np.array_equal(found, interpreted("flanks").most_nearby(extent, contact, direction, width))
    near = np.linalg.norm(contact[:, None] - contact, axis=2) <= width[:, None]
    alike = direction @ direction.T > 0
    assert np.array_equal(found, np.where(near & alike, extent, 0.0).max(axis=1))
