"""Boundaries under chords: compiled and as written. What they should find, tests/planner asks for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry import polygon
from flatgrasp_cli.kernels import chords
from tests.kernels.interpreted import interpreted
from tests.kernels.test_outline import star


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_are_the_same(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("chords")
    loop = star(rng)
    arc = polygon.arc_positions(loop)
    begins = np.append(rng.uniform(0, arc[-1], 10), arc[:-1])
    ends, along = begins + rng.uniform(0.1, 1.0, len(begins)) * arc[-1], np.linspace(0.0, 1.0, 5)
    found = chords.arcs(loop, arc, begins, ends, along)
    assert np.array_equal(found, twin.arcs(loop, arc, begins, ends, along))
    where = begins[:, None] + along * (ends - begins)[:, None]
    assert found == pytest.approx(polygon.points_at(loop, where), abs=1e-12)
    assert np.array_equal(chords.strays(found), twin.strays(found))
