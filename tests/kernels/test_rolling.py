"""What a disc touches: compiled, as written, and pixel by pixel."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.polygon import cross
from flatgrasp_cli.kernels import rolling
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999))
def test_of_a_pixels_points_the_nearest_is_touched(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, label = rng.integers(0, 4, (30, 2)).astype(np.float64), rng.integers(0, 6, 30).astype(np.int32)
    touched, path = rng.integers(0, 6, 5).astype(np.int32), rng.integers(0, 4, (5, 2)).astype(np.float64)
    found = rolling.outermost(points, label, touched, path, 6)
    assert np.array_equal(found, interpreted("rolling").outermost(points, label, touched, path, 6))
    for name in set(touched.tolist()) & set(label.tolist()):
        center = path[np.flatnonzero(touched == name)[-1]]
        own = np.flatnonzero(label == name)
        away = np.linalg.norm(points[own] - center, axis=1)
        assert found[name] == own[away == away.min()][-1]


@given(seed=st.integers(0, 999))
def test_points_mark_the_pixels_that_they_lie_in(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, origin = rng.uniform(0.2, 0.9, (20, 2)), np.array([0.2, 0.1])
    empty, again = np.ones((2, 12, 11), dtype=np.uint8)
    found = rolling.marked(points, origin, 0.1, empty)
    assert np.array_equal(found, interpreted("rolling").marked(points, origin, 0.1, again))
    column, row = ((points - origin) / 0.1 + 1).astype(np.intp).T
    assert np.array_equal(found, 11 * row + column)
    assert np.array_equal(empty, again)
    assert set(np.flatnonzero(empty == 0).tolist()) == set(found.tolist())


@given(seed=st.integers(0, 999), count=st.integers(0, 12))
def test_notches_go_unless_the_one_before_them_does(seed: int, count: int) -> None:
    ring = np.random.default_rng(seed).integers(0, 4, (count, 2)).astype(np.float64)
    found = rolling.without_notches(ring, 2.0)
    assert np.array_equal(found, interpreted("rolling").without_notches(ring, 2.0))
    before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
    notch = (cross(ring - before, after - ring) < 0) & (np.linalg.norm(after - before, axis=1) <= 2.0)
    notch[1:] &= ~notch[:-1]
    assert np.array_equal(found, ring[~notch])
