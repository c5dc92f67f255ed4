"""How far boundaries stray from chords: compiled and as written. What they should find, tests/planner asks for."""

from __future__ import annotations

import numpy as np
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
    arcs = polygon.points_at(loop, begins[:, None] + along * (ends - begins)[:, None])
    assert np.array_equal(chords.strays(arcs), twin.strays(arcs))
