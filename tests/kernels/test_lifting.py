"""Loads on grips: compiled and as written. What they should find, tests/ranking asks for, and here vectors in space."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import lifting
from tests.kernels.interpreted import interpreted

WIDE, HIGH = 0.02, 0.01
RADIUS = (2 * np.hypot(WIDE, HIGH) + WIDE**2 / HIGH * np.arcsinh(HIGH / WIDE) + HIGH**2 / WIDE * np.arcsinh(2)) / 12


@given(seed=st.integers(0, 999), lift=st.sampled_from([0.1, np.inf]))
def test_what_pulls_beside_a_hand_turns_and_tilts(seed: int, lift: float) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("lifting")
    turn, fall = rng.uniform(0, 2 * np.pi, (3, 4)), rng.normal(size=3)
    hands = np.dstack([rng.normal(size=(3, 4, 2)), np.cos(turn), np.sin(turn), rng.random((3, 4))])
    tip, size, down = rng.normal(size=3), rng.random(3), fall / np.linalg.norm(fall)
    grips = np.column_stack([hands[:, 0, :4], tip, np.full(3, WIDE), np.full(3, HIGH)])
    pulls, weight = rng.normal(size=(4, 2)), rng.random(4)
    arguments = (hands, grips, size, rng.normal(size=2), pulls, weight, down, lift)
    found = lifting.needs(*arguments)
    assert found == pytest.approx(twin.needs(*arguments), rel=1e-12)
    place = np.append(pulls[1] - hands[2, 1, :2], 0.5 * size[2] - tip[2] - 0.5 * HIGH)
    ux, uy = hands[2, 1, 2:4]
    torque = np.cross(place, down) @ np.array([[ux, uy, 0], [-uy, ux, 0]]).T
    assert found[0, 2, 1] == pytest.approx(weight[1] * abs(torque[0]) / RADIUS)
    assert found[2, 2, 1] == pytest.approx(2 * weight[1] * torque[1])
    if np.isinf(lift):
        deep = place @ down - (ux * place[0] + uy * place[1]) * (ux * down[0] + uy * down[1])
        assert found[1, 2, 1] / RADIUS == pytest.approx(np.arctan2(abs(torque[0]), deep))
