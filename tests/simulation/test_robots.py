"""Hands and arms of the simulation are those of their profiles."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, load_robot
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Pose
from flatgrasp_cli.profiles import list_profiles
from flatgrasp_cli.robot import forward, in_dh_base
from flatgrasp_cli.simulation.arm import Arm
from flatgrasp_cli.simulation.carriers import Floating, missed, palm_at
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.hands import hand_of
from flatgrasp_cli.simulation.looking import spot_of
from flatgrasp_cli.simulation.parts import Kind, Pads
from flatgrasp_cli.simulation.solids import box, ellipsoid, joined, rod
from flatgrasp_cli.simulation.things import Thing
from flatgrasp_cli.simulation.world import World
from tests.robot.arms import ROBOTS, rows

DOWN = np.array([1.0, 0.0, 0.0, 0.0])
"""The palm's z axis points down, as a quaternion [x, y, z, w]."""
UP = Pose(np.array([0.0, 0.0, 0.5]), DOWN)
GRIPPERS = list_profiles("gripper")


def floating(gripper: str, *things: Thing, force_n: float = 40.0, friction: float = 0.5) -> World:
    world = World(things, Floating(), hand_of(load_gripper(gripper), Pads(friction, force_n)))
    world.reset(world.carrier.controls([UP])[0], load_gripper(gripper).max_opening_m)
    return world


def block(size: tuple[float, float, float], mass_kg: float = 0.3) -> Thing:
    solid = box(size, (0, 0, 0))
    return Thing("block", solid.surface, solid.pieces, mass_kg)


def finger_boxes(world: World) -> tuple[FloatArray, FloatArray]:
    """Centres (n, 3) of the fingers in the palm's frame, and their half sizes (n, 3)."""
    fingers = world.model.geom_group == Kind.FINGER
    palm, turn = world.palm()
    return turn.inv().apply(world.data.geom_xpos[fingers] - palm), world.model.geom_size[fingers]


SHORT_M = {"underactuated": 6e-3}
"""How far the tips of fingers that turn about pins may be short of the profile's, which has them on a straight line."""


@pytest.mark.parametrize("share", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("name", GRIPPERS)
def test_a_hand_opens_as_its_profile_says(name: str, share: float) -> None:
    gripper, world = load_gripper(name), floating(name)
    opening = gripper.min_opening_m + share * (gripper.max_opening_m - gripper.min_opening_m)
    world.place(world.carrier.controls([UP])[0], opening)
    world.follow(world.carrier.controls([UP]), 0.3)
    centers, half = finger_boxes(world)
    outer = centers[:, 2] > 0.5 * centers[:, 2].max()  # of two phalanges, the distal one
    centers, half = centers[outer], half[outer]
    inner = np.abs(centers[:, 1]) - half[:, 1]
    assert inner == pytest.approx(opening / 2, abs=3e-4)
    assert len(centers) == sum(len(jaw) for jaw in gripper.jaws)
    for jaw, side in zip(gripper.jaws, (-1, 1), strict=True):
        there = np.sign(centers[:, 1]) == side
        assert sorted(centers[there, 0]) == pytest.approx(sorted(jaw), abs=1e-4)
    tips, length = centers[:, 2] + half[:, 2], gripper.finger_length_at_m(opening)
    assert tips.max() < length + 3e-4
    assert tips.min() > length - SHORT_M.get(gripper.kind, 3e-4)
    assert world.hand.reach_m(world.model, world.data) == pytest.approx(tips.mean(), abs=3e-4)
    assert 2 * half[:, 0] == pytest.approx(gripper.finger_width_m)


def closed_on(world: World, center: FloatArray, opening_m: float, tips_m: float) -> FloatArray:
    """Close on a thing whose frame is at `center` and that nothing pulls down, the fingertips ending at a height.

    Returns the controls (1, k) that keep the hand there.
    """
    world.model.body_gravcomp[world.model.body("thing0").id] = 1.0
    palm = tips_m + world.hand.reach_m(world.model, world.data)
    (control,) = world.carrier.controls([Pose(np.array([0.0, 0.0, palm]), DOWN)])
    world.place(control, opening_m)
    world.put(0, center, Rotation.identity())
    world.follow(control[None], 0.8, (world.hand.control(opening_m), world.hand.closed))
    world.follow(control[None], 0.4)
    return np.asarray(control[None])


def pressing(world: World) -> dict[str, float]:
    """The normal force on the thing of each body of the hand that touches it, newtons."""
    found: dict[str, float] = {}
    for number, contact in enumerate(world.data.contact):
        kinds = world.model.geom_group[contact.geom]
        if {Kind.FINGER, Kind.THING} == set(kinds.tolist()):
            wrench = np.zeros(6)
            load_mujoco().mj_contactForce(world.model, world.data, number, wrench)
            finger = int(contact.geom[int(np.argmax(kinds == Kind.FINGER))])
            name = world.model.body(world.model.geom_bodyid[finger]).name
            found[name] = found.get(name, 0.0) + float(wrench[0])
    return found


@pytest.mark.parametrize("name", ["pr2", "wsg_50"])
def test_jaws_press_with_their_force_and_stay_in_the_middle(name: str) -> None:
    world = floating(name, block((0.04, 0.03, 0.04)), force_n=30.0)
    closed_on(world, np.array([0.0, -0.002, 0.12]), opening_m=0.06, tips_m=0.11)
    assert list(pressing(world).values()) == pytest.approx([30.0, 30.0], rel=0.02)
    assert world.pose(0)[0][1] == pytest.approx(0.0, abs=5e-4)  # it was pushed to the hand's middle


@pytest.mark.parametrize(("friction", "level"), [(0.44, True), (0.34, False)])
def test_pads_bear_torsion_in_proportion_to_their_friction(friction: float, level: bool) -> None:
    """Two points bear 0.4 N m · μ: twice 40 N at 5 mm. A load of 0.2 kg at 80 mm asks for 0.16 N m."""
    ball, load = ellipsoid((0.02, 0.02, 0.02), (0, 0, 0)), box((0.03, 0.03, 0.03), (0.08, 0, 0))
    thing = Thing("loaded", joined([ball.surface, load.surface]), (*ball.pieces, *load.pieces), 0.45)
    world = floating("pr2", thing, friction=friction)
    control = closed_on(world, np.array([0.0, 0.0, 0.12]), opening_m=0.06, tips_m=0.11)
    world.model.body_gravcomp[world.model.body("thing0").id] = 0.0
    world.follow(control, 0.5)
    _, turned = world.pose(0)
    assert (turned.magnitude() < np.radians(5)) == level


def turn(world: World, finger: str) -> float:
    """How far a finger's distal phalanx is turned in against the palm, radians."""
    joints = (world.model.joint(f"{finger}.{part}").qposadr[0] for part in ("proximal", "distal"))
    return float(sum(world.data.qpos[joint] for joint in joints))


def test_adaptive_fingers_pinch_what_they_touch_with_their_ends() -> None:
    world = floating("lacquey", block((0.08, 0.03, 0.02)), force_n=30.0)
    closed_on(world, np.array([0.0, 0.0, 0.12]), opening_m=0.06, tips_m=0.115)
    found = pressing(world)
    assert set(found) == {"finger00.distal", "finger10.distal", "finger11.distal"}
    assert all(abs(turn(world, finger)) < 0.03 for finger in ("finger00", "finger10", "finger11"))
    thumb, pair = found["finger00.distal"], found["finger10.distal"] + found["finger11.distal"]
    assert thumb == pytest.approx(pair, rel=0.05)  # the thumb has as much as the pair has together
    assert 0.7 * 30 < thumb < 1.05 * 30  # springs and friction take their share


def test_adaptive_fingers_wrap_what_they_touch_near_their_distal_pins() -> None:
    """The middle of a bar lies 5 mm above the distal pins, which are 45 mm above the fingertips."""
    bar = rod(0.020, 0.1, (0, 0, 0))
    world = floating("lacquey", Thing("bar", bar.surface, bar.pieces, 0.4))
    closed_on(world, np.array([0.0, 0.0, 0.150]), opening_m=0.10, tips_m=0.10)
    assert all(turn(world, finger) > 0.5 for finger in ("finger00", "finger10", "finger11"))
    assert {name.partition(".")[2] for name in pressing(world)} == {"proximal", "distal"}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("base", ["base", "base_link"])
def test_an_arm_is_where_its_rows_say_and_goes_where_it_is_told(name: str, base: str) -> None:
    robot = load_robot(name).model_copy(update={"base_frame": base})
    gripper = load_gripper("pr2").model_copy(update={"mounted_deg": 40.0})
    world = World([], Arm(robot, gripper), hand_of(gripper, Pads(0.5, 40.0)))
    start = np.radians(robot.reach.reference_deg) + np.array([0.3, 0.2, 0.1, -0.2, 0.3, 0.4])
    world.reset(start, 0.05)
    palm, turn = world.palm()
    flange = forward(rows(robot), start)[5]
    axes = in_dh_base(robot.base_frame, flange[:3, :3].T)
    place = in_dh_base(robot.base_frame, flange[:3, 3]) + gripper.palm_offset_m * axes[2]
    assert palm == pytest.approx(place, abs=1e-9)
    assert turn.as_matrix()[:, 2] == pytest.approx(axes[2], abs=1e-9)
    c, s = np.cos(np.radians(40)), np.sin(np.radians(40))
    assert turn.as_matrix()[:, 0] == pytest.approx(c * axes[0] + s * axes[1], abs=1e-9)
    pose = Pose(palm + np.array([0.0, 0.0, 0.05]), turn.as_quat())
    way = world.carrier.controls([Pose(palm, turn.as_quat()), pose])
    assert way[0] == pytest.approx(start, abs=1e-9)
    assert world.carrier.seconds(way) > 0
    world.follow(way, 1.0)
    assert world.palm()[0] == pytest.approx(pose.position, abs=2e-3)
    world.follow(way[-1:], 0.3)
    assert world.palm()[0] == pytest.approx(pose.position, abs=1e-4)
    far = Pose(np.array([9.0, 0.0, 0.0]), DOWN)
    assert np.isnan(world.carrier.controls([pose, far])).all(axis=1).tolist() == [False, True]


def test_a_weak_arm_lets_what_is_heavy_sink() -> None:
    """Servos give no more than the profile's torques."""
    robot = load_robot("ur5")
    weak = robot.model_copy(update={"joints": robot.joints.model_copy(update={"max_effort_nm": (1.0,) * 6})})
    sunk = []
    for arm in (robot, weak):
        gripper = load_gripper("pr2")
        world = World([], Arm(arm, gripper), hand_of(gripper, Pads(0.5, 40.0)))
        world.model.body_gravcomp[world.model.body("hand").id] = 0.0  # a kilogram that nothing compensates
        control = np.radians(robot.reach.reference_deg)
        world.reset(control, 0.05)
        before = world.palm()[0][2]
        world.follow(control[None], 0.2)
        sunk.append(before - world.palm()[0][2])
    assert sunk[0] < 1e-3
    assert sunk[1] > 0.01


def test_a_hand_that_misses_is_off_in_its_own_plane() -> None:
    tips = Pose(np.array([1.0, 2.0, 3.0]), DOWN)
    off = missed(tips, np.array([0.01, 0.02]), np.pi / 2)
    assert off.position == pytest.approx([1.01, 1.98, 3.0])  # its y axis is the world's −y
    assert missed(tips, np.zeros(2), 0.0).orientation == pytest.approx(DOWN)
    assert abs(off.orientation @ DOWN) == pytest.approx(np.cos(np.pi / 4))
    assert palm_at(tips, 0.06).position == pytest.approx([1.0, 2.0, 3.06])


def test_what_the_engine_refuses_is_an_error_in_words() -> None:
    with pytest.raises(UsageError, match=r"MuJoCo cannot simulate this: .*mass"):
        floating("pr2", block((0.04, 0.03, 0.04), mass_kg=1e-30))


def test_an_arm_of_another_make_is_refused() -> None:
    with pytest.raises(UsageError, match="simulate knows arms of the UR family alone"):
        spot_of(load_robot("xarm6"))
