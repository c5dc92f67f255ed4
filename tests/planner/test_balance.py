"""Force balance, torque balance and friction: the vectorised kernels against their definitions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli import load_settings
from flatgrasp_cli.funnel import Funnel, NothingLeft
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import FingerCandidates
from flatgrasp_cli.planner import balance
from flatgrasp_cli.profiles import Gripper
from tests.by_hand import candidates

seeds = st.integers(0, 2**32 - 1)


def random_candidates(seed: int, n: int = 12) -> FingerCandidates:
    rng = np.random.default_rng(seed)
    angles = rng.uniform(0, 2 * np.pi, n)
    return candidates(rng.uniform(-0.1, 0.1, (n, 2)), np.column_stack([np.cos(angles), np.sin(angles)]))


def signed_angle(a: FloatArray, b: FloatArray) -> float:
    return math.atan2(a[0] * b[1] - a[1] * b[0], a @ b)


def test_gamma_is_zero_when_opposed_and_180_when_equal() -> None:
    directions = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
    gamma = balance.force_balance(candidates(np.zeros((3, 2)), directions))
    assert gamma == pytest.approx(np.array([[180.0, 0, 90], [0, 180, 90], [90, 90, 180]]))


@given(seeds)
def test_gamma_is_the_resultant_of_two_unit_forces(seed: int) -> None:
    fingers = random_candidates(seed)
    resultant = np.linalg.norm(fingers.direction[:, None] + fingers.direction[None], axis=2)
    assert 2 * np.sin(np.radians(balance.force_balance(fingers)) / 2) == pytest.approx(resultant, abs=1e-7)


@given(seeds, st.floats(0.05, 1.5))
def test_required_friction_is_nguyens_force_closure(seed: int, friction: float) -> None:
    """γ/2 + |ā| < atan μ, both contacts' forces inside their friction cones, and μ above the required: all the same."""
    fingers = random_candidates(seed)
    rows, columns = balance.opposing_candidates(fingers)
    i, j = (index.ravel() for index in np.meshgrid(rows, columns, indexing="ij"))
    face = balance.facing(fingers, rows, columns).ravel() & (i != j)
    gamma = balance.force_balance(fingers).ravel()
    pairs = balance.weigh(fingers, i[face], j[face], gamma[face])
    for k in range(len(pairs)):
        a, b = fingers.contact[pairs.i[k]], fingers.contact[pairs.j[k]]
        e = (b - a) / np.linalg.norm(b - a)
        a_i, a_j = signed_angle(e, fingers.direction[pairs.i[k]]), signed_angle(e, -fingers.direction[pairs.j[k]])
        identity = math.radians(pairs.force_balance_deg[k]) / 2 + abs(a_i + a_j) / 2
        assert math.atan(pairs.required_friction[k]) == pytest.approx(identity, abs=1e-6)
        cones = max(abs(a_i), abs(a_j)) < math.atan(friction)
        assert cones == (pairs.required_friction[k] < friction)


@given(seeds)
def test_torque_arm_is_the_couple_of_two_unit_forces(seed: int) -> None:
    fingers = random_candidates(seed)
    i, j = np.array([0, 1, 2]), np.array([3, 4, 5])
    pairs = balance.weigh(fingers, i, j, np.zeros(3))
    middle = (fingers.contact[i] + fingers.contact[j]) / 2
    torque = np.zeros(3)
    for index in (i, j):
        arm, force = fingers.contact[index] - middle, fingers.direction[index]
        torque += arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    assert pairs.torque_arm_m == pytest.approx(np.abs(torque), abs=1e-12)


def test_two_inner_sides_of_a_gap_do_not_face_each_other() -> None:
    """A U's inner sides: the directions point into the material, away from each other."""
    u_shape = candidates(np.array([[-0.01, 0.0], [0.01, 0.0]]), np.array([[-1.0, 0.0], [1.0, 0.0]]))
    rows, columns = balance.opposing_candidates(u_shape)
    assert balance.force_balance(u_shape)[0, 1] == pytest.approx(0.0)  # perfectly balanced, and useless
    assert not balance.facing(u_shape, rows, columns)[0, 1]


def test_each_two_equal_fingers_are_one_pair_but_a_thumb_meets_every_finger_pair() -> None:
    points, directions = np.zeros((4, 2)), np.tile([1.0, 0.0], (4, 1))
    equal = candidates(points, directions)
    assert balance.distinct(equal, *balance.opposing_candidates(equal)).sum() == 6
    thumbs = candidates(points, directions, [0, 0, 1, 1])
    assert balance.distinct(thumbs, *balance.opposing_candidates(thumbs)).sum() == 4


@pytest.mark.parametrize(("turned_deg", "kept"), [(24, True), (30, False)])
def test_gamma_uses_half_of_the_friction_cone(turned_deg: float, kept: bool, pr2: Gripper) -> None:
    """With μ = 0.5 the cone is 26.6° to either side."""
    limits = load_settings().resolve(pr2).balance
    turn = np.radians(90 + turned_deg)
    fingers = candidates(np.array([[0.0, -0.02], [0.0, 0.02]]), np.array([[0.0, 1.0], [-np.cos(turn), -np.sin(turn)]]))
    gamma, funnel = balance.force_balance(fingers), Funnel()
    if kept:
        assert len(balance.force_balanced(fingers, gamma, limits, funnel)) == 1
    else:
        with pytest.raises(NothingLeft, match=r"allowed 26\.6"):
            balance.force_balanced(fingers, gamma, limits, funnel)
