"""Walking along boundaries: compiled and as written. What they should find, tests/geometry asks for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry import polygon
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import outline
from tests.kernels.interpreted import interpreted


def star(rng: np.random.Generator) -> FloatArray:
    """A loop around the origin; on a grid, so that much lies in a line."""
    angle = np.sort(rng.uniform(0, 2 * np.pi, 20))
    radius = rng.uniform(1, 5, 20)
    corners = np.round(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), 1)
    return np.asarray(corners[np.any(corners != np.roll(corners, 1, axis=0), axis=1)], dtype=np.float64)


@given(seed=st.integers(0, 999), radius=st.floats(0.2, 12.0))
def test_compiled_and_as_written_they_are_the_same(seed: int, radius: float) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("outline")
    loop = star(rng)
    arc, region = polygon.arc_positions(loop), polygon.edges([loop])
    points = np.round(rng.uniform(-5, 5, (12, 2)), 1)
    assert np.array_equal(outline.contains(*region, points), twin.contains(*region, points))
    segments = (*region, points, np.roll(points, 1, axis=0) - points)
    assert np.array_equal(outline.shares_inside(*segments), twin.shares_inside(*segments))
    assert outline.chord_walk(loop, arc, radius) == pytest.approx(twin.chord_walk(loop, arc, radius), rel=1e-12)
    assert arc == pytest.approx(twin.arc_lengths(loop), rel=1e-12)
    positions = np.concatenate([rng.uniform(-arc[-1], 2 * arc[-1], 10), arc])
    places, (x, y) = outline.places(loop, arc, positions), np.concatenate([loop, loop[:1]]).T
    assert np.array_equal(places, twin.places(loop, arc, positions))
    where = np.mod(positions, arc[-1])
    assert places == pytest.approx(np.column_stack([np.interp(where, arc, x), np.interp(where, arc, y)]), abs=1e-12)
    positions = np.append(rng.uniform(0, arc[-1], 10), arc[:-1])
    exits = (loop, arc, positions, polygon.points_at(loop, positions), np.full(len(positions), radius))
    assert outline.circle_exits(*exits) == pytest.approx(twin.circle_exits(*exits), rel=1e-12, nan_ok=True)
