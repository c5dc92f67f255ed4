"""Trials of grasps: compiled and as written. What they should find, tests/ranking asks for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.kernels import trial
from tests.kernels.interpreted import interpreted

USUAL = np.array([0.5, 0.4, 0.5, 0.05, 0.001])


@given(seed=st.integers(0, 999), alone=st.booleans())
def test_compiled_and_as_written_they_come_to_the_same(seed: int, alone: bool) -> None:
    rng, shape = np.random.default_rng(seed), (3, 8)
    met = rng.uniform(0, 0.05, (10, *shape))
    met[[0, 2]] = rng.random((2, *shape)) < 0.8
    met[3] *= 20
    met[9] *= rng.choice([-1, 1], shape)
    grasps = np.column_stack([rng.uniform(0, 0.05, (3, 3)), np.full(3, not alone), rng.random((3, 3))])
    grasps = np.column_stack([grasps, np.sort(rng.uniform(0, 0.05, (3, 2, 2))).reshape(3, 4)])
    leans = rng.uniform(-0.1, 0.3, (3, 4))
    samples = np.column_stack([rng.random(8), rng.normal(0, 0.001, 8), rng.uniform(0, 0.5, 8)])
    inside = (rng.random(shape) < 0.2).view(np.uint8)
    found = trial.chances(met, grasps, leans, samples, inside, USUAL)
    assert np.array_equal(found, interpreted("trial").chances(met, grasps, leans, samples, inside, USUAL))
    assert (np.diff(found, axis=1) <= 1e-12).all()  # what has failed does not come back
    need = rng.uniform(0, 1, 9)
    assert np.array_equal(trial.suffices(need, 0.5, 0.4), interpreted("trial").suffices(need, 0.5, 0.4))


@given(seed=st.integers(0, 999))
def test_hands_that_miss(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("trial")
    turn, yaw = rng.uniform(0, 2 * np.pi, 3), rng.normal(size=4)
    grasps = np.column_stack([rng.normal(size=(3, 2)), np.cos(turn), np.sin(turn), rng.random(3)])
    misses = np.column_stack([rng.normal(size=(4, 2)), np.cos(yaw), np.sin(yaw)])
    hands = trial.moved(grasps, misses)
    assert np.array_equal(hands, twin.moved(grasps, misses))
    assert hands[2, 1, :2] == pytest.approx(
        grasps[2, :2]
        + misses[1] @ [[-np.sin(turn[2]), np.cos(turn[2])], [np.cos(turn[2]), np.sin(turn[2])], [0, 0], [0, 0]]
    )
    assert np.arctan2(*hands[2, 1, 3:1:-1]) == pytest.approx(
        np.arctan2(np.sin(turn[2] + yaw[1]), np.cos(turn[2] + yaw[1]))
    )


def test_a_known_friction_is_there_or_not() -> None:
    assert trial.suffices(np.array([0.49, 0.51]), 0.5, 0.0).tolist() == [1.0, 0.0]
