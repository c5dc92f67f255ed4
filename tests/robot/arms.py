"""Arms to move, and grasps to ask them for."""

from __future__ import annotations

from typing import Any

import numpy as np

from flatgrasp_cli import load_robot
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Reach
from flatgrasp_cli.profiles import list_profiles
from flatgrasp_cli.profiles.robot import DenavitHartenberg, Robot
from flatgrasp_cli.robot import (
    Motion,
    Plane,
    forward,
    reach,
)

ROBOTS = [name for name in list_profiles("robot") if load_robot(name).dh is not None]
"""Arms of the UR family."""
UR5 = load_robot("ur5")
UP = np.array([0.0, 0.0, 1.0])
DOWN = np.array([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])
"""A hand that comes from straight above, its closing axis along y."""
STILL = Motion(0.0, 0.0, UP, twin=False)
USUAL = Motion(0.1, 0.1, UP, twin=False)


def rows(robot: Robot) -> DenavitHartenberg:
    """Those of an arm of the UR family."""
    assert robot.dh is not None
    return robot.dh


def random_joints(count: int, seed: int = 0) -> FloatArray:
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 6))


def flange(robot: Robot, joints: FloatArray) -> tuple[FloatArray, FloatArray]:
    pose = forward(rows(robot), joints)[..., 5, :, :]
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


def farthest_x(height_m: float) -> float:
    """How far along x a flange that points down can be, at a height above the base."""
    h = height_m + 0.0823 - 0.089159
    ahead = 0.09465 + np.sqrt((0.425 + 0.39225) ** 2 - h * h)
    return float(np.hypot(ahead, 0.10915))


LAX = changed(UR5, "reach", min_manipulability_share=0.0, max_step_deg=180.0)
