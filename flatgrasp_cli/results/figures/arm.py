"""The arm at the best grasp, before it and after it."""

from __future__ import annotations

from itertools import chain
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Grasp, ObjectPlan
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Robot
from flatgrasp_cli.results.figures.page import Page
from flatgrasp_cli.results.figures.space import draw_axes_of, draw_hand_in_space, finish_space
from flatgrasp_cli.results.figures.style import BLUE, GREY, MM, ORANGE, PALE, RED, SKY, draw_dots_in_space, thinned
from flatgrasp_cli.robot import arm_of

POSES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("arm at the pre-grasp", {"color": SKY, "lw": 7.0, "ms": 9.0, "alpha": 0.5}),
    ("arm at the grasp", {"color": BLUE, "lw": 3.5, "ms": 5.0}),
    ("arm after the lift", {"color": ORANGE, "lw": 1.8, "ms": 4.0, "linestyle": (0, (3, 1.5))}),
)
"""In the order of a reach's joint angles: even where two of them are the same pose, both are seen."""
AXIS_SHARE = 0.2
"""Length of the axes of the base's frame, of the drawing's size."""
CIRCLE_POINTS = 73
NEAR_M = 0.35
"""Points of the cloud nearer to the grasp than this are drawn."""


def has_arm(plan: Plan) -> bool:
    """Whether there is an arm to be drawn: with a robot, and a grasp that it reaches or was asked about."""
    return plan.robot is not None and _shown(plan) is not None


def arm_figure(plan: Plan) -> Figure | None:
    """The arm's links at pre-grasp, grasp and lift, the hand, and the points around; None if no grasp is reached."""
    if plan.robot is None or plan.best is None:
        return None
    page = Page(f"{plan.robot.name} in {plan.robot.base_frame!r} · {plan.gripper.description}", 1)
    draw_arm(page.panel("", solid=True), plan)
    return page.finish([("Robot", f"{plan.robot.name} reaches it: {manipulability_in_words(plan.best)}")])


def manipulability_in_words(grasp: Grasp) -> str:
    """How far a grasp's way is from where the arm cannot move."""
    share = None if grasp.reach is None else grasp.reach.manipulability_share
    if share is None:
        return "how well is not known"
    return f"its manipulability on the way is {100 * share:.0f} % of the arm's largest, or more"


def draw_arm(axes: Any, plan: Plan) -> None:
    """The arm and the hand, in the robot's base frame; of a grasp out of reach only the hand, grey."""
    shown, robot = _shown(plan), plan.robot
    if shown is None or robot is None:
        return
    item, grasp = shown
    axes.computed_zorder = False  # what is drawn later is in front: the hand is not to be lost among points
    near = thinned(plan.cloud.points[np.linalg.norm(plan.cloud.points - grasp.position, axis=1) < NEAR_M])
    draw_dots_in_space(axes, near, PALE, "cloud")
    draw_dots_in_space(axes, item.object.points, GREY, "the object to be grasped")
    joints = None if grasp.reach is None else grasp.reach.joints_rad
    drawn = [near, np.zeros((1, 3))]
    for angles, (name, style) in zip(() if joints is None else joints, POSES, strict=False):
        links = links_of(robot, angles)
        axes.plot(*(MM * links.T), marker="o", mew=0, label=name, **style)
        drawn.append(links)
    color, label = (RED, "hand at the grasp") if joints is not None else (GREY, "hand, where the arm cannot bring it")
    if joints is None:
        drawn.append(_draw_reach(axes, robot))
    drawn.append(draw_hand_in_space(axes, grasp, plan.gripper, color=color, label=label))
    length = AXIS_SHARE * float(np.ptp(np.vstack(drawn), axis=0).max())
    drawn.append(draw_axes_of(axes, np.zeros(3), np.eye(3), length, f"x, y, z: axes of the frame {robot.base_frame!r}"))
    azimuth = float(np.degrees(np.arctan2(grasp.position[1], grasp.position[0]))) - 60.0
    finish_space(axes, np.vstack(drawn), ("x (mm)", "y (mm)", "z (mm)"), azimuth)


def _draw_reach(axes: Any, robot: Robot) -> FloatArray:
    """How far the arm reaches, level with its base; points (n, 3) of that circle."""
    angle = np.linspace(0.0, 2 * np.pi, CIRCLE_POINTS)
    circle = robot.reach_m * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(CIRCLE_POINTS)])
    axes.plot(*(MM * circle.T), "--", color=GREY, lw=1.0, label=f"the arm's reach of {MM * robot.reach_m:.0f} mm")
    return circle


def links_of(robot: Robot, joints: FloatArray) -> FloatArray:
    """Places (k, 3) along the arm from its base to the flange, in the robot's base frame."""
    return arm_of(robot).links(joints)


def _shown(plan: Plan) -> tuple[ObjectPlan, Grasp] | None:
    """The best grasp with its object, or else the best of those that the robot does not reach."""
    reached = ((item, item.grasps[0]) for item in plan.objects if item.grasps)
    refused = ((item, item.refused[0]) for item in plan.objects if item.refused)
    return next(chain(reached, refused), None)
