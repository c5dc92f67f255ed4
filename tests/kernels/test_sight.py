"""Rays through places: compiled, as written, and where they end worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.frames import frame_on_plane
from flatgrasp_cli.kernels import sight
from tests.kernels.interpreted import interpreted

PIXELS, CELLS = np.array([-0.5, -0.5, 0.1]), np.array([-1.0, -1.0, 0.2])
EYE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
GROUND = np.vstack([np.zeros(3), np.eye(3)])


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_are_the_same(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("sight")
    eye = np.vstack([rng.normal(size=3), frame_on_plane(*tilted(rng)).axes])
    ground = np.vstack([0.1 * rng.normal(size=3), frame_on_plane(*tilted(rng)).axes])
    ranges, levels = rng.uniform(0.5, 3.0, (10, 10)), np.zeros((10, 10))
    ranges[rng.random((10, 10)) < 0.4], levels[rng.random((10, 10)) < 0.5] = np.inf, -np.inf
    places = rng.uniform(-1, 1, (3, 30))
    asked = (places, eye, PIXELS, ranges, ground, CELLS, levels, np.array([0.01, 0.02]))
    assert np.array_equal(sight.hidden(*asked), twin.hidden(*asked))


def tilted(rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """A plane through the origin."""
    normal = rng.normal(size=3)
    return normal / np.linalg.norm(normal), 0.0


def test_from_a_metre_above_a_floor_of_which_one_half_was_seen() -> None:
    """What is met at 0.6 m hides what is farther; elsewhere places are seen that rays pass on to the floor's x > 0."""
    ranges, levels = np.full((10, 10), np.inf), np.zeros((10, 10))
    ranges[4:6, 4:6], levels[:5] = 0.6, -np.inf
    places = np.array([[0.0, 0.0, 0.3], [0.0, 0.0, 0.5], [0.2, 0.2, 0.2], [-0.2, 0.2, 0.2], [0.3, 0.0, 1.2]]).T
    found = sight.hidden(places, EYE, PIXELS, ranges, GROUND, CELLS, levels, np.array([0.01, 0.0]))
    assert found.tolist() == [True, False, False, True, True]


@given(seed=st.integers(0, 999))
def test_something_goes_on_as_far_as_most_places_beyond_a_chord_are_hidden(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("sight")
    ranges, levels, lowest = rng.uniform(0.5, 1.1, (10, 10)), np.zeros((10, 10)), rng.uniform(0, 0.2, (10, 10))
    rays = (EYE, PIXELS, ranges, GROUND, CELLS, levels, np.array([0.0, 0.02]))
    chords, out, along = rng.uniform(-0.2, 0.2, (8, 6)), 0.05 * np.arange(6.0), np.array([-0.3, 0.0, 0.4])
    found = sight.going_on(chords, out, along, np.full(len(chords), 0.1), lowest, PIXELS, *rays)
    assert np.array_equal(found, twin.going_on(chords, out, along, np.full(len(chords), 0.1), lowest, PIXELS, *rays))
    tops = rng.uniform(0, 0.5, len(chords))
    free = sight.free_below(chords, 0.1, along, tops, 0.06, *rays)
    assert np.array_equal(free, twin.free_below(chords, 0.1, along, tops, 0.06, *rays))
    for row, (cx, cy, ax, ay, ux, uy) in enumerate(chords):
        x, y, z = np.broadcast_arrays(
            cx + along * ax + 0.1 * ux, cy + along * ay + 0.1 * uy, np.arange(0, 0.5, 0.06)[:, None]
        )
        hides = sight.hidden(np.stack([x.ravel(), y.ravel(), z.ravel() + 0.03]), *rays).reshape(x.shape)
        steps = np.logical_and.accumulate((2 * hides.sum(axis=1) < 3) & (z[:, 0] < tops[row])).sum()
        assert free[row] == pytest.approx(0.06 * steps)
        x, y = cx + along * ax - out[:, None] * ux, cy + along * ay - out[:, None] * uy
        cell = np.clip([(x + 0.5) / 0.1, (y + 0.5) / 0.1], 0, 9).astype(np.intp)
        hides = sight.hidden(np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.1)]), *rays).reshape(x.shape)
        may = 2 * np.count_nonzero(hides & (lowest[cell[0], cell[1]] <= 0.1), axis=1) > 3
        assert found[row] == np.logical_and.accumulate(may).sum()
