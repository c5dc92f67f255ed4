"""Grasps that differ: compiled and as written."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import variety
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999), most=st.integers(0, 12))
def test_compiled_and_as_written_they_are_the_same(seed: int, most: int) -> None:
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0, np.pi, 30)
    arguments = (rng.uniform(-0.02, 0.02, (30, 2)), np.column_stack([np.cos(turn), np.sin(turn)]), rng.permutation(30))
    found = variety.differing(*arguments, 0.01, 0.2, most)
    assert np.array_equal(found, interpreted("variety").differing(*arguments, 0.01, 0.2, most))
    assert len(found) <= most
