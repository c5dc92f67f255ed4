"""Questions about all points of a frame: compiled, as written, and by a plain twin."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import points
from tests.kernels.interpreted import interpreted

ODD = np.array([0.0, -0.0, np.nan, np.inf, -np.inf, 1e4, -1e4, 1.0001e4, 0.3])


def cloud(seed: int) -> FloatArray:
    """Points with some of what no sensor measures."""
    rng = np.random.default_rng(seed)
    found = rng.uniform(-1, 1, (60, 3))
    found[rng.random(found.shape) < 0.1] = rng.choice(ODD)
    return found


@given(seed=st.integers(0, 999))
def test_they_are_those_of_the_definitions(seed: int) -> None:
    some, low, high = cloud(seed), np.array([-0.8, -0.7, -0.6]), np.array([0.9, 0.8, 0.7])
    lost = ~np.isfinite(some).all(axis=1) | (np.abs(some) > 1e4).any(axis=1) | ~some.any(axis=1)
    assert points.not_measured(some, 1e4).tolist() == np.flatnonzero(lost).tolist()
    beyond = ~((some >= low) & (some <= high)).all(axis=1)
    assert points.outside(some, low, high).tolist() == np.flatnonzero(beyond).tolist()
    with np.errstate(invalid="ignore"):
        close = np.linalg.norm(some - high, axis=1) < 0.9
    assert points.near(some, high, 0.9).tolist() == np.flatnonzero(close).tolist()
    filled = np.empty(len(some), dtype=np.bool_)
    for kind in (np.float64, np.float32):
        x, y, z = columns = np.asarray(0.5 * some, dtype=kind).T
        kept = points.measured(x, y, z, 2.0, 1e4, filled.view(np.uint8))
        assert filled.tolist() == (~lost).tolist()
        assert np.array_equal(kept, 2.0 * columns.T[~lost].astype(np.float64))
    inside = ((some > low) & (some < high)).all(axis=1)
    assert points.between(some, low, high).tolist() == np.flatnonzero(inside).tolist()
    good = np.nan_to_num(some, nan=0.1, posinf=0.2, neginf=-0.2)
    assert np.array_equal(points.mean(good), good.mean(axis=0))
    assert np.array_equal(points.bounds(good), [good.min(axis=0), good.max(axis=0)])


@given(seed=st.integers(0, 999))
@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_compiled_and_as_written_they_are_the_same(seed: int) -> None:
    some, twin = cloud(seed), interpreted("points")
    low, high = np.array([-0.8, -0.7, -0.6]), np.array([0.9, 0.8, 0.7])
    assert np.array_equal(points.not_measured(some, 1e4), twin.not_measured(some, 1e4))
    filled, again = np.empty((2, len(some)), dtype=np.uint8)
    x, y, z = some.T
    kept = points.measured(x, y, z, 1.0, 1e4, filled), twin.measured(x, y, z, 1.0, 1e4, again)
    assert np.array_equal(*kept)
    assert np.array_equal(filled, again)
    assert np.array_equal(points.outside(some, low, high), twin.outside(some, low, high))
    assert np.array_equal(points.near(some, low, 0.9), twin.near(some, low, 0.9))
    assert np.array_equal(points.between(some, low, high), twin.between(some, low, high))
    good = np.nan_to_num(some, nan=0.1, posinf=0.2, neginf=-0.2)
    assert np.array_equal(points.mean(good), twin.mean(good))
    assert np.array_equal(points.bounds(good), twin.bounds(good))


def test_nobody_has_to_own_the_points() -> None:
    some = np.asfortranarray(cloud(1))
    some.flags.writeable = False
    assert np.array_equal(points.not_measured(some, 1e4), points.not_measured(some.copy(), 1e4))
