"""What an arm reaches, and what stops it: places worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flatgrasp_cli import load_robot
from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.profiles import profile_path
from flatgrasp_cli.profiles.robot import Robot
from flatgrasp_cli.robot import (
    Motion,
    Plane,
    arm_of,
    forward,
    in_dh_base,
    inverse,
    is_too_far,
    manipulability,
    max_manipulability,
    reach,
)
from tests.robot.arms import (
    DOWN,
    LAX,
    ROBOTS,
    STILL,
    UP,
    UR5,
    USUAL,
    angles,
    apart,
    asked,
    changed,
    exists,
    farthest_x,
    flange,
    random_joints,
    rows,
)


def test_a_grasp_in_reach_takes_the_fingertips_to_three_poses() -> None:
    position = np.array([0.4, 0.2, 0.05])
    answer = asked(UR5, position, Motion(0.1, 0.08, UP, twin=False), Plane(UP, 0.0), tool_m=0.17)
    assert (answer.waypoint, answer.limit, answer.twin) == (None, None, False)
    places, axes = flange(UR5, angles(answer))
    tips = places + 0.17 * axes[:, 2]
    np.testing.assert_allclose(tips, position + np.outer([0.1, 0.0, 0.08], UP), atol=1e-9)
    np.testing.assert_allclose(axes, np.broadcast_to(DOWN, (3, 3, 3)), atol=1e-9)
    assert answer.manipulability is not None
    assert 0.04 * 0.119 < answer.manipulability <= manipulability(rows(UR5), angles(answer)).min() + 1e-12
    assert answer.manipulability_share == pytest.approx(answer.manipulability / max_manipulability(rows(UR5)))


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


@pytest.mark.parametrize("name", ROBOTS)
def test_no_pose_takes_the_flange_farther_than_the_links_stretched(name: str) -> None:
    robot = load_robot(name)
    joints = random_joints(20_000)
    joints[:, 2] *= 0.02  # nearly stretched elbows
    far = np.linalg.norm(flange(robot, joints)[0] - arm_of(robot).shoulder, axis=1)
    assert 0.9 * arm_of(robot).span_m < far.max() <= arm_of(robot).span_m


def test_what_no_place_in_reach_is_near_is_too_far() -> None:
    span = arm_of(UR5).span_m
    ends = np.array([[0.0, 0.0, 0.1], [0.0, 0.2, 0.1], [0.0, 0.1, 0.0892]])  # a ball of 0.1 m, as high as the shoulder
    for base in (UR5, UR5.model_copy(update={"base_frame": "base_link"})):
        assert not is_too_far(base, ends + np.array([span + 0.09, -0.1, 0.0]))
        assert is_too_far(base, ends + np.array([span + 0.12, -0.1, 0.0]))


@pytest.mark.parametrize("name", ["ur5", "franka_fr3"])
def test_what_is_told_by_the_distance_alone_is_what_the_kinematics_say(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if load_robot(name).chain is not None:
        pytest.importorskip("eaik")
    robot, rng = load_robot(name), np.random.default_rng(0)
    positions, axes = rng.uniform(-1.0, 1.0, (40, 3)), np.broadcast_to(DOWN, (40, 3, 3))
    quick = reach(robot, positions, axes, USUAL)
    too_far = np.linalg.norm(positions + 0.1 * UP - arm_of(robot).shoulder, axis=1) > arm_of(robot).span_m
    assert 10 < np.count_nonzero(too_far) < 30
    monkeypatch.setattr(arm_of(robot), "span_m", np.inf)
    for one, other in zip(quick, reach(robot, positions, axes, USUAL), strict=True):
        assert (one.ok, one.waypoint, one.limit) == (other.ok, other.waypoint, other.limit)
        assert one.joints_rad is None or one.joints_rad == pytest.approx(other.joints_rad)


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
    elbows = [forward(rows(UR5), angles(answer))[:, 1, 2, 3].min() for answer in (free, held)]
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
    height = forward(rows(UR5), joints)[1:5, 2, 3]
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
    branches = inverse(rows(UR5), position[None], axes[None])[0]
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


def test_a_hand_that_goes_back_first_needs_to_reach_its_lift_from_there() -> None:
    """Straight up from the grasp the arm would have to be longer; back at the pre-grasp pose it is long enough."""
    out = axes_from_quaternion(np.array([0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]))  # along x
    far = Motion(0.15, 0.2, UP, twin=False)
    positions = np.array([[0.65, 0.1, 0.6]])
    (up,) = reach(UR5, positions, out[None], far)
    (back,) = reach(UR5, positions, out[None], replace(far, back_first=True))
    assert (up.ok, up.waypoint) == (False, "lift")
    assert back.ok
    assert back.joints_rad is not None
    assert len(back.joints_rad) == 3
