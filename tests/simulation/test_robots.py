"""Hands and arms of the simulation are those of their profiles."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_robot
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Pose
from flatgrasp_cli.profiles import list_profiles
from flatgrasp_cli.robot import forward, in_dh_base
from flatgrasp_cli.simulation.arm import Arm
from flatgrasp_cli.simulation.carriers import Floating, missed, palm_at
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.jaws import Jaws
from flatgrasp_cli.simulation.parts import Kind, Pads
from flatgrasp_cli.simulation.solids import box
from flatgrasp_cli.simulation.things import Thing
from flatgrasp_cli.simulation.world import World

DOWN = np.array([1.0, 0.0, 0.0, 0.0])
"""The palm's z axis points down, as a quaternion [x, y, z, w]."""
UP = Pose(np.array([0.0, 0.0, 0.5]), DOWN)
GRIPPERS = list_profiles("gripper")


def floating(gripper: str, *things: Thing, force_n: float = 40.0) -> World:
    world = World(things, Floating(), Jaws(load_gripper(gripper), Pads(0.5, force_n)))
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


@pytest.mark.parametrize("share", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("name", GRIPPERS)
def test_a_hand_opens_as_its_profile_says(name: str, share: float) -> None:
    gripper, world = load_gripper(name), floating(name)
    opening = gripper.min_opening_m + share * (gripper.max_opening_m - gripper.min_opening_m)
    world.place(world.carrier.controls([UP])[0], opening)
    world.follow(world.carrier.controls([UP]), 0.3)
    centers, half = finger_boxes(world)
    inner = np.abs(centers[:, 1]) - half[:, 1]
    assert inner == pytest.approx(opening / 2, abs=2e-4)
    assert len(centers) == sum(len(jaw) for jaw in gripper.jaws)
    for jaw, side in zip(gripper.jaws, (-1, 1), strict=True):
        there = np.sign(centers[:, 1]) == side
        assert sorted(centers[there, 0]) == pytest.approx(sorted(jaw), abs=1e-4)
    tips = centers[:, 2] + half[:, 2]
    assert tips == pytest.approx(gripper.finger_length_at_m(opening), abs=2e-4)
    assert world.hand.reach_m(world.model, world.data) == pytest.approx(gripper.finger_length_at_m(opening), abs=2e-4)
    assert 2 * half[:, 0] == pytest.approx(gripper.finger_width_m)


@pytest.mark.parametrize("name", ["pr2", "wsg_50"])
def test_jaws_press_with_their_force_and_stay_in_the_middle(name: str) -> None:
    world = floating(name, block((0.04, 0.03, 0.04)), force_n=30.0)
    length = load_gripper(name).finger_length_at_m(0.03)
    pose = Pose(np.array([0.0, 0.002, length + 0.01]), DOWN)
    (control,) = world.carrier.controls([pose])
    world.place(control, 0.06)
    world.put(0, np.array([0.0, 0.0, 0.02]), world.pose(0)[1])
    world.follow(control[None], 0.6, (world.hand.control(0.06), world.hand.closed))
    world.follow(control[None], 0.3)
    forces = {1: 0.0, -1: 0.0}
    for number, contact in enumerate(world.data.contact):
        kinds = world.model.geom_group[contact.geom]
        if set(kinds) == {Kind.FINGER, Kind.THING}:
            wrench = np.zeros(6)
            load_mujoco().mj_contactForce(world.model, world.data, number, wrench)
            finger = contact.geom[int(np.argmax(kinds == Kind.FINGER))]
            forces[int(np.sign(world.data.geom_xpos[finger, 1] - world.pose(0)[0][1]))] += wrench[0]
    assert list(forces.values()) == pytest.approx([30.0, 30.0], rel=0.05)
    assert world.pose(0)[0][1] == pytest.approx(0.002, abs=5e-4)  # it was pushed to the hand's middle


@pytest.mark.parametrize("name", list_profiles("robot"))
@pytest.mark.parametrize("base", ["base", "base_link"])
def test_an_arm_is_where_its_rows_say_and_goes_where_it_is_told(name: str, base: str) -> None:
    robot = load_robot(name).model_copy(update={"base_frame": base})
    gripper = load_gripper("pr2").model_copy(update={"mounted_deg": 40.0})
    world = World([], Arm(robot, gripper), Jaws(gripper, Pads(0.5, 40.0)))
    start = np.radians(robot.reach.reference_deg) + np.array([0.3, 0.2, 0.1, -0.2, 0.3, 0.4])
    world.reset(start, 0.05)
    palm, turn = world.palm()
    flange = forward(robot.dh, start)[5]
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
        world = World([], Arm(arm, gripper), Jaws(gripper, Pads(0.5, 40.0)))
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
