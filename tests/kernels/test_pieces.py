"""Pieces that stand out: compiled, as written, and by a count of each."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import pieces
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999))
def test_points_belong_to_the_pieces_of_their_cells(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, cells = rng.integers(0, 5, (40, 3)).astype(np.float64), rng.integers(0, 12, 40)
    labels = rng.integers(0, 4, 12).astype(np.int32)
    found, counts = pieces.standing_out(points, cells, labels, 2.0, 4)
    again = interpreted("pieces").standing_out(points, cells, labels, 2.0, 4)
    assert np.array_equal(found, again[0])
    assert np.array_equal(counts, again[1])
    assert np.array_equal(found, np.where(points[:, 2] > 2.0, labels[cells], 0))
    assert np.array_equal(counts, np.bincount(found, minlength=4))
