"""Where pieces meet: compiled, as written, and side by side with shifted images."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import borders
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999))
def test_they_are_those_of_shifted_images(seed: int) -> None:
    rng = np.random.default_rng(seed)
    names, (height, depth) = np.zeros((8, 7), dtype=np.intp), rng.uniform(0, 1, (2, 8, 7))
    names[1:-1, 1:-1] = rng.integers(0, 4, (6, 5))
    found = borders.borders(names, height, depth, 0.3, 4)
    again = interpreted("borders").borders(names, height, depth, 0.3, 4)
    assert all(np.array_equal(*both) for both in zip(found, again, strict=True))
    of_piece, (met, smooth), beyond = np.zeros((3, 4)), np.zeros((2, 2, 4, 4)), np.zeros((4, 4))
    for axis in (0, 1):
        for step in (1, -1):
            there, level, far = (np.roll(image, step, axis) for image in (names, height, depth))
            ends = (names > 0) & (names != there)
            meets, goes_on = ends & (there > 0), np.abs(far - depth) < 0.3
            np.add.at(of_piece[0], names[ends], 1)
            np.add.at(of_piece[1], names[meets & ~goes_on & (far < depth)], 1)
            np.add.at(of_piece[2], names[ends], height[ends])
            np.add.at(met[axis], (names[meets], there[meets]), 1)
            goes_on &= meets
            np.add.at(smooth[axis], (names[goes_on], there[goes_on]), 1)
            np.add.at(beyond, (names[goes_on], there[goes_on]), level[goes_on])
    assert found[0] == pytest.approx(of_piece)
    assert np.array_equal(found[1], [met, smooth])
    assert found[2] == pytest.approx(beyond)
