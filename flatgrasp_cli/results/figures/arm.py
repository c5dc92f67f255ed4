"""The arm at the best grasp, before it and after it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.results.figures.hand import finger_boxes
from flatgrasp_cli.results.figures.style import BLUE, GREEN, ORANGE, PALE, PURPLE, RED, SKY, new_figure, thinned
from flatgrasp_cli.robot import forward, in_dh_base

POSES = (("pre-grasp", SKY, 1.5), ("grasp", BLUE, 4.0), ("lift", ORANGE, 1.5))
"""In the order of a reach's joint angles, with colour and width."""
AXIS_M = 0.15
NEAR_M = 0.4


def arm_figure(plan: Plan) -> Figure | None:
    """The arm's links at pre-grasp, grasp and lift, the hand, and the points around; None if no grasp is reached."""
    grasp, robot = plan.best, plan.robot
    if robot is None or grasp is None or grasp.reach is None or grasp.reach.joints_rad is None:
        return None
    figure = new_figure(8.0, 7.0)
    axes = figure.add_subplot(projection="3d")
    near = plan.cloud.points[np.linalg.norm(plan.cloud.points - grasp.position, axis=1) < NEAR_M]
    axes.scatter(*thinned(near).T, s=1, color=PALE, depthshade=False)
    for joints, (name, color, width) in zip(grasp.reach.joints_rad, POSES, strict=True):
        links = _links(robot, joints)
        axes.plot(*links.T, "-o", color=color, lw=width, ms=width + 1, label=name)
    _draw_hand(axes, grasp, plan.gripper)
    for axis, color, name in zip(np.eye(3), (RED, GREEN, PURPLE), "xyz", strict=True):
        axes.quiver(0, 0, 0, *(AXIS_M * axis), color=color)
        axes.text(*(1.2 * AXIS_M * axis), name, color=color)
    _finish(axes, plan, robot, grasp)
    return figure


def _links(robot: Robot, joints: FloatArray) -> FloatArray:
    """Origins (7, 3) of the base and of the arm's frames, in the robot's base frame."""
    origins = forward(robot.dh, joints)[:, :3, 3]
    return in_dh_base(robot.base_frame, np.vstack([np.zeros(3), origins]))


def _draw_hand(axes: Any, grasp: Grasp, gripper: Gripper) -> None:
    """Palm and fingers as lines: from the flange to the palm, along it, and down each finger."""
    frame = axes_from_quaternion(grasp.orientation)

    def place(corners: list[tuple[float, float, float]]) -> FloatArray:
        return grasp.position + np.array(corners) @ frame

    length = gripper.finger_length_at_m(grasp.width_m)
    lines = [[(0.0, 0.0, -length - gripper.palm_offset_m), (0.0, 0.0, -length)]]
    for x0, x1, y0, y1 in finger_boxes(gripper, grasp.opening_m):
        x, y = 0.5 * (x0 + x1), 0.5 * (y0 + y1)
        lines.append([(0.0, 0.0, -length), (x, y, -length), (x, y, 0.0)])
    for line in lines:
        axes.plot(*place(line).T, color=RED, lw=2.5)


def _finish(axes: Any, plan: Plan, robot: Robot, grasp: Grasp) -> None:
    reach = grasp.reach
    share = f"{100 * reach.manipulability_share:.0f} %" if reach and reach.manipulability_share is not None else "?"
    axes.set_title(
        f"{robot.name} in {robot.base_frame} · {plan.gripper.name} · manipulability {share} of the arm's largest",
        loc="left",
        fontsize=11,
    )
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    axes.set_zlabel("z (m)")
    axes.set_aspect("equal")
    axes.legend(loc="upper right", fontsize=8, frameon=False)
