"""Arms of any make: closed forms by EAIK agree with ours for UR arms, and every solution is one."""

from __future__ import annotations

import builtins
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli import load_robot
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.profiles import Robot, list_profiles
from flatgrasp_cli.profiles.chain import Chain, FramePlace, JointPlace
from flatgrasp_cli.robot import Motion, Plane, arm_of, forward, inverse, manipulability, reach
from flatgrasp_cli.robot.arms import ChainArm
from flatgrasp_cli.robot.chain import Joints
from flatgrasp_cli.robot.closed_form import ClosedForm
from tests.robot.arms import UP, UR5, apart, random_joints, rows

OTHERS = [name for name in list_profiles("robot") if load_robot(name).chain is not None]
FULL_TURN = (np.full(7, -np.pi), np.full(7, np.pi))


def as_chain(robot: Robot) -> Robot:
    """A UR arm as if it were another: a Denavit–Hartenberg row is a place of the next joint."""
    dh = rows(robot)
    places = [
        FramePlace(xyz_m=(a, 0.0, d), rpy_deg=(alpha, 0.0, 0.0))
        for a, d, alpha in zip(dh.a_m, dh.d_m, dh.alpha_deg, strict=True)
    ]
    joints = (JointPlace(xyz_m=(0.0, 0.0, 0.0)), *(JointPlace(**each.model_dump()) for each in places[:-1]))
    chain = Chain(joints=joints, flange=places[-1])
    return Robot.model_validate(robot.model_dump() | {"dh": None, "chain": chain.model_dump()})


def joints_of(robot: Robot) -> Joints:
    assert robot.chain is not None
    return Joints.of(robot.chain)


def drawn(robot: Robot, count: int) -> FloatArray:
    """Joint angles within the limits, a locked joint at its values."""
    limits = np.radians([robot.joints.lower_deg, robot.joints.upper_deg]).clip(-np.pi, np.pi)
    angles = np.asarray(np.random.default_rng(1).uniform(limits[0], limits[1], (count, robot.count)))
    if robot.lock is not None and robot.lock.joint is not None:
        k = robot.lock.joint - 1
        low, high = np.radians([robot.joints.lower_deg[k], robot.joints.upper_deg[k]])
        width = min(high - low, 2 * np.pi)
        share = (np.random.default_rng(2).integers(0, robot.lock.values, count) + 0.5) / robot.lock.values - 0.5
        angles[:, k] = 0.5 * (low + high) + share * width
    return angles


def test_a_chain_moves_as_its_rows_do() -> None:
    angles = random_joints(50)
    frames, stance = forward(rows(UR5), angles), joints_of(as_chain(UR5)).stance(angles)
    np.testing.assert_allclose(stance.position, frames[:, 5, :3, 3], atol=1e-12)
    np.testing.assert_allclose(stance.axes_of_flange, frames[:, 5, :3, :3].transpose(0, 2, 1), atol=1e-12)
    np.testing.assert_allclose(stance.points[:, 1:], frames[:, :5, :3, 3], atol=1e-12)


def test_the_jacobian_is_how_the_flange_moves() -> None:
    joints, angles = joints_of(load_robot("franka_fr3")), drawn(load_robot("franka_fr3"), 5)
    jacobian = joints.stance(angles).jacobian()
    for k in range(7):
        step = np.eye(7)[k] * 1e-6
        moved = (joints.stance(angles + step).position - joints.stance(angles - step).position) / 2e-6
        np.testing.assert_allclose(jacobian[:, :3, k], moved, atol=1e-8)


class TestWithEaik:
    @pytest.fixture(autouse=True)
    def _eaik(self) -> None:
        pytest.importorskip("eaik")

    @pytest.mark.parametrize("name", OTHERS)
    def test_no_pose_takes_the_flange_farther_than_the_links_stretched(self, name: str) -> None:
        arm, joints = arm_of(load_robot(name)), joints_of(load_robot(name))
        far = np.linalg.norm(joints.stance(drawn(load_robot(name), 20_000)).position - arm.shoulder, axis=1)
        assert 0.8 * arm.span_m < far.max() <= arm.span_m

    @pytest.mark.parametrize("name", ["ur5", "ur10e"])
    def test_it_has_the_same_answers_as_ours_on_a_thousand_poses(self, name: str) -> None:
        robot = load_robot(name)
        poses = forward(rows(robot), random_joints(1000))[:, 5]
        positions, axes = poses[:, :3, 3], poses[:, :3, :3].transpose(0, 2, 1)
        ours = inverse(rows(robot), positions, axes)
        of, theirs = ClosedForm(name, joints_of(as_chain(robot)), None, FULL_TURN).solve(positions, axes)
        for k in range(1000):
            mine, other = ours[k][~np.isnan(ours[k]).any(axis=1)], theirs[of == k]
            assert len(mine) == len(other), k
            assert apart(mine[:, None], other[None]).min(axis=1).max() < 1e-5, k

    @pytest.mark.parametrize("name", OTHERS)
    def test_every_solution_is_one_and_nearly_all_are_found(self, name: str) -> None:
        robot = load_robot(name)
        joints, angles = joints_of(robot), drawn(robot, 300)
        limits = np.radians(robot.joints.lower_deg), np.radians(robot.joints.upper_deg)
        poses = joints.stance(angles)
        of, found = ClosedForm(name, joints, robot.lock, limits).solve(poses.position, poses.axes_of_flange)
        again = joints.stance(found)
        np.testing.assert_allclose(again.position, poses.position[of], atol=1e-8)
        np.testing.assert_allclose(again.axes_of_flange, poses.axes_of_flange[of], atol=1e-8)
        recalled = np.unique(of[apart(found, angles[of]) < 1e-4])
        assert len(recalled) >= 0.97 * 300
        assert len(np.unique(of)) >= 0.98 * 300

    def test_as_a_chain_an_arm_reaches_what_it_reaches(self) -> None:
        rng = np.random.default_rng(3)
        positions = rng.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 0.4], (200, 3))
        down = np.broadcast_to(np.diag([-1.0, 1.0, -1.0]), (200, 3, 3))
        motion, table = Motion(0.1, 0.1, UP, twin=True), Plane(UP, 0.0)
        ours, theirs = (reach(robot, positions, down, motion, table) for robot in (UR5, as_chain(UR5)))
        assert sum(answer.ok for answer in ours) > 50
        # the two have the same heights and nearly the same largest manipulability, and so the same limits
        assert sum(one.ok != other.ok for one, other in zip(ours, theirs, strict=True)) <= 4
        for one, other in zip(ours, theirs, strict=True):
            same = one.twin == other.twin and one.manipulability == pytest.approx(other.manipulability)
            if one.ok and other.ok and same:
                assert one.joints_rad is not None
                assert other.joints_rad is not None
                assert apart(other.joints_rad, one.joints_rad).max() < 1e-6

    @pytest.mark.parametrize("name", OTHERS)
    def test_an_arm_goes_to_the_three_poses(self, name: str) -> None:
        robot = load_robot(name)
        joints = joints_of(robot)
        at = np.array([[0.45, 0.1, 0.2]])
        (answer,) = reach(robot, at, np.diag([-1.0, 1.0, -1.0])[None], Motion(0.1, 0.08, UP, twin=True), Plane(UP, 0.0))
        assert answer.ok
        assert answer.joints_rad is not None
        stance = joints.stance(answer.joints_rad)
        np.testing.assert_allclose(stance.position, at + np.outer([0.1, 0.0, 0.08], UP), atol=1e-7)
        np.testing.assert_allclose(stance.axes_of_flange[:, 2], np.broadcast_to(-UP, (3, 3)), atol=1e-7)
        degrees = np.degrees(answer.joints_rad)
        assert (degrees >= np.array(robot.joints.lower_deg) - 1e-6).all()
        assert (degrees <= np.array(robot.joints.upper_deg) + 1e-6).all()
        far = reach(
            robot, at + np.array([2.0, 0.0, 0.0]), np.diag([-1.0, 1.0, -1.0])[None], Motion(0.1, 0.08, UP, twin=True)
        )
        assert (far[0].ok, far[0].waypoint, far[0].limit) == (False, "pre_grasp", "out of reach")

    def test_manipulability_is_that_of_the_rows(self) -> None:
        arm, angles = arm_of(as_chain(UR5)), random_joints(40)
        assert arm.manipulability(angles.T) == pytest.approx(manipulability(rows(UR5), angles))
        assert arm.most_manipulability == pytest.approx(arm_of(UR5).most_manipulability, rel=0.05)

    def test_a_limit_that_all_solutions_pass_is_named(self) -> None:
        robot = load_robot("franka_fr3")
        data = robot.model_dump()
        data["joints"]["lower_deg"] = (156.9, *data["joints"]["lower_deg"][1:])
        data["reach"]["reference_deg"] = (157.0, *data["reach"]["reference_deg"][1:])
        turned = Robot.model_validate(data)
        (answer,) = reach(
            turned, np.array([[0.45, 0.0, 0.2]]), np.diag([-1.0, 1.0, -1.0])[None], Motion(0.1, 0.1, UP, twin=False)
        )
        assert (answer.ok, answer.waypoint, answer.limit) == (False, "pre_grasp", "joint limit")

    def test_an_arm_without_a_closed_form_says_so(self) -> None:
        robot = load_robot("xarm6")
        data = robot.model_dump()
        data["chain"]["joints"][4]["xyz_m"] = (0.03, 0.02, 0.01)
        with pytest.raises(UsageError, match="no closed form"):
            ChainArm(Robot.model_validate(data), Chain.model_validate(data["chain"]))

    def test_a_joint_to_lock_is_found(self) -> None:
        robot = load_robot("franka_fr3")
        assert robot.lock is not None
        solver = ClosedForm("any", joints_of(robot), robot.lock.model_copy(update={"joint": None}), FULL_TURN)
        assert solver.free.tolist() == [True] * 6 + [False]


def test_without_the_extra_the_install_line_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    load = builtins.__import__

    def missing(name: str, *more: Any) -> Any:
        if name.startswith("eaik"):
            raise ImportError(name, name="eaik")
        return load(name, *more)

    monkeypatch.setattr(builtins, "__import__", missing)
    robot = load_robot("xarm6")
    with pytest.raises(UsageError, match=r"pip install 'flatgrasp\[arms\]'"):
        ClosedForm("xarm6", joints_of(robot), None, FULL_TURN)
