"""Rotating, moving, mirroring or sampling a cloud anew moves the grasp along, and changes nothing else."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Grasp
from tests.conftest import MM, cloud_of, rectangle, sampled

PLATE = sampled(rectangle(120, 40), seed=3)
BEAM = sampled(
    shapely.union_all([shapely.box(-15, -40, 15, 40), shapely.box(-60, -60, 60, -40), shapely.box(-60, 40, 60, 60)]),
    seed=4,
)
"""An I-beam whose neck is so long that a hand which misses finds room there: no other place holds more probably."""
VIEW = np.array([0.0, 0.0, 1.0])
seeds = st.integers(0, 2**31 - 1)


def grasp_of(points: FloatArray, viewpoint: FloatArray = VIEW) -> Grasp:
    result = plan(cloud_of(points, viewpoint.tolist()), load_gripper("pr2"))
    assert result.best is not None, result.reason
    return result.best


@cache
def unmoved() -> tuple[Grasp, Grasp]:
    """The grasps of the plate and of the beam as they are."""
    return grasp_of(PLATE), grasp_of(BEAM)


def assert_same_up_to(grasp: Grasp, other: Grasp, turn: Rotation, shift: FloatArray) -> None:
    """`other` is `grasp` turned and moved, the hand's own half turn allowed."""
    assert other.position == pytest.approx(turn.apply(grasp.position) + shift, abs=1.5 * MM)
    before, after = (Rotation.from_quat(g.orientation).as_matrix() for g in (grasp, other))
    moved = turn.as_matrix() @ before
    assert moved[:, 2] @ after[:, 2] > np.cos(np.radians(3))  # heights are random: so is the plane, a little
    assert abs(moved[:, 1] @ after[:, 1]) > np.cos(np.radians(2.5))
    assert other.width_m == pytest.approx(grasp.width_m, abs=1 * MM)


@settings(max_examples=15)
@given(seeds, st.tuples(*[st.floats(-2, 2)] * 3))
def test_a_moved_cloud_has_the_moved_grasp(seed: int, shift: tuple[float, float, float]) -> None:
    turn = Rotation.random(random_state=seed)
    moved = grasp_of(turn.apply(PLATE) + shift, turn.apply(VIEW) + shift)
    assert_same_up_to(unmoved()[0], moved, turn, np.array(shift))


@settings(max_examples=10)
@given(seeds)
def test_a_mirrored_cloud_has_the_mirrored_grasp(seed: int) -> None:
    mirror = np.diag([-1.0, 1.0, 1.0])
    turn = Rotation.from_euler("z", seed % 360, degrees=True)
    grasp, mirrored = grasp_of(turn.apply(BEAM)), grasp_of(turn.apply(BEAM) @ mirror)
    assert mirrored.position == pytest.approx(mirror @ grasp.position, abs=2 * MM)
    assert mirrored.width_m == pytest.approx(grasp.width_m, abs=1 * MM)
    assert mirrored.gravity_distance_m < 2 * MM


@settings(max_examples=10)
@given(seeds, st.floats(0.8, 2.0))
def test_another_sampling_gives_the_same_grasp(seed: int, pitch_mm: float) -> None:
    again = grasp_of(sampled(rectangle(120, 40), pitch_mm, seed))
    assert_same_up_to(unmoved()[0], again, Rotation.identity(), np.zeros(3))
    assert again.gravity_distance_m < 1 * MM
    assert again.force_balance_deg < 1


def test_the_order_of_the_points_does_not_matter() -> None:
    shuffled = np.random.default_rng(0).permutation(BEAM)
    assert_same_up_to(unmoved()[1], grasp_of(shuffled), Rotation.identity(), np.zeros(3))


def test_the_same_input_gives_the_same_answer_to_the_last_bit() -> None:
    first, second = unmoved()[1], grasp_of(BEAM.copy())
    assert first.position.tolist() == second.position.tolist()
    assert first.orientation.tolist() == second.orientation.tolist()
    assert first.fingers == second.fingers
