"""Kinematics and reach: against another solver, against numeric derivatives, and against cases worked by hand."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli import load_robot
from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Reach
from flatgrasp_cli.profiles import list_profiles, profile_path
from flatgrasp_cli.profiles.robot import Robot
from flatgrasp_cli.robot import (
    Motion,
    Plane,
    forward,
    in_dh_base,
    inverse,
    manipulability,
    max_manipulability,
    reach,
)
from flatgrasp_cli.robot.kinematics import heights
from flatgrasp_cli.robot.reach import BATCH

ROBOTS = list_profiles("robot")
UR5 = load_robot("ur5")
UP = np.array([0.0, 0.0, 1.0])
DOWN = np.array([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])
"""A hand that comes from straight above, its closing axis along y."""
STILL = Motion(0.0, 0.0, UP, twin=False)
USUAL = Motion(0.1, 0.1, UP, twin=False)


def random_joints(count: int, seed: int = 0) -> FloatArray:
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 6))


def flange(robot: Robot, joints: FloatArray) -> tuple[FloatArray, FloatArray]:
    pose = forward(robot.dh, joints)[..., 5, :, :]
    return pose[..., :3, 3], np.swapaxes(pose[..., :3, :3], -1, -2)


def apart(first: FloatArray, second: FloatArray) -> FloatArray:
    """The largest difference of joint angles (…, 6), whole turns aside."""
    return np.asarray(np.abs((first - second + np.pi) % (2 * np.pi) - np.pi).max(axis=-1))


def exists(solutions: FloatArray) -> Any:
    return ~np.isnan(solutions).any(axis=-1)


def changed(robot: Robot, section: str, **values: Any) -> Robot:
    """The robot with values of a section replaced, validated anew."""
    data = robot.model_dump()
    data[section] |= values
    return Robot.model_validate(data)


def asked(
    robot: Robot,
    position: Any,
    motion: Motion,
    table: Plane | None = None,
    axes: FloatArray = DOWN,
    tool_m: float = 0.0,
) -> Reach:
    at = np.array(position, dtype=float) - tool_m * axes[2]
    (answer,) = reach(robot, at[None], axes[None], motion, table)
    return answer


def angles(answer: Reach) -> FloatArray:
    """Joint angles (3, 6) of an answer that must be yes."""
    assert answer.joints_rad is not None
    return answer.joints_rad


# --- kinematics


def test_the_flange_at_zero_angles_by_hand() -> None:
    """The arm lies along −x (both a are negative), wrist 2 hangs by d5, and d4 and d6 go along z₁ = −y."""
    pose = forward(UR5.dh, np.zeros(6))[5]
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
    ours = inverse(robot.dh, positions, axes)
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
    solutions = inverse(robot.dh, positions, axes)
    assert np.nanmin(apart(solutions, joints[:, None]), axis=1).max() < 1e-6
    assert (np.abs(solutions[exists(solutions)]) <= np.pi + 1e-12).all()
    row, _ = np.nonzero(exists(solutions))
    found, turned = flange(robot, solutions[exists(solutions)])
    np.testing.assert_allclose(found, positions[row], atol=1e-9)
    np.testing.assert_allclose(turned, axes[row], atol=1e-9)


def test_a_branch_is_named_by_its_place() -> None:
    solutions = inverse(UR5.dh, *flange(UR5, random_joints(500)))
    for wrist, elbow, shoulder in product((0, 1), repeat=3):
        branch = solutions[:, 4 * shoulder + 2 * wrist + elbow]
        branch = branch[exists(branch)]
        assert len(branch) > 100
        assert (np.sign(np.sin(branch[:, 4])) == 1 - 2 * wrist).all()
        assert (np.sign(np.sin(branch[:, 2])) == 1 - 2 * elbow).all()


def test_a_branch_is_all_there_or_all_nan() -> None:
    solutions = inverse(UR5.dh, *flange(UR5, random_joints(500)))
    np.testing.assert_array_equal(np.isnan(solutions).any(axis=2), np.isnan(solutions).all(axis=2))


@pytest.mark.parametrize("wrist", [0.0, np.pi, -np.pi])
def test_singular_wrists_are_reached_too(wrist: float) -> None:
    """q6 is free there, but not every q6 lets the two links close: one that does must be tried."""
    joints = random_joints(2_000, seed=2)
    joints[:, 4] = wrist
    positions, axes = flange(UR5, joints)
    solutions = inverse(UR5.dh, positions, axes, seed_rad=0.3)
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
    solutions = inverse(UR5.dh, *flange(UR5, joints), seed_rad=-0.7)
    assert np.nanmin(apart(solutions, joints[:, None]), axis=1).max() < 1e-6


def test_no_solution_is_listed_twice_where_the_wrist_is_singular() -> None:
    joints = random_joints(200, seed=3)
    joints[:, 4] = 0.0
    solutions = inverse(UR5.dh, *flange(UR5, joints))
    between = apart(solutions[:, :, None], solutions[:, None])
    assert np.nanmin(between[:, ~np.eye(8, dtype=bool)]) > 1e-6


def test_a_stretched_arm_is_still_an_arm() -> None:
    joints = random_joints(200, seed=4)
    joints[:, 2] = 0.0
    solutions = inverse(UR5.dh, *flange(UR5, joints))
    assert np.nanmin(apart(solutions, joints[:, None]), axis=1).max() < 1e-6


def numeric_determinant(robot: Robot, joints: FloatArray) -> FloatArray:
    """|det| (n,) of the Jacobian of the flange's velocity and rotation, by central differences."""
    columns, step = [], 1e-6
    for joint in range(6):
        moved = np.zeros(6)
        moved[joint] = step
        after, before = (forward(robot.dh, joints + sign * moved)[:, 5] for sign in (1, -1))
        rate = (after - before) / (2 * step)
        spin = rate[:, :3, :3] @ np.swapaxes(forward(robot.dh, joints)[:, 5, :3, :3], 1, 2)
        turning = [spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]]
        columns.append(np.column_stack([rate[:, :3, 3], *turning]))
    return np.asarray(np.abs(np.linalg.det(np.stack(columns, axis=2))))


@pytest.mark.parametrize("name", ["ur5", "ur3e"])
def test_manipulability_is_the_jacobians_determinant(name: str) -> None:
    robot, joints = load_robot(name), random_joints(300)
    measure = manipulability(robot.dh, joints)
    np.testing.assert_allclose(measure, numeric_determinant(robot, joints), atol=1e-9)
    assert measure.max() > 0.3 * max_manipulability(robot.dh)


@pytest.mark.parametrize("joint", [2, 4])
def test_manipulability_is_nothing_where_elbow_or_wrist_are_singular(joint: int) -> None:
    joints = random_joints(20)
    joints[:, joint] = 0.0
    assert (manipulability(UR5.dh, joints) < 1e-12).all()


@pytest.mark.parametrize("name", ROBOTS)
def test_the_largest_manipulability_is_approached_and_not_passed(name: str) -> None:
    dh = load_robot(name).dh
    joints = random_joints(200_000)
    joints[:, 4] = np.pi / 2
    share = manipulability(dh, joints).max() / max_manipulability(dh)
    assert 0.98 < share <= 1.0
    assert max_manipulability(UR5.dh) == pytest.approx(0.119, abs=1e-3)


def test_heights_are_those_of_the_frames() -> None:
    normal, joints = np.array([0.3, -0.5, 0.8]), random_joints(50)
    expected = forward(UR5.dh, joints)[:, 1:5, :3, 3] @ normal
    np.testing.assert_allclose(heights(UR5.dh, joints.T, normal), expected.T, atol=1e-14)


# --- reach, by hand: the hand points down, so frames 3 to 5 are level, d6 above the flange, and frame 5 is d5 from
# --- frame 4 along r; the links end at √((|a2| + |a3|)² − h²) before the shoulder, h above it, and d4 beside it.


def farthest_x(height_m: float) -> float:
    """How far along x a flange that points down can be, at a height above the base."""
    h = height_m + 0.0823 - 0.089159
    ahead = 0.09465 + np.sqrt((0.425 + 0.39225) ** 2 - h * h)
    return float(np.hypot(ahead, 0.10915))


LAX = changed(UR5, "reach", min_manipulability_share=0.0, max_step_deg=180.0)


def test_a_grasp_in_reach_takes_the_fingertips_to_three_poses() -> None:
    position = np.array([0.4, 0.2, 0.05])
    answer = asked(UR5, position, Motion(0.1, 0.08, UP, twin=False), Plane(UP, 0.0), tool_m=0.17)
    assert (answer.waypoint, answer.limit, answer.twin) == (None, None, False)
    places, axes = flange(UR5, angles(answer))
    tips = places + 0.17 * axes[:, 2]
    np.testing.assert_allclose(tips, position + np.outer([0.1, 0.0, 0.08], UP), atol=1e-9)
    np.testing.assert_allclose(axes, np.broadcast_to(DOWN, (3, 3, 3)), atol=1e-9)
    assert answer.manipulability is not None
    assert 0.04 * 0.119 < answer.manipulability <= manipulability(UR5.dh, angles(answer)).min() + 1e-12
    assert answer.manipulability_share == pytest.approx(answer.manipulability / max_manipulability(UR5.dh))


def test_out_of_reach_at_the_pre_grasp_pose() -> None:
    answer = asked(UR5, [2.0, 0.0, 0.1], USUAL)
    assert (answer.ok, answer.waypoint, answer.limit) == (False, "pre_grasp", "out of reach")
    assert answer.joints_rad is None
    assert answer.manipulability is None


@pytest.mark.parametrize("height_m", [0.0, 0.2, -0.3])
def test_reach_ends_where_the_links_are_stretched(height_m: float) -> None:
    edge = farthest_x(height_m)
    assert asked(LAX, [edge - 1e-6, 0.0, height_m], STILL).ok
    assert asked(LAX, [edge + 1e-6, 0.0, height_m], STILL).limit == "out of reach"


def test_the_grasp_alone_is_too_far() -> None:
    """From above, the deep end of the approach is the far one: 5 mm too far at the grasp, in reach 2 cm above."""
    x = farthest_x(-0.4) + 0.005
    assert farthest_x(-0.38) > x
    answer = asked(LAX, [x, 0.0, -0.4], USUAL)
    assert (answer.waypoint, answer.limit) == ("grasp", "out of reach")


def test_the_approach_is_named_when_it_fails_on_the_way() -> None:
    x = farthest_x(-0.36) + 0.005
    assert farthest_x(-0.34) > x
    answer = asked(LAX, [x, 0.0, -0.4], USUAL)
    assert (answer.waypoint, answer.limit) == ("approach", "out of reach")


def test_the_lift_alone_fails() -> None:
    x = farthest_x(0.2) - 0.01
    assert farthest_x(0.4) < x
    assert asked(LAX, [x, 0.0, 0.2], STILL).ok
    answer = asked(LAX, [x, 0.0, 0.2], Motion(0.0, 0.2, UP, twin=True))
    assert (answer.waypoint, answer.limit) == ("lift", "out of reach")


def test_the_wrist_must_stay_its_radius_above_the_table() -> None:
    """At the grasp the wrist is d6 = 82.3 mm above the fingertips, its radius 45 mm: the table may be 37.3 mm up."""
    grasp = [0.5, 0.1, 0.2]
    assert asked(UR5, grasp, USUAL, Plane(UP, 0.2 + 0.0372)).ok
    answer = asked(UR5, grasp, USUAL, Plane(UP, 0.2 + 0.0374))
    assert (answer.waypoint, answer.limit) == ("grasp", "below the table")
    assert asked(UR5, grasp, USUAL, Plane(UP, 0.2 + 0.1 + 0.0374)).waypoint == "pre_grasp"


def test_the_elbow_must_stay_above_the_table() -> None:
    """Where the nearest branch to a stance with the elbow down dips below the table, another one is taken."""
    low = changed(UR5, "reach", reference_deg=(0, 20, -90, 0, -90, 0))
    free, held = (asked(low, [-0.55, 0.1, 0.1], USUAL, table) for table in (None, Plane(UP, 0.0)))
    elbows = [forward(UR5.dh, angles(answer))[:, 1, 2, 3].min() for answer in (free, held)]
    assert elbows[0] < 0.06 <= elbows[1]


def within(robot: Robot, joints: FloatArray, margin_deg: float) -> Robot:
    """The robot with its joints held near `joints` (6,), its reference."""
    degrees = np.degrees(joints)
    data = robot.model_dump()
    data["reach"]["reference_deg"] = tuple(degrees)
    data["joints"] |= {"lower_deg": tuple(degrees - margin_deg), "upper_deg": tuple(degrees + margin_deg)}
    return Robot.model_validate(data)


def test_the_elbow_must_stay_its_radius_above_the_table() -> None:
    joints = np.radians([0.0, -10, -60, -20, -90, 0])  # the elbow is the lowest of all
    robot, (position, axes) = within(UR5, joints, 30.0), flange(UR5, joints)
    height = forward(UR5.dh, joints)[1:5, 2, 3]
    assert height[0] + 0.02 < height[1:].min()
    assert asked(robot, position, STILL, Plane(UP, height[0] - 0.0601), axes).ok
    assert asked(robot, position, STILL, Plane(UP, height[0] - 0.0599), axes).limit == "below the table"


def test_too_little_manipulability() -> None:
    """10 µm short of stretched sin q3 is √(2·0.817·10⁻⁵/0.1667) = 0.0099 and the share near 1 %, 4 % being required."""
    answer = asked(UR5, [farthest_x(0.1) - 1e-5, 0.0, 0.1], STILL)
    assert (answer.waypoint, answer.limit) == ("pre_grasp", "manipulability")


def test_too_large_a_step() -> None:
    slow = changed(UR5, "reach", max_step_deg=0.5)
    answer = asked(slow, [0.5, 0.1, 0.1], USUAL)
    assert (answer.waypoint, answer.limit) == ("approach", "joint step")


def test_a_joint_limit() -> None:
    """With the pan held in a quarter turn about zero, where the arm looks along −x, it cannot look along +x."""
    held = changed(UR5, "joints", lower_deg=(-45, -90, -180, -360, -360, -360), upper_deg=(45, 0, 180, 360, 360, 360))
    assert asked(held, [-0.5, 0.0, 0.1], USUAL).ok
    answer = asked(held, [0.5, 0.0, 0.1], USUAL)
    assert (answer.waypoint, answer.limit) == ("pre_grasp", "joint limit")


def test_the_twin_is_taken_where_it_alone_is_within_limits() -> None:
    plain = asked(UR5, [0.5, 0.1, 0.1], USUAL)
    stance = np.degrees(angles(plain)[1])
    held = within(UR5, np.radians([*stance[:5], stance[5] + 180]), 60.0)
    refused = asked(held, [0.5, 0.1, 0.1], USUAL)
    assert (refused.ok, refused.limit, refused.twin) == (False, "joint limit", False)
    answer = asked(held, [0.5, 0.1, 0.1], Motion(0.1, 0.1, UP, twin=True))
    assert answer.ok
    assert answer.twin
    _, axes = flange(UR5, angles(answer)[1])
    np.testing.assert_allclose(axes, DOWN * np.array([[-1], [-1], [1]]), atol=1e-9)


def test_the_hand_itself_goes_before_a_twin_farther_from_the_reference() -> None:
    plain = asked(UR5, [0.5, 0.1, 0.1], USUAL)
    near = changed(UR5, "reach", reference_deg=tuple(np.degrees(angles(plain)[1])))
    assert not asked(near, [0.5, 0.1, 0.1], Motion(0.1, 0.1, UP, twin=True)).twin


@pytest.mark.parametrize("turns", [-1, 0])
def test_whole_turns_are_chosen_near_the_reference(turns: int) -> None:
    plain = asked(UR5, [0.5, 0.1, 0.1], USUAL)
    joints = angles(plain)[1].copy()
    joints[5] = joints[5] % (2 * np.pi) + 2 * np.pi * turns
    answer = asked(changed(UR5, "reach", reference_deg=tuple(np.degrees(joints))), [0.5, 0.1, 0.1], USUAL)
    np.testing.assert_allclose(angles(answer)[1], joints, atol=1e-6)
    assert not answer.twin  # a whole turn makes no twin


def test_the_branch_nearest_to_the_reference_is_taken() -> None:
    position, axes = flange(UR5, np.array([0.3, -1.2, 1.4, -0.9, -1.3, 0.4]))
    branches = inverse(UR5.dh, position[None], axes[None])[0]
    assert exists(branches).all()
    for joints in branches:
        robot = changed(LAX, "reach", reference_deg=tuple(np.degrees(joints)))
        np.testing.assert_allclose(angles(asked(robot, position, STILL, axes=axes))[1], joints, atol=1e-9)


def test_the_nearest_turn_beyond_a_limit_is_not_taken() -> None:
    """The last joint stands at 350° and is wanted at 20°: 380° would be nearest, but the limit is 360°."""
    stance, joints = np.radians([[20, -70, 80, -50, -80, 350], [20, -70, 80, -50, -80, 20]])
    position, axes = flange(UR5, joints)
    robot = within(UR5, stance, 20.0)
    lower, upper = robot.joints.lower_deg[:5], robot.joints.upper_deg[:5]
    robot = changed(robot, "joints", lower_deg=(*lower, -360), upper_deg=(*upper, 360))
    np.testing.assert_allclose(angles(asked(robot, position, STILL, axes=axes))[1], joints, atol=1e-9)


def test_a_joint_may_stand_at_its_very_limit() -> None:
    """The angles that inverse kinematics gives are off by rounding, to either side."""
    for joints in np.radians([20, -70, 80, -50, -80, 30]) + random_joints(50) / 20:
        position, axes = flange(UR5, joints)
        robot = within(UR5, joints, 20.0)
        held = changed(robot, "joints", upper_deg=tuple(np.degrees(joints)))
        np.testing.assert_allclose(angles(asked(held, position, STILL, axes=axes))[1], joints, atol=1e-9)


def test_joints_run_on_through_half_a_turn() -> None:
    """All around the base with a lift sideways: somewhere the pan passes ±180°, and nowhere does a joint jump."""
    looks_ahead = changed(UR5, "reach", reference_deg=(180, -90, 90, -90, -90, 0))
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    positions = np.column_stack([0.5 * np.cos(angle), 0.5 * np.sin(angle), np.full(200, 0.2)])
    motion = Motion(0.1, 0.1, np.array([0.0, 1.0, 0.0]), twin=True)
    answers = reach(looks_ahead, positions, np.broadcast_to(DOWN, (200, 3, 3)), motion)
    joints = np.array([answer.joints_rad for answer in answers if answer.joints_rad is not None])
    assert len(joints) > 150
    assert np.abs(np.diff(joints, axis=1)).max() < np.radians(5 * 20)
    first, last = joints[:, 0, 0], joints[:, 2, 0]
    assert ((first - np.pi) * (last - np.pi) < 0).any()


def test_base_link_is_the_base_turned_by_half() -> None:
    turned = UR5.model_copy(update={"base_frame": "base_link"})
    points = np.array([[0.4, 0.2, 0.1], [-0.3, 0.3, 0.2]])
    np.testing.assert_array_equal(in_dh_base("base_link", points), [[-0.4, -0.2, 0.1], [0.3, -0.3, 0.2]])
    np.testing.assert_array_equal(in_dh_base("base_link", in_dh_base("base_link", points)), points)
    np.testing.assert_array_equal(in_dh_base("base", points), points)
    sideways, table = np.array([0.6, 0.0, 0.8]), np.array([1.0, 0.0, 0.0])
    half = np.diag([-1.0, -1.0, 1.0])
    here = asked(UR5, [0.4, 0.2, 0.1], Motion(0.1, 0.1, sideways, twin=False), Plane(table, -0.1))
    there = asked(
        turned, [-0.4, -0.2, 0.1], Motion(0.1, 0.1, half @ sideways, twin=False), Plane(half @ table, -0.1), DOWN @ half
    )
    np.testing.assert_allclose(angles(here), angles(there), atol=1e-9)
    unturned = asked(turned, [0.4, 0.2, 0.1], Motion(0.1, 0.1, sideways, twin=False))
    assert apart(angles(unturned), angles(here)).max() > 0.5


def random_grasps(count: int, seed: int) -> tuple[FloatArray, FloatArray]:
    """The flange's places (count, 3) and axes (count, 3, 3), behind hands 5 to 20 cm long that come from above."""
    rng = np.random.default_rng(seed)
    z = np.array([0.0, 0.0, -1.0]) + rng.uniform(-0.6, 0.6, (count, 3))
    x = np.cross(rng.normal(size=(count, 3)), z)
    x, z = (each / np.linalg.norm(each, axis=1, keepdims=True) for each in (x, z))
    positions = rng.uniform([-0.8, -0.8, -0.1], [0.8, 0.8, 0.4], (count, 3))
    return positions - rng.uniform(0.05, 0.2, (count, 1)) * z, np.stack([x, np.cross(z, x), z], axis=1)


def goes_by_trial(robot: Robot, waypoints: FloatArray, axes: FloatArray, table: Plane) -> bool:
    """The reach test one branch, one waypoint and one turn of each joint at a time."""
    lower, upper = np.radians(robot.joints.lower_deg), np.radians(robot.joints.upper_deg)
    solutions = inverse(robot.dh, waypoints, np.broadcast_to(axes, (len(waypoints), 3, 3)))
    for path in np.moveaxis(solutions, 1, 0):
        if not exists(path).all() or np.max(apart(path[1:], path[:-1])) > np.radians(robot.reach.max_step_deg):
            continue
        joints = np.unwrap(path, axis=0)
        turns = 2 * np.pi * np.arange(-3, 4)[:, None, None]
        within = ((joints + turns >= lower) & (joints + turns <= upper)).all(axis=1).any(axis=0)
        ability = manipulability(robot.dh, joints).min() / max_manipulability(robot.dh)
        height = forward(robot.dh, joints)[:, 1:5, :3, 3] @ table.normal - table.offset_m
        clear = (height >= [robot.links.elbow_m, *[robot.links.wrist_m] * 3]).all()
        if within.all() and ability >= robot.reach.min_manipulability_share and clear:
            return True
    return False


def test_reach_agrees_with_trying_branch_by_branch() -> None:
    robot = changed(
        UR5, "joints", lower_deg=(-150, -200, -150, -300, -360, -170), upper_deg=(150, 20, 150, 100, 360, 100)
    )
    robot = changed(robot, "reach", max_step_deg=8.0, min_manipulability_share=0.15)
    tilted = Plane(np.array([0.1, 0.0, np.sqrt(0.99)]), 0.02)
    positions, axes = random_grasps(400, seed=5)
    lift = np.array([0.0, 0.6, 0.8])
    answers = reach(robot, positions, axes, Motion(0.1, 0.12, lift, twin=False), tilted)
    share = np.linspace(0, 1, 6)[:, None]
    for k, answer in enumerate(answers):
        before = positions[k] - (1 - share) * 0.1 * axes[k, 2]
        waypoints = np.vstack([before, positions[k] + share[1:] * 0.12 * lift])
        assert answer.ok == goes_by_trial(robot, waypoints, axes[k], tilted)
    assert 50 < sum(answer.ok for answer in answers) < 350
    limits = {answer.limit for answer in answers}
    assert limits >= {"out of reach", "joint limit", "joint step", "manipulability", "below the table"}


def test_answers_do_not_depend_on_their_neighbours() -> None:
    positions, axes = random_grasps(BATCH + 20, seed=6)
    motion, table = Motion(0.1, 0.1, UP, twin=True), Plane(UP, 0.0)
    together = reach(UR5, positions, axes, motion, table)
    assert len(together) == BATCH + 20
    for k in (0, 7, BATCH - 1, BATCH, BATCH + 19):
        (alone,) = reach(UR5, positions[k : k + 1], axes[k : k + 1], motion, table)
        assert (alone.ok, alone.waypoint, alone.limit) == (together[k].ok, together[k].waypoint, together[k].limit)
        if alone.ok:
            np.testing.assert_allclose(angles(alone), angles(together[k]), atol=1e-9)
    assert reach(UR5, np.empty((0, 3)), np.empty((0, 3, 3)), motion) == ()


# --- profiles


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_reaches_a_grasp_before_it(name: str) -> None:
    robot = load_robot(name)
    assert asked(robot, [-0.6 * robot.reach_m, 0.0, 0.1], Motion(0.1, 0.1, UP, twin=True), Plane(UP, 0.0), DOWN, 0.1).ok


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("alpha_deg: [90, 0, 0, 90, -90, 0]", "alpha_deg: [90, 0, 90, 90, -90, 0]", "only arms of the UR family"),
        ("a_m: [0.0, -0.425", "a_m: [0.1, -0.425", "only arms of the UR family"),
        ("a_m: [0.0, -0.425", "a_m: [0.0, 0.0", "0.01 m at least"),
        ("reference_deg: [0, -90, 90", "reference_deg: [0, -90, 190", "within its joint's limits"),
    ],
    ids=["twist", "offset", "no link", "reference"],
)
def test_an_arm_that_the_formulas_do_not_fit_is_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    path, text = tmp_path / "arm.yaml", profile_path("robot", "ur5").read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ProfileError, match=words):
        load_robot(str(path))
