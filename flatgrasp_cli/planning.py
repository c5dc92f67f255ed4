"""One cloud → one Plan: composes scene, planner and robot; what the command line and the Python API call."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Cloud, CloudWarning, Grasp, ObjectPlan, Reach, Rejection, Scene, Stage, SupportPlane
from flatgrasp_cli.planner import plan_object
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot, load_settings
from flatgrasp_cli.robot import Motion, Plane, carried_out, flange_at, reach
from flatgrasp_cli.scene import segment, without_far_strays, without_repeats
from flatgrasp_cli.sensor import located

MAX_TABLE_TILT_DEG = 30.0
"""Things slide off a table that is more aslant (friction 0.58). A camera pose that is inverted, or not of the optical
frame, is out by far more as a rule."""
REACH_CANDIDATES = 500
"""The best grasps of an object that a robot is asked about."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The answer for one cloud, with the profiles and the settings that it was found with.

    `cloud` is the one that was planned on: its `sensor` is where the sensor was taken to be, and why.
    """

    cloud: Cloud
    gripper: Gripper
    robot: Robot | None
    settings: PlannerSettings
    scene: Scene
    objects: tuple[ObjectPlan, ...]
    scene_ms: float
    plan_ms: float

    @property
    def best(self) -> Grasp | None:
        """The best grasp of the first object that has one."""
        return next((obj.grasps[0] for obj in self.objects if obj.grasps), None)

    @property
    def warnings(self) -> tuple[CloudWarning, ...]:
        """What had to be assumed and can change the answer."""
        return tuple(dict.fromkeys((*self.cloud.warnings, *self.scene.warnings)))

    @property
    def reason(self) -> str | None:
        """Why there is no grasp; None when there is one."""
        if self.best is not None:
            return None
        if not self.objects:
            return self.scene.reason
        rejection = self.objects[0].rejection
        return rejection.reason if rejection else None


def plan(
    cloud: Cloud,
    gripper: Gripper,
    settings: PlannerSettings | None = None,
    *,
    top: int = 10,
    robot: Robot | None = None,
) -> Plan:
    """Plan grasps on a cloud that shows one object alone, or objects on a support plane.

    Parameters
    ----------
    cloud
        From `read_clouds`, or made of an array of points in metres: `Cloud(points)`.
    gripper
        From `load_gripper`.
    settings
        From `load_settings`; the shipped defaults when None.
    top
        How many grasps of each object to keep, best first.
    robot
        From `load_robot`: only grasps that it reaches are kept. The cloud must be in its base frame, where
        `in_base_frame` brings it.
    """
    resolved = (settings or load_settings()).resolve(gripper)
    began = time.perf_counter()
    cloud = located(without_far_strays(without_repeats(cloud)), resolved.scene.up, resolved.seed)
    scene = segment(cloud, resolved.scene, resolved.seed)
    if robot is not None:
        scene = replace(scene, warnings=(*scene.warnings, *_table_tilted(scene.support)))
    segmented = time.perf_counter()
    plans = [plan_object(item, gripper, resolved, REACH_CANDIDATES if robot else top) for item in scene.objects]
    if robot is not None:
        plans = [_reached(item, gripper, robot, resolved, top) for item in plans]
    plans = [_with_ways(item, gripper, resolved) for item in plans]
    objects = tuple(sorted(plans, key=_best_first))
    scene_ms, plan_ms = 1e3 * (segmented - began), 1e3 * (time.perf_counter() - segmented)
    return Plan(cloud, gripper, robot, resolved, scene, objects, scene_ms, plan_ms)


def _table_tilted(support: SupportPlane | None) -> tuple[CloudWarning, ...]:
    """The warning that the support plane is no table of a robot that stands upright."""
    if support is None or support.normal[2] >= math.cos(math.radians(MAX_TABLE_TILT_DEG)):
        return ()
    text = (
        f"the support plane is tilted by more than {MAX_TABLE_TILT_DEG:.0f}° against the robot's base, "
        "as it is only where the arm is not mounted upright: check --camera-pose, where the camera stands"
    )
    return (CloudWarning("table_tilted", text),)


def _best_first(item: ObjectPlan) -> tuple[float, int]:
    """Objects in the order of their best grasps; those without one last, larger first."""
    return (item.grasps[0].cost_m if item.grasps else math.inf, -len(item.object.points))


def _reached(item: ObjectPlan, gripper: Gripper, robot: Robot, settings: PlannerSettings, top: int) -> ObjectPlan:
    """The same with only the grasps that the robot can carry out, and the best of those that it cannot."""
    if not item.grasps:
        return item
    flanges = [flange_at(grasp, gripper) for grasp in item.grasps]
    positions = np.array([flange.position for flange in flanges])
    axes = np.array([axes_from_quaternion(flange.orientation) for flange in flanges])
    support = item.object.support
    table = None if support is None else Plane(support.normal, support.offset_m)
    answers = reach(robot, positions, axes, _motion(item, item.grasps[0], gripper, settings), table)
    asked = [replace(grasp, reach=answer) for grasp, answer in zip(item.grasps, answers, strict=True)]
    kept = [grasp for grasp, answer in zip(asked, answers, strict=True) if answer.ok]
    refused = [grasp for grasp, answer in zip(asked, answers, strict=True) if not answer.ok]
    return replace(
        item,
        grasps=tuple(replace(grasp, rank=k + 1) for k, grasp in enumerate(kept[:top])),
        refused=tuple(refused[:top]),
        funnel=(*item.funnel, Stage("reach", len(kept))),
        rejection=None if kept else _why_not(robot, answers),
    )


def _with_ways(item: ObjectPlan, gripper: Gripper, settings: PlannerSettings) -> ObjectPlan:
    """The same, each of its grasps with the way in which it is carried out."""
    grasps, refused = (
        tuple(carried_out(grasp, gripper, _motion(item, grasp, gripper, settings)) for grasp in some)
        for some in (item.grasps, item.refused)
    )
    return replace(item, grasps=grasps, refused=refused)


def _motion(item: ObjectPlan, grasp: Grasp, gripper: Gripper, settings: PlannerSettings) -> Motion:
    """How the hand comes to an object's grasp, and goes: up from the support plane, or back from an object alone."""
    support = item.object.support
    lift = -axes_from_quaternion(grasp.orientation)[2] if support is None else support.normal
    return Motion(settings.depth.approach_m, settings.depth.lift_m, lift, gripper.symmetric)


def _why_not(robot: Robot, answers: tuple[Reach, ...]) -> Rejection:
    """The commonest way in which the robot fails; the limit that it fails by is the cause."""
    ways = [(str(answer.limit), str(answer.waypoint)) for answer in answers]
    limit, waypoint = commonest = max(set(ways), key=lambda way: (ways.count(way), way))
    way = f"{limit} at the {waypoint.replace('_', '-')} in {ways.count(commonest)}"
    return Rejection("reach", f"{robot.name} reaches none of the {len(answers)} best grasps: {way}", cause=limit)
