"""A surface in the sensor's image: compiled and as written. What they should find, tests/scene asks for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import flood, view
from tests.kernels.interpreted import interpreted

JUMP = 0.05


def image(seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """X, y and depth (3, 12, 10) of a rough surface with holes and a step in it; nothing is known at its rim."""
    rng = np.random.default_rng(seed)
    y, x = (0.01 * (np.mgrid[:12, :10] + rng.uniform(-0.3, 0.3, (2, 12, 10)))).tolist()
    depth = rng.uniform(0.8, 0.84, (12, 10))
    depth[:, 6:] += 0.1
    depth[rng.random(depth.shape) < 0.1] = np.inf
    depth[[0, 1, -2, -1]] = depth[:, [0, -1]] = np.inf
    x, y = (np.where(np.isfinite(depth), values, np.inf) for values in (x, y))
    return x, y, depth


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_are_the_same(seed: int) -> None:
    twin, (x, y, depth) = interpreted("view"), image(seed)
    for step in ((1, 0), (0, -2), (1, 1)):
        with np.errstate(invalid="ignore"):
            assert np.array_equal(view.smooth_to(depth, *step, JUMP), twin.smooth_to(depth, *step, JUMP))
    with np.errstate(invalid="ignore"):
        normals = view.normals(x, y, depth, JUMP, 3.0)
        assert np.array_equal(normals, twin.normals(x, y, depth, JUMP, 3.0))
        far = np.where(np.isfinite(depth), depth, 0.0)
        places = np.stack([np.where(np.isfinite(x), x, 0.0) * far, np.where(np.isfinite(y), y, 0.0) * far, far])
        bends = (places, normals, normals.any(axis=0).view(np.uint8), depth, JUMP, 2)
        assert np.array_equal(view.sharpest_bends(*bends), twin.sharpest_bends(*bends))


@given(seed=st.integers(0, 999))
def test_a_cell_shows_the_mean_of_its_nearest_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    values, cell = rng.uniform(0, 0.2, (3, 40)), rng.integers(0, 7, 40)
    found = view.nearest_means(values, cell, 9, JUMP)
    assert np.array_equal(found, interpreted("view").nearest_means(values, cell, 9, JUMP))
    for name in range(9):
        own = values[:, cell == name]
        front = own[:, own[0] < own[0].min(initial=np.inf) + JUMP]
        assert np.allclose(found[:, name], front.mean(axis=1) if front.size else np.inf)


@given(seed=st.integers(0, 999))
def test_names_spread_alike(seed: int) -> None:
    rng = np.random.default_rng(seed)
    known = np.zeros((8, 9), dtype=np.bool_)
    known[1:-1, 1:-1] = rng.random((6, 7)) < 0.8
    names = np.where(known & (rng.random(known.shape) < 0.3), rng.integers(1, 4, known.shape), 0).ravel()
    waiting, steps = np.flatnonzero(known.ravel() & (names == 0)), np.array([9, 1, -9, -1])
    smooth = (rng.random((4, 72)) < 0.8).view(np.uint8)
    places, normals = rng.normal(size=(2, 3, 72))
    arguments = (names, waiting, steps, smooth, places, normals)
    found = flood.flooded(*arguments)
    assert np.array_equal(found, interpreted("flood").flooded(*arguments))
    assert np.array_equal(found[names > 0], names[names > 0])


@given(seed=st.integers(0, 999))
def test_pieces_that_hold_something(seed: int) -> None:
    rng = np.random.default_rng(seed)
    names, core = rng.integers(0, 5, (6, 7), dtype=np.int32), rng.random((6, 7)) < 0.05
    found = flood.holding(names, core.view(np.uint8), 5)
    assert np.array_equal(found, np.isin(names, names[core]))
    assert np.array_equal(found, interpreted("flood").holding(names, core.view(np.uint8), 5))


@given(seed=st.integers(0, 999))
def test_values_of_the_nearest(seed: int) -> None:
    rng = np.random.default_rng(seed)
    values, numbers = rng.uniform(0, 1, (4, 5)), 1 + rng.permutation(20).astype(np.int32).reshape(4, 5)
    empty = rng.random((4, 5)) < 0.5
    empty[0, 0] = False
    nearest = np.where(empty, rng.choice(numbers[~empty], (4, 5)), numbers)
    found = flood.from_nearest(values, nearest, empty.view(np.uint8))
    assert np.array_equal(found, interpreted("flood").from_nearest(values, nearest, empty.view(np.uint8)))
    assert np.array_equal(found, values.ravel()[np.argsort(numbers.ravel())[nearest - 1]])
