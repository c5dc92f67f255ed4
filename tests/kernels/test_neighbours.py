"""Neighbours in the plane: compiled, as written, and by all distances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import neighbours
from tests.kernels.interpreted import interpreted


@given(
    seed=st.integers(0, 999), count=st.integers(1, 7), shape=st.sampled_from([(1, 1), (1, 0), (0, 1), (0, 0), (9, 0.1)])
)
def test_they_are_the_nearest(seed: int, count: int, shape: tuple[float, float]) -> None:
    rng = np.random.default_rng(seed)
    points = (rng.uniform(0, 1, (40, 2)) * shape).round(2)
    chosen = rng.permutation(40)[:8]
    found = neighbours.squared_reach(points, chosen, count)
    twin = interpreted("neighbours").squared_reach(points, chosen, count)  # in double precision
    assert np.sqrt(found) == pytest.approx(np.sqrt(twin), abs=1e-5)
    apart = np.linalg.norm(points[chosen, None] - points, axis=2)
    assert np.sqrt(found) == pytest.approx(np.sort(apart, axis=1)[:, count - 1], abs=1e-6)
