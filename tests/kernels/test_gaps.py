"""Skins of an object beside its holes: compiled, as written, and by a plain twin."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import gaps
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999), apart=st.sampled_from([0.01, 0.05, 2.0]))
def test_they_are_those_of_the_definition(seed: int, apart: float) -> None:
    rng = np.random.default_rng(seed)
    places, points = rng.uniform(0, 1, (5, 2)), rng.uniform(0, 1, (40, 2))
    heights = rng.uniform(0, 0.5, (40, 2))[:, 0] * rng.integers(0, 2, 40)
    found = gaps.two_skins(places, points, heights, 0.3, apart)
    assert np.array_equal(found, interpreted("gaps").two_skins(places, points, heights, 0.3, apart))
    for place, skins in zip(places, found, strict=True):
        near = np.sort(heights[np.linalg.norm(points - place, axis=1) <= 0.3])
        assert skins == (np.diff(near).max(initial=0.0) > apart)


def test_there_is_no_skin_where_there_is_no_point() -> None:
    assert not gaps.two_skins(np.zeros((1, 2)), np.ones((1, 2)), np.ones(1), 0.1, 0.1).any()
