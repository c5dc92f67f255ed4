"""What may be a corner of the convex hull: compiled, as written, and by the hull itself."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from flatgrasp_cli.kernels import rim
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999), count=st.integers(3, 60))
def test_no_corner_of_the_hull_is_left_out(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 2)) * rng.uniform(0.1, 3, 2)
    found = rim.on_rim(points)
    assert np.array_equal(found, interpreted("rim").on_rim(points))
    assert set(ConvexHull(points).vertices.tolist()) <= set(found.tolist())


def test_most_points_of_a_square_are() -> None:
    assert len(rim.on_rim(np.random.default_rng(0).uniform(0, 1, (5000, 2)))) < 300


@pytest.mark.parametrize("points", [[[1.0, 2.0]] * 3, [[0.0, 0.0], [1.0, 1.0], [0.5, 0.5]], [[0.0, 0.0], [0.0, 2.0]]])
def test_points_in_line_or_in_one_place_stay(points: list[list[float]]) -> None:
    assert rim.on_rim(np.array(points)).tolist() == list(range(len(points)))


@given(seed=st.integers(0, 999), share=st.sampled_from([0.0, 0.1, 0.5]))
def test_ends_of_a_masks_rows(seed: int, share: float) -> None:
    mask = np.random.default_rng(seed).random((9, 7)) < share
    found = rim.ends(mask.view(np.uint8))
    assert np.array_equal(found, interpreted("rim").ends(mask.view(np.uint8)))
    marked = [(row, *np.flatnonzero(cells)[[0, -1]]) for row, cells in enumerate(mask) if cells.any()]
    assert found.T.tolist() == [list(map(int, each)) for each in marked]
