"""Closing jaws: compiled and as written. What they should find is asked for in tests/ranking/test_closing.py."""

from __future__ import annotations

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.chain import closed_chain
from flatgrasp_cli.kernels import closing
from tests.conftest import I_BEAM, MM, disc, rectangle
from tests.kernels.interpreted import interpreted

OUTLINES = (I_BEAM, rectangle(100, 40), disc(40).difference(disc(20)).simplify(0.5))


@given(outline=st.sampled_from(OUTLINES), seed=st.integers(0, 999))
def test_compiled_and_as_written_they_find_the_same(outline: shapely.Polygon, seed: int) -> None:
    loops = [np.array(ring.coords)[:-1] * MM for ring in (outline.exterior, *outline.interiors)]
    points, breaks = closed_chain(loops)
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0, 2 * np.pi, 5) * rng.integers(0, 2, 5)  # many edges stand upright
    axes = np.column_stack([-np.sin(turn), np.cos(turn)])
    hands = np.column_stack([rng.uniform(-0.06, 0.06, (5, 2)), axes, rng.uniform(0.01, 0.09, 5)])
    edges, tip = np.delete(np.arange(len(points) - 1), breaks), np.array([0.010, 0.005, 0.003, 0.008])
    fingers = np.array([[0, 0], [1, -0.02], [1, 0.02]])
    arguments = (points, edges, hands, fingers, tip, 0.001)
    assert np.array_equal(closing.touched(*arguments), interpreted("closing").touched(*arguments))
