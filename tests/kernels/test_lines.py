"""Lines through values: compiled, as written, and numpy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import lines
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999), count=st.integers(1, 8))
def test_they_are_those_with_the_least_squares(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    x, values = np.sort(rng.uniform(0, 1, count)), rng.normal(size=(5, count))
    values[rng.random(values.shape) < 0.2] = rng.choice([np.nan, -np.inf])
    found = lines.fitted(x, values)
    assert np.array_equal(found, interpreted("lines").fitted(x, values))
    for row, (at_0, slope) in zip(values, found.T, strict=True):
        known = np.isfinite(row)
        if np.count_nonzero(known) > 1:
            assert (slope, at_0) == pytest.approx(tuple(np.polyfit(x[known], row[known], 1)), rel=1e-3, abs=1e-6)
        else:
            assert (slope, at_0) == (0.0, row[known].sum())
