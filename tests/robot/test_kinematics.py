"""Forward and inverse kinematics against each other, another library, and numbers worked out by hand."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from flatgrasp_cli import load_robot
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.profiles.robot import Robot
from flatgrasp_cli.robot import (
    forward,
    inverse,
    manipulability,
    max_manipulability,
)
from flatgrasp_cli.robot.kinematics import heights
from tests.robot.arms import ROBOTS, UR5, apart, exists, flange, random_joints, rows


def test_the_flange_at_zero_angles_by_hand() -> None:
    """The arm lies along −x (both a are negative), wrist 2 hangs by d5, and d4 and d6 go along z₁ = −y."""
    pose = forward(rows(UR5), np.zeros(6))[5]
    np.testing.assert_allclose(pose[:3, 3], [-0.425 - 0.39225, -0.10915 - 0.0823, 0.089159 - 0.09465], atol=1e-15)
    np.testing.assert_allclose(pose[:3, :3], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-15)


@pytest.mark.parametrize("name", ROBOTS)
def test_inverse_finds_the_same_as_ur_analytic_ik(name: str) -> None:
    other = getattr(pytest.importorskip("ur_analytic_ik"), name)
    robot, count = load_robot(name), 10_000 if name == "ur5" else 2_000
    positions, axes = flange(robot, random_joints(count))
    positions[::4] *= 1.5  # many of them out of reach
    theirs = np.full((count, 8, 6), np.nan)
    for k in range(count):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = axes[k].T, positions[k]
        found = other.inverse_kinematics(pose)
        theirs[k, : len(found)] = np.reshape(found, (-1, 6))
    ours = inverse(rows(robot), positions, axes)
    numbers = exists(ours).sum(axis=1)
    np.testing.assert_array_equal(numbers, exists(theirs).sum(axis=1))
    assert set(numbers) >= {0, 4, 8}
    distance = np.nan_to_num(apart(ours[:, :, None], theirs[:, None]), nan=np.inf)
    assert distance.min(axis=2)[exists(ours)].max() < 1e-6
    assert distance.min(axis=1)[exists(theirs)].max() < 1e-6


@pytest.mark.parametrize("name", ROBOTS)
def test_forward_undoes_inverse_and_every_pose_gives_back_its_angles(name: str) -> None:
    robot, joints = load_robot(name), random_joints(3_000, seed=1)
    positions, axes = flange(robot, joints)
    solutions = inverse(rows(robot), positions, axes)
    assert np.nanmin(apart(solutions, joints[:, None]), axis=1).max() < 1e-6
    assert (np.abs(solutions[exists(solutions)]) <= np.pi + 1e-12).all()
    row, _ = np.nonzero(exists(solutions))
    found, turned = flange(robot, solutions[exists(solutions)])
    np.testing.assert_allclose(found, positions[row], atol=1e-9)
    np.testing.assert_allclose(turned, axes[row], atol=1e-9)


def test_a_branch_is_named_by_its_place() -> None:
    solutions = inverse(rows(UR5), *flange(UR5, random_joints(500)))
    for wrist, elbow, shoulder in product((0, 1), repeat=3):
        branch = solutions[:, 4 * shoulder + 2 * wrist + elbow]
        branch = branch[exists(branch)]
        assert len(branch) > 100
        assert (np.sign(np.sin(branch[:, 4])) == 1 - 2 * wrist).all()
        assert (np.sign(np.sin(branch[:, 2])) == 1 - 2 * elbow).all()


def test_a_branch_is_all_there_or_all_nan() -> None:
    solutions = inverse(rows(UR5), *flange(UR5, random_joints(500)))
    np.testing.assert_array_equal(np.isnan(solutions).any(axis=2), np.isnan(solutions).all(axis=2))


@pytest.mark.parametrize("wrist", [0.0, np.pi, -np.pi])
def test_singular_wrists_are_reached_too(wrist: float) -> None:
    """q6 is free there, but not every q6 lets the two links close: one that does must be tried."""
    joints = random_joints(2_000, seed=2)
    joints[:, 4] = wrist
    positions, axes = flange(UR5, joints)
    solutions = inverse(rows(UR5), positions, axes, seed_rad=0.3)
    assert exists(solutions).any(axis=1).all()
    row, _ = np.nonzero(exists(solutions))
    found, turned = flange(UR5, solutions[exists(solutions)])
    np.testing.assert_allclose(found, positions[row], atol=1e-9)
    np.testing.assert_allclose(turned, axes[row], atol=1e-9)
    q6 = solutions[exists(solutions)][:, 5]
    assert (np.abs(q6 - 0.3) < 1e-12).any()
    assert (np.abs(q6 - 0.3) > 0.5).any()


def test_the_seed_is_tried_first_where_the_wrist_is_singular() -> None:
    joints = random_joints(500, seed=3)
    joints[:, 4:] = 0.0, -0.7
    solutions = inverse(rows(UR5), *flange(UR5, joints), seed_rad=-0.7)
    assert np.nanmin(apart(solutions, joints[:, None]), axis=1).max() < 1e-6


def test_no_solution_is_listed_twice_where_the_wrist_is_singular() -> None:
    joints = random_joints(200, seed=3)
    joints[:, 4] = 0.0
    solutions = inverse(rows(UR5), *flange(UR5, joints))
    between = apart(solutions[:, :, None], solutions[:, None])
    assert np.nanmin(between[:, ~np.eye(8, dtype=bool)]) > 1e-6


def test_a_stretched_arm_is_still_an_arm() -> None:
    joints = random_joints(200, seed=4)
    joints[:, 2] = 0.0
    solutions = inverse(rows(UR5), *flange(UR5, joints))
    assert np.nanmin(apart(solutions, joints[:, None]), axis=1).max() < 1e-6


def numeric_determinant(robot: Robot, joints: FloatArray) -> FloatArray:
    """|det| (n,) of the Jacobian of the flange's velocity and rotation, by central differences."""
    columns, step = [], 1e-6
    for joint in range(6):
        moved = np.zeros(6)
        moved[joint] = step
        after, before = (forward(rows(robot), joints + sign * moved)[:, 5] for sign in (1, -1))
        rate = (after - before) / (2 * step)
        spin = rate[:, :3, :3] @ np.swapaxes(forward(rows(robot), joints)[:, 5, :3, :3], 1, 2)
        turning = [spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]]
        columns.append(np.column_stack([rate[:, :3, 3], *turning]))
    return np.asarray(np.abs(np.linalg.det(np.stack(columns, axis=2))))


@pytest.mark.parametrize("name", ["ur5", "ur3e"])
def test_manipulability_is_the_jacobians_determinant(name: str) -> None:
    robot, joints = load_robot(name), random_joints(300)
    measure = manipulability(rows(robot), joints)
    np.testing.assert_allclose(measure, numeric_determinant(robot, joints), atol=1e-9)
    assert measure.max() > 0.3 * max_manipulability(rows(robot))


@pytest.mark.parametrize("joint", [2, 4])
def test_manipulability_is_nothing_where_elbow_or_wrist_are_singular(joint: int) -> None:
    joints = random_joints(20)
    joints[:, joint] = 0.0
    assert (manipulability(rows(UR5), joints) < 1e-12).all()


@pytest.mark.parametrize("name", ROBOTS)
def test_the_largest_manipulability_is_approached_and_not_passed(name: str) -> None:
    dh = rows(load_robot(name))
    joints = random_joints(200_000)
    joints[:, 4] = np.pi / 2
    share = manipulability(dh, joints).max() / max_manipulability(dh)
    assert 0.98 < share <= 1.0
    assert max_manipulability(rows(UR5)) == pytest.approx(0.119, abs=1e-3)


def test_heights_are_those_of_the_frames() -> None:
    normal, joints = np.array([0.3, -0.5, 0.8]), random_joints(50)
    expected = forward(rows(UR5), joints)[:, 1:5, :3, 3] @ normal
    np.testing.assert_allclose(heights(rows(UR5), joints.T, normal), expected.T, atol=1e-14)
