"""Look-ups in a raster: compiled and as written; places outside are on the rim."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.frames import Frame, axes_about
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
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
    within = rng.uniform(-1, 1, (2, 9))
    assert np.array_equal(looking_up.box(*within), [within.min(axis=1), within.max(axis=1)])
    assert np.array_equal(looking_up.box(*within), twin.box(*within))
    levels = rng.uniform(-1, 2, 30)
    means = looking_up.averages(x, y, levels, raster.origin, raster.cell_m, *raster.shape, -np.inf)
    assert np.array_equal(means, twin.averages(x, y, levels, raster.origin, raster.cell_m, *raster.shape, -np.inf))
    assert np.array_equal(means, raster.mean(cells, levels, -np.inf))
    for name, extreme in (("raised", np.maximum), ("lowered", np.minimum)):
        found, again, plain = values.copy(), values.copy(), values.copy()
        getattr(looking_up, name)(found, x, y, levels, raster.origin, raster.cell_m)
        getattr(twin, name)(again, x, y, levels, raster.origin, raster.cell_m)
        extreme.at(plain.reshape(-1), cells, levels)
        assert np.array_equal(found, again)
        assert np.array_equal(found, plain)


@given(seed=st.integers(0, 999))
def test_empty_cells_take_what_their_axes_meet_of_the_floor(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("looking_up")
    raster, other = Raster(np.array([-0.5, -0.3]), 0.1, (9, 7)), Raster(np.array([-0.8, -0.7]), 0.2, (8, 9))
    tilt = np.array([*rng.uniform(-0.3, 0.3, 2), 1.0])
    frame = Frame(rng.uniform(-0.1, 0.1, 3), axes_about(tilt / np.linalg.norm(tilt)))
    level = Frame(np.zeros(3), np.eye(3))
    heights = np.where(rng.random(raster.shape) < 0.5, UNSEEN, rng.uniform(0, 1, raster.shape))
    floor = HeightMap(other, rng.uniform(0, 0.1, other.shape))
    found = HeightMap(raster, heights).filled(floor, frame, level).heights
    again = heights.copy()
    corner = level.to_local(frame.origin) + (raster.origin + 0.05) @ frame.axes[:2]
    twin.floored(again, corner, frame.axes, 0.1, floor.heights, floor.grid)
    assert np.array_equal(found, raster.rimmed(again, UNSEEN))
    for row, column in np.argwhere(heights[1:-1, 1:-1] == UNSEEN) + 1:
        foot = frame.to_world(np.append(raster.origin + 0.1 * (np.array([row, column]) + 0.5), 0.0))
        met = foot - foot[2] / frame.axes[2, 2] * frame.axes[2]
        above = floor.over(met[:1], met[1:2])[0]
        assert np.isclose(found[row, column], (above - foot[2]) / frame.axes[2, 2], rtol=0, atol=1e-12)
