"""What pads touch: compiled and as written. What they should find, tests/planner asks for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import contacts
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999), fingers=st.sampled_from([(0.0,), (-0.02, 0.02)]))
def test_compiled_and_as_written_they_are_the_same(seed: int, fingers: tuple[float, ...]) -> None:
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0, 2 * np.pi, 5)
    hands = np.column_stack([rng.uniform(-0.03, 0.03, (5, 2)), np.cos(turn), np.sin(turn)])
    arcs, candidates = rng.uniform(-0.03, 0.03, (4, 9, 2)), rng.integers(0, 4, 5)
    arguments = (hands, arcs, candidates, np.array(fingers), 0.01, 0.002)
    found = contacts.touched_aside(*arguments)
    assert np.array_equal(found, interpreted("contacts").touched_aside(*arguments))
    assert (np.abs(found) < 0.1).all()
