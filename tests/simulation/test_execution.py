"""A grasp is held, lost for a reason, or a collision with a name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, load_robot
from flatgrasp_cli.model import Pose
from flatgrasp_cli.simulation.arm import Arm
from flatgrasp_cli.simulation.carriers import Floating
from flatgrasp_cli.simulation.execution import OUT_OF_REACH, UNSTABLE, Order, execute
from flatgrasp_cli.simulation.hands import hand_of
from flatgrasp_cli.simulation.parts import Pads
from flatgrasp_cli.simulation.solids import box, rod
from flatgrasp_cli.simulation.things import Thing
from flatgrasp_cli.simulation.transit import go_to
from flatgrasp_cli.simulation.world import World

PR2 = load_gripper("pr2")
SIZE = (0.06, 0.04, 0.05)
DOWN = np.array([1.0, 0.0, 0.0, 0.0])


def block(mass_kg: float = 0.3, size: tuple[float, float, float] = SIZE) -> Thing:
    solid = box(size, (0, 0, 0))
    return Thing("block", solid.surface, solid.pieces, mass_kg)


def order(tips_m: float = 0.015, y: float = 0.0, opening_m: float = 0.08, x: float = 0.0) -> Order:
    """A grasp of the block from above with the fingertips so far above the table, `x` and `y` off its middle."""
    grasp = np.array([x, y, tips_m + PR2.finger_length_at_m(SIZE[1])])
    up = np.array([0.0, 0.0, 0.1])
    return Order(Pose(grasp + up, DOWN), Pose(grasp, DOWN), Pose(grasp + up, DOWN), opening_m)


def scene(*things: Thing, friction: float = 0.5, force_n: float = 40.0) -> World:
    """Blocks in a row along x, 20 cm apart, the first at the origin."""
    world = World(things, Floating(), hand_of(PR2, Pads(friction, force_n)))
    world.reset(world.carrier.controls([order().pre_grasp])[0], 0.08)
    for number in range(len(things)):
        world.put(number, np.array([0.2 * number, 0.0, SIZE[2] / 2]), Rotation.identity())
    world.settle(0.5)
    return world


def ready(world: World, wanted: Order) -> World:
    assert go_to(world, wanted, np.zeros(7), None) is None
    return world


def test_a_block_is_held_and_nothing_was_touched() -> None:
    done = execute(ready(scene(block()), order()), order())
    assert (done.status, done.clean, done.reason, done.thing) == ("held", True, None, 0)
    assert done.lifted_m == pytest.approx(0.1, abs=3e-3)
    assert done.pushed_m < 1e-4


def test_without_friction_it_is_lost_for_not_being_lifted() -> None:
    done = execute(ready(scene(block(), friction=0.01), order()), order())
    assert (done.status, done.clean, done.reason) == ("lost", True, "the object was not lifted")
    assert done.thing is None


@pytest.mark.parametrize(("mass_kg", "status"), [(3.0, "held"), (4.4, "lost")])
def test_friction_bears_twice_its_coefficient_times_the_force(mass_kg: float, status: str) -> None:
    """2 μ N = 40 N are the weight of 4.1 kg; being shaken takes a part of that."""
    assert execute(ready(scene(block(mass_kg)), order()), order()).status == status


def test_what_slips_out_in_the_shaking_was_lifted_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("flatgrasp_cli.simulation.execution.SHAKE_M", 0.06)
    monkeypatch.setattr("flatgrasp_cli.simulation.execution.SHAKE_HZ", (8.0, 9.0))
    done = execute(ready(scene(block(2.5)), order()), order())
    assert (done.status, done.reason) == ("lost", "the object slipped out when it was shaken")


def test_fingers_that_come_down_on_the_object_run_into_it() -> None:
    done = execute(ready(scene(block()), order(y=0.035)), order(y=0.035))
    assert (done.status, done.clean) == ("collision", False)
    assert done.reason == "the fingers ran into the object on the way to the grasp"


def test_fingers_that_go_too_deep_touch_the_table() -> None:
    done = execute(ready(scene(block()), order(tips_m=-0.012)), order(tips_m=-0.012))
    assert done.status == "collision"
    assert done.reason == "the fingers touched the table on the way to the grasp"


def test_a_palm_that_comes_down_on_the_object_touches_it() -> None:
    tall = block(size=(0.06, 0.04, 0.05 + 0.0749 - 0.015))
    world = scene(tall)
    world.put(0, np.array([0.0, 0.0, 0.055]), Rotation.identity())
    done = execute(ready(world, order(tips_m=0.005)), order(tips_m=0.005))
    assert (done.status, done.reason) == ("collision", "the palm touched the object on the way to the grasp")


def test_what_is_brushed_may_be_held_but_not_cleanly() -> None:
    """The inner edge of one finger comes down 1.5 mm within the flank of a round bar, and pushes it aside."""
    bar = rod(0.02, 0.1, (0, 0, 0))
    world = scene(Thing("bar", bar.surface, bar.pieces, 0.3))
    world.put(0, np.array([0.0, 0.0, 0.02]), Rotation.identity())
    brushing = order(tips_m=0.01, y=0.0215)
    done = execute(ready(world, brushing), brushing)
    assert (done.status, done.clean) == ("held", False)
    assert 1e-4 < done.pushed_m < 5e-3


def test_of_several_things_the_one_between_the_fingers_is_held() -> None:
    wanted = order(x=0.2)
    done = execute(ready(scene(block(), block(), block()), wanted), wanted)
    assert (done.status, done.thing) == ("held", 1)


def test_a_pre_grasp_inside_the_object_is_a_collision() -> None:
    deep = Order(order().grasp, order(0.0).grasp, order().lift, 0.02)
    hit = go_to(scene(block()), deep, np.zeros(7), None)
    assert hit is not None
    assert (hit.status, hit.reason) == ("collision", "the fingers touched the object on the way to the pre-grasp")


@pytest.fixture
def arm_scene() -> World:
    robot = load_robot("ur5")
    world = World([block()], Arm(robot, PR2), hand_of(PR2, Pads(0.5, 40.0)))
    world.reset(np.radians(robot.reach.reference_deg), 0.08)
    world.put(0, np.array([-0.45, -0.1, SIZE[2] / 2]), Rotation.identity())
    world.settle(0.5)
    return world


def by_arm(tips_m: float = 0.015, far_m: float = 0.0) -> Order:
    there = order(tips_m)
    shift = np.array([-0.45 - far_m, -0.1, 0.0])
    pre_grasp, grasp, lift = (Pose(pose.position + shift, DOWN) for pose in (there.pre_grasp, there.grasp, there.lift))
    return Order(pre_grasp, grasp, lift, 0.08)


def test_an_arm_holds_it_too(arm_scene: World) -> None:
    start = np.radians(load_robot("ur5").reach.reference_deg)
    assert go_to(arm_scene, by_arm(), start, start) is None
    done = execute(arm_scene, by_arm())
    assert (done.status, done.clean) == ("held", True)
    assert done.lifted_m == pytest.approx(0.1, abs=3e-3)


def test_an_arm_that_sweeps_something_on_its_way_collides(arm_scene: World) -> None:
    """From below the table there is no way."""
    start = np.radians(load_robot("ur5").reach.reference_deg)
    low = start + np.array([0.0, 1.0, 0.6, 0.0, 0.0, 0.0])
    hit = go_to(arm_scene, by_arm(), low, start)
    assert hit is not None
    assert hit.status == "collision"
    assert "touched the table on the way to the pre-grasp" in str(hit.reason)


def test_an_arm_that_does_not_reach_says_so(arm_scene: World) -> None:
    start = np.radians(load_robot("ur5").reach.reference_deg)
    assert go_to(arm_scene, by_arm(), start, start) is None
    far = Order(by_arm().pre_grasp, by_arm(far_m=2.0).grasp, by_arm().lift, 0.08)
    assert execute(arm_scene, far).reason == OUT_OF_REACH


def test_physics_that_give_nonsense_are_said_and_leave_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    world = ready(scene(block()), order())

    def break_it() -> None:
        if world.data.time > 1.6:
            world.data.qvel[:] = np.nan
            world.watch = None

    world.watch = break_it
    done = execute(world, order())
    assert (done.status, done.reason) == ("lost", UNSTABLE)
    assert list(tmp_path.iterdir()) == []
