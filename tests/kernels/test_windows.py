"""Means over windows: compiled, as written, and window by window."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import windows
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999), cells=st.sampled_from([1, 3, 5, 21]))
def test_they_are_those_of_each_window(seed: int, cells: int) -> None:
    rng, half = np.random.default_rng(seed), cells // 2
    count = rng.integers(0, 3, (9, 6))
    total = rng.normal(size=count.shape) * count
    found = windows.means(total, count, cells)
    assert np.array_equal(found, interpreted("windows").means(total, count, cells))
    cells_own = windows.of_cells(total, count)
    assert np.array_equal(cells_own, total / np.maximum(count, 1))
    assert np.array_equal(cells_own, interpreted("windows").of_cells(total, count))
    for row, column in np.ndindex(*count.shape):
        window = tuple(slice(max(0, middle - half), middle + half + 1) for middle in (row, column))
        counted = int(count[window].sum())
        assert found[row, column] == pytest.approx(total[window].sum() / counted if counted else 0, abs=1e-12)
