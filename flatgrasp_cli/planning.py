"""One cloud → one Plan: composes scene, planner and robot; what the command line and the Python API call."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import Cloud, CloudWarning, Grasp, ObjectPlan, Reach, Rejection, Scene, Stage
from flatgrasp_cli.planner import plan_object
from flatgrasp_cli.profiles import CameraPose, Gripper, PlannerSettings, Robot, load_settings
from flatgrasp_cli.robot import Motion, Plane, reach
from flatgrasp_cli.scene import segment, without_far_strays
from flatgrasp_cli.sensor import located

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
    cloud = located(without_far_strays(cloud), resolved.scene.up, resolved.seed)
    scene = segment(cloud, resolved.scene, resolved.seed)
    segmented = time.perf_counter()
    plans = [plan_object(item, gripper, resolved, REACH_CANDIDATES if robot else top) for item in scene.objects]
    if robot is not None:
        plans = [_reached(item, gripper, robot, resolved, top) for item in plans]
    objects = tuple(sorted(plans, key=_best_first))
    scene_ms, plan_ms = 1e3 * (segmented - began), 1e3 * (time.perf_counter() - segmented)
    return Plan(cloud, gripper, robot, resolved, scene, objects, scene_ms, plan_ms)


def in_base_frame(cloud: Cloud, camera: CameraPose, frame_id: str) -> Cloud:
    """The cloud in the frame `frame_id` in which its own frame has the pose `camera`."""
    frame = Frame(np.array(camera.position_m), axes_from_quaternion(np.array(camera.orientation_xyzw)))
    if cloud.sensor is None and cloud.viewpoint is None:
        cloud = replace(cloud, viewpoint=np.zeros(3))  # the frame with that pose is the camera's
    return cloud.in_frame(frame, frame_id)


def _best_first(item: ObjectPlan) -> tuple[float, int]:
    """Objects in the order of their best grasps; those without one last, larger first."""
    return (item.grasps[0].cost_m if item.grasps else math.inf, -len(item.object.points))


def _reached(item: ObjectPlan, gripper: Gripper, robot: Robot, settings: PlannerSettings, top: int) -> ObjectPlan:
    """The same with only the grasps that the robot can carry out, and the best of those that it cannot."""
    if not item.grasps:
        return item
    axes = np.array([axes_from_quaternion(grasp.orientation) for grasp in item.grasps])
    tool_m = [gripper.palm_offset_m + gripper.finger_length_at_m(grasp.width_m) for grasp in item.grasps]
    support = item.object.support
    lift = -axes[0, 2] if support is None else support.normal
    motion = Motion(settings.depth.approach_m, settings.depth.lift_m, lift, gripper.symmetric)
    table = None if support is None else Plane(support.normal, support.offset_m)
    positions = np.array([grasp.position for grasp in item.grasps])
    answers = reach(robot, positions, axes, np.array(tool_m), motion, table)
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


def _why_not(robot: Robot, answers: tuple[Reach, ...]) -> Rejection:
    """The commonest way in which the robot fails; the limit that it fails by is the cause."""
    ways = [(str(answer.limit), str(answer.waypoint)) for answer in answers]
    limit, waypoint = commonest = max(set(ways), key=lambda way: (ways.count(way), way))
    way = f"{limit} at the {waypoint.replace('_', '-')} in {ways.count(commonest)}"
    return Rejection("reach", f"{robot.name} reaches none of the {len(answers)} best grasps: {way}", cause=limit)
