"""Moves beside an outline: compiled, as written, and the first hit by all crossings."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import rays
from flatgrasp_cli.proof.caging.boundary import Boundary
from tests.kernels.interpreted import interpreted
from tests.kernels.test_outline import star


def moves(seed: int) -> tuple[Boundary, FloatArray]:
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0, 2 * np.pi, 6)
    return Boundary.of([star(rng)]), np.column_stack([rng.uniform(-6, 6, (6, 2)), np.cos(turn), np.sin(turn)])


@given(seed=st.integers(0, 999))
def test_the_first_hit_is_the_nearest_crossing(seed: int) -> None:
    outline, lines = moves(seed)
    nothing = np.empty((6, 0), dtype=np.intp)
    found, edge = rays.first_hits(outline.start, outline.edge, outline.follow, lines, nothing)
    for k, (ox, oy, ux, uy) in enumerate(lines):
        slant = ux * outline.edge[:, 1] - uy * outline.edge[:, 0]
        dx, dy = (outline.start - [ox, oy]).T
        ahead = (dx * outline.edge[:, 1] - dy * outline.edge[:, 0]) / slant
        share = (dx * uy - dy * ux) / slant
        hits = (ahead > 0) & (share >= 0) & (share < 1)
        assert found[k] == pytest.approx(ahead[hits].min(initial=np.inf), abs=1e-9)
        assert hits[edge[k]] or not hits.any()


@given(seed=st.integers(0, 999), way=st.sampled_from([-1.0, 1.0]), facing=st.sampled_from([-1.0, 1.0]))
def test_compiled_and_as_written_they_are_the_same(seed: int, way: float, facing: float) -> None:
    outline, lines = moves(seed)
    twin, what = interpreted("rays"), (outline.start, outline.edge, outline.follow, lines)
    skip = np.arange(12).reshape(6, 2)
    for name, more in (("first_hits", (skip,)), ("met", (np.linspace(-1, 1, 6), way, facing))):
        compiled, written = getattr(rays, name)(*what, *more), getattr(twin, name)(*what, *more)
        assert np.array_equal(compiled[0], written[0])
        assert np.array_equal(compiled[1], written[1])
