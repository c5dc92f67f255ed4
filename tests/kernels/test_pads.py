"""Extents of boundaries, and swept fingers: compiled and as written. What they should find, tests/planner asks for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.chain import closed_chain
from flatgrasp_cli.kernels import pads
from tests.conftest import I_BEAM, MM
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_are_the_same(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("pads")
    points, breaks = closed_chain([np.array(I_BEAM.exterior.coords)[:-1] * MM])
    turn = rng.uniform(0, 2 * np.pi, 6) * rng.integers(0, 2, 6)
    hands = np.column_stack([rng.uniform(-0.03, 0.03, (6, 2)), -np.sin(turn), np.cos(turn)])
    edges, fingers = np.delete(np.arange(len(points) - 1), breaks), np.array([[0, 0], [1, -0.02], [1, 0.02]])
    arguments = (points, edges, hands, fingers, 0.005, rng.uniform(0, 0.06, (2, 6)))
    assert np.array_equal(pads.swept(*arguments), twin.swept(*arguments))
    middle, axis = np.ascontiguousarray(hands[:, :2]), np.ascontiguousarray(hands[:, 2:])
    reach = (middle, axis, rng.uniform(-0.05, 0.05, (9, 5, 2)), rng.integers(0, 9, (2, 6)))
    assert np.array_equal(pads.extents(*reach), twin.extents(*reach))
