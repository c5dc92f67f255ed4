"""Force balance, torque balance and friction against their definitions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli import load_settings
from flatgrasp_cli.funnel import Funnel, NothingLeft
from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.kernels import pairs
from flatgrasp_cli.model import FingerCandidates
from flatgrasp_cli.planner import balance
from flatgrasp_cli.profiles import Gripper
from tests.by_hand import candidates

seeds = st.integers(0, 2**32 - 1)


def random_candidates(seed: int, n: int = 12) -> FingerCandidates:
    rng = np.random.default_rng(seed)
    angles = rng.uniform(0, 2 * np.pi, n)
    return candidates(rng.uniform(-0.1, 0.1, (n, 2)), np.column_stack([np.cos(angles), np.sin(angles)]))


def all_pairs(fingers: FingerCandidates, facing: bool = True) -> tuple[IntArray, list[int]]:
    """The pairs of whatever balance, and how many there are without and with the need to face each other."""
    counts = np.zeros(2, dtype=np.intp)
    found = pairs.balanced(fingers.contact, fingers.direction, fingers.jaw, facing, 180.0, counts)
    return found, counts.tolist()


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
    weighed = balance.weigh(fingers, all_pairs(fingers)[0])
    for k in range(len(weighed)):
        a, b = fingers.contact[weighed.i[k]], fingers.contact[weighed.j[k]]
        e = (b - a) / np.linalg.norm(b - a)
        a_i, a_j = signed_angle(e, fingers.direction[weighed.i[k]]), signed_angle(e, -fingers.direction[weighed.j[k]])
        identity = math.radians(weighed.force_balance_deg[k]) / 2 + abs(a_i + a_j) / 2
        assert math.atan(weighed.required_friction[k]) == pytest.approx(identity, abs=1e-6)
        cones = max(abs(a_i), abs(a_j)) < math.atan(friction)
        assert cones == (weighed.required_friction[k] < friction)


@given(seeds)
def test_torque_arm_is_the_couple_of_two_unit_forces(seed: int) -> None:
    fingers = random_candidates(seed)
    i, j = np.array([0, 1, 2]), np.array([3, 4, 5])
    weighed = balance.weigh(fingers, np.array([i, j]))
    middle = (fingers.contact[i] + fingers.contact[j]) / 2
    torque = np.zeros(3)
    for index in (i, j):
        arm, force = fingers.contact[index] - middle, fingers.direction[index]
        torque += arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    assert weighed.torque_arm_m == pytest.approx(np.abs(torque), abs=1e-12)


def test_two_inner_sides_of_a_gap_do_not_face_each_other() -> None:
    """A U's inner sides: the directions point into the material, away from each other."""
    u_shape = candidates(np.array([[-0.01, 0.0], [0.01, 0.0]]), np.array([[-1.0, 0.0], [1.0, 0.0]]))
    assert balance.force_balance(u_shape)[0, 1] == pytest.approx(0.0)  # perfectly balanced, and useless
    assert all_pairs(u_shape, facing=False)[0].tolist() == [[0], [1]]
    found, counts = all_pairs(u_shape)
    assert (found.size, counts) == (0, [1, 0])


def test_each_two_equal_fingers_are_one_pair_but_a_thumb_meets_every_finger_pair() -> None:
    points, directions = np.zeros((4, 2)), np.tile([1.0, 0.0], (4, 1))
    equal = candidates(points, directions)
    assert all_pairs(equal, facing=False)[1][0] == 6
    thumbs = candidates(points, directions, [0, 0, 1, 1])
    assert all_pairs(thumbs, facing=False)[0].tolist() == [[0, 0, 1, 1], [2, 3, 2, 3]]


@pytest.mark.parametrize(("turned_deg", "kept"), [(24, True), (30, False)])
def test_gamma_uses_half_of_the_friction_cone(turned_deg: float, kept: bool, pr2: Gripper) -> None:
    """With μ = 0.5 the cone is 26.6° to either side."""
    limits = load_settings().resolve(pr2).balance
    turn = np.radians(90 + turned_deg)
    fingers = candidates(np.array([[0.0, -0.02], [0.0, 0.02]]), np.array([[0.0, 1.0], [-np.cos(turn), -np.sin(turn)]]))
    funnel = Funnel()
    if kept:
        assert len(balance.force_balanced(fingers, limits, funnel)) == 1
    else:
        with pytest.raises(NothingLeft, match=r"allowed 26\.6"):
            balance.force_balanced(fingers, limits, funnel)
