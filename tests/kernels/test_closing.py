"""Closing jaws: compiled and as written. What they should find is asked for in tests/ranking/test_closing.py."""

from __future__ import annotations

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.polygon import edges
from flatgrasp_cli.kernels import closing
from tests.conftest import I_BEAM, MM, disc, rectangle
from tests.kernels.interpreted import interpreted

OUTLINES = (I_BEAM, rectangle(100, 40), disc(40).difference(disc(20)).simplify(0.5))


@given(outline=st.sampled_from(OUTLINES), seed=st.integers(0, 999), spread=st.sampled_from([0.0, 0.01, 0.1]))
def test_compiled_and_as_written_they_find_the_same(outline: shapely.Polygon, seed: int, spread: float) -> None:
    """And hands near each other find what each of them finds alone."""
    starts, ends = edges([np.array(ring.coords)[:-1] * MM for ring in (outline.exterior, *outline.interiors)])
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0, 2 * np.pi, (2, 1)) * rng.integers(0, 2, (2, 1))  # many edges stand upright
    turn = turn + 10 * spread * rng.normal(size=(2, 4))
    middle = rng.uniform(-0.06, 0.06, (2, 1, 2)) + spread * rng.normal(size=(2, 4, 2))
    hands = np.concatenate([middle, np.stack([-np.sin(turn), np.cos(turn), rng.uniform(0.01, 0.09, (2, 4))], 2)], 2)
    fingers, tip = np.array([[0, 0], [1, -0.02], [1, 0.02]]), np.array([0.010, 0.005, 0.003, 0.008, 0.030])
    found = closing.closed(starts, ends, hands, fingers, tip, 0.001)
    assert np.array_equal(found, interpreted("closing").closed(starts, ends, hands, fingers, tip, 0.001))
    alone = [closing.closed(starts, ends, hands[:, k : k + 1].copy(), fingers, tip, 0.001) for k in range(4)]
    assert np.array_equal(found, np.concatenate(alone, axis=2))
