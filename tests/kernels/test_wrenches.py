"""Hulls of wrenches: compiled and as written. What they should find, tests/proof asks for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from flatgrasp_cli.kernels import wrenches
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999), away=st.sampled_from([0.0, 0.5, 3.0]))
def test_compiled_and_as_written_they_find_the_same_and_qhull_too(seed: int, away: float) -> None:
    sets = np.random.default_rng(seed).normal(size=(4, 6, 3)) + away
    found = wrenches.nearest_facets(sets)
    assert np.array_equal(found, interpreted("wrenches").nearest_facets(sets))
    hulls = [-ConvexHull(each).equations[:, 3].max() for each in sets]
    assert found == pytest.approx(np.maximum(hulls, 0.0), abs=1e-9)


def test_wrenches_in_one_plane_have_no_inside() -> None:
    flat = np.array([[[1.0, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0], [0.2, 0.1, 0]]])
    assert wrenches.nearest_facets(flat).tolist() == [0.0]
