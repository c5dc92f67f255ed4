"""What would help where the arm reaches no grasp."""

from __future__ import annotations

from functools import cache

import numpy as np

from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import ObjectPlan, Rejection
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Robot, list_profiles, load_robot
from flatgrasp_cli.robot import arm_of


def out_of_reach(plan: Plan, item: ObjectPlan, rejection: Rejection) -> str | None:
    """What to try by the limit that stops the arm at most of the grasps."""
    robot, depth, limit = plan.robot, plan.settings.depth, rejection.cause
    stopped = [grasp.reach.waypoint for grasp in item.refused if grasp.reach and grasp.reach.limit == limit]
    if robot is None or not stopped:
        return None
    if limit == "out of reach" and (text := _longer_arm(plan, robot, item)):
        return text
    if all(waypoint == "lift" for waypoint in stopped):
        return f"a shorter lift: --set depth.lift_m={0.5 * depth.lift_m:g}"
    if all(waypoint in ("pre_grasp", "approach") for waypoint in stopped):
        return f"a shorter approach: --set depth.approach_m={0.5 * depth.approach_m:g}"
    if limit == "below the table":
        return "mount the base higher over the table; the links' radii are in the robot's profile (links)"
    own = {
        "joint limit": "joints.lower_deg, joints.upper_deg",
        "joint step": "reach.max_step_deg, reach.steps",
        "manipulability": "reach.min_manipulability_share",
    }.get(str(limit), "camera_pose")
    return f"another place for the base, or a profile of your own: its {own} decide"


def _longer_arm(plan: Plan, robot: Robot, item: ObjectPlan) -> str | None:
    """How far the nearest of the refused grasps is, and the arm that gets there; None if it is not too far."""
    tool = plan.gripper.palm_offset_m + plan.gripper.finger_length_m
    arm = arm_of(robot)
    shoulder = arm.in_own_base(arm.shoulder)
    apart = []
    for grasp in item.refused:
        approach = axes_from_quaternion(grasp.orientation)[2]
        flange = grasp.position - tool * approach
        ways = (flange, flange - plan.settings.depth.approach_m * approach)
        apart.append(max(float(np.linalg.norm(way - shoulder)) for way in ways))
    far = min(apart)
    if far <= robot.reach_m:
        return None
    said = f"its flange must go {far:.2f} m from the shoulder, {robot.name} reaches {robot.reach_m:.2f} m"
    longer = [each for each in _shipped_robots() if each.reach_m >= far and each.dh]  # which need no extra
    other = min(longer, key=lambda each: each.reach_m, default=None)
    return f"{said}: " + (f"--robot {other.name} reaches {other.reach_m:.2f} m" if other else "is --camera-pose right?")


@cache
def _shipped_robots() -> tuple[Robot, ...]:
    return tuple(map(load_robot, list_profiles("robot")))
