"""Look-ups in a raster: compiled and as written; places outside are on the rim."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.kernels import looking_up
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_find_the_same(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("looking_up")
    raster, values = Raster(np.array([-0.5, -0.3]), 0.1, (9, 7)), rng.uniform(0, 1, (9, 7))
    x, y = rng.uniform(-1, 1, (2, 30))
    x[:3], y[3:6] = [np.inf, -np.inf, 0.0], [np.inf, -np.inf, 0.0]
    where = (x, y, raster.origin, raster.cell_m)
    cells = looking_up.cells(*where, *raster.shape)
    assert np.array_equal(cells, twin.cells(*where, *raster.shape))
    assert np.array_equal(looking_up.over(values, *where), twin.over(values, *where))
    row = np.clip((x - raster.origin[0]) / raster.cell_m, 0, 8).astype(np.intp)
    column = np.clip((y - raster.origin[1]) / raster.cell_m, 0, 6).astype(np.intp)
    assert np.array_equal(cells, 7 * row + column)
    assert np.array_equal(looking_up.over(values, *where), values[row, column])
    levels = rng.uniform(-1, 2, 30)
    count, total = np.bincount(cells, minlength=63), np.bincount(cells, weights=levels, minlength=63)
    for kernel in (looking_up, twin):
        means = values.copy()
        kernel.averaged(x, y, levels, raster.origin, raster.cell_m, means)
        plain = np.where(count > 0, total / np.maximum(count, 1), values.ravel())
        assert np.array_equal(means.ravel(), plain)
    for name, extreme in (("raised", np.maximum), ("lowered", np.minimum)):
        found, again, plain = values.copy(), values.copy(), values.copy()
        getattr(looking_up, name)(found, x, y, levels, raster.origin, raster.cell_m)
        getattr(twin, name)(again, x, y, levels, raster.origin, raster.cell_m)
        extreme.at(plain.reshape(-1), cells, levels)
        assert np.array_equal(found, again)
        assert np.array_equal(found, plain)


@given(seed=st.integers(0, 999))
def test_what_was_not_seen_is_filled_with_the_ground(seed: int) -> None:
    rng = np.random.default_rng(seed)
    heights, ground = rng.choice([-np.inf, 1.0], (5, 4)), rng.uniform(0, 1, (9, 7))
    corner, along = rng.uniform(-0.2, 0.2, 3), np.eye(3) + rng.uniform(-0.3, 0.3, (3, 3))
    origin, found = np.array([-0.5, -0.3]), []
    for kernel in (looking_up, interpreted("looking_up")):
        found.append(heights.copy())
        kernel.filled(found[-1], 0.05, corner, along, ground, origin, 0.1)
    assert np.array_equal(found[0], found[1])
    for row, column in np.ndindex(5, 4):
        x, y, over = corner + 0.05 * (row * along[0] + column * along[1])
        way = -over / along[2, 2]
        met_x, met_y = (np.array([x, y]) + way * along[2, :2])[:, None]
        met = looking_up.over(ground, met_x, met_y, origin, 0.1)[0]
        expected = heights[row, column] if np.isfinite(heights[row, column]) else way + met / along[2, 2]
        assert found[0][row, column] == pytest.approx(expected)
