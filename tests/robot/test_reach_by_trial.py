"""What an arm reaches against a search branch by branch, for many grasps at once."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_robot
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.profiles.robot import Robot
from flatgrasp_cli.robot import (
    Motion,
    Plane,
    forward,
    inverse,
    manipulability,
    max_manipulability,
    reach,
)
from flatgrasp_cli.robot.reach import BATCH
from tests.robot.arms import (
    DOWN,
    ROBOTS,
    UP,
    UR5,
    angles,
    apart,
    asked,
    changed,
    exists,
    rows,
)


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
    solutions = inverse(rows(robot), waypoints, np.broadcast_to(axes, (len(waypoints), 3, 3)))
    for path in np.moveaxis(solutions, 1, 0):
        if not exists(path).all() or np.max(apart(path[1:], path[:-1])) > np.radians(robot.reach.max_step_deg):
            continue
        joints = np.unwrap(path, axis=0)
        turns = 2 * np.pi * np.arange(-3, 4)[:, None, None]
        within = ((joints + turns >= lower) & (joints + turns <= upper)).all(axis=1).any(axis=0)
        ability = manipulability(rows(robot), joints).min() / max_manipulability(rows(robot))
        height = forward(rows(robot), joints)[:, 1:5, :3, 3] @ table.normal - table.offset_m
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


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_reaches_a_grasp_before_it(name: str) -> None:
    robot = load_robot(name)
    assert asked(robot, [-0.6 * robot.reach_m, 0.0, 0.1], Motion(0.1, 0.1, UP, twin=True), Plane(UP, 0.0), DOWN, 0.1).ok
