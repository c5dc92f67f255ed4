"""One cloud → one Plan: composes scene, planner and robot; what the command line and the Python API call."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from flatgrasp_cli.model import Cloud, CloudWarning, Grasp, ObjectPlan, Scene
from flatgrasp_cli.planning.doubts import doubts, table_tilted
from flatgrasp_cli.planning.lifting import LISTED, plan_object
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot, load_settings
from flatgrasp_cli.ranking import by_probability
from flatgrasp_cli.scene import segment, without_far_strays, without_repeats
from flatgrasp_cli.sensor import located


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The answer for one cloud, with the profiles and the settings that it was found with.

    `gripper` is the hand that was planned for: what the method makes of the profile.
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
        told = doubts(self.scene, self.objects, self.best, self.settings)
        return tuple(dict.fromkeys((*self.cloud.warnings, *self.scene.warnings, *told)))

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
    top: int = LISTED,
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
        From `load_settings`; the shipped ones when None.
    top
        How many grasps of each object to keep, best first; `ValueError` if less than one.
    robot
        From `load_robot`: only grasps that it reaches are kept. The cloud must be in its base frame (`in_base_frame`).
    """
    if top < 1:
        raise ValueError(f"top is how many grasps to keep, one or more, not {top}")
    resolved = (settings or load_settings()).resolve(gripper, robot)
    if resolved.hand.model == "paper":
        gripper = gripper.in_the_papers_symbols()
    began = time.perf_counter()
    cloud = located(without_far_strays(without_repeats(cloud)), resolved.scene.up, resolved.seed)
    scene = segment(cloud, resolved.scene, resolved.seed)
    scene = replace(scene, warnings=(*scene.warnings, *table_tilted(scene.support))) if robot else scene
    segmented = time.perf_counter()
    plans = _planned(scene, gripper, resolved, top, robot)
    objects = tuple(in_picking_order(plans))
    scene_ms, plan_ms = 1e3 * (segmented - began), 1e3 * (time.perf_counter() - segmented)
    return Plan(
        cloud=cloud,
        gripper=gripper,
        robot=robot,
        settings=resolved,
        scene=scene,
        objects=objects,
        scene_ms=scene_ms,
        plan_ms=plan_ms,
    )


def _planned(
    scene: Scene, gripper: Gripper, settings: PlannerSettings, top: int, robot: Robot | None
) -> list[ObjectPlan]:
    """The plans of a scene's objects; where objects touch and none of them has a grasp, that of all of them as one."""
    plans = [plan_object(item, gripper, settings, top, robot) for item in scene.objects]
    for whole in scene.wholes:
        parts = [item for item in plans if item.object.group == whole.group]
        if parts and not any(item.grasps for item in parts):
            found = plan_object(whole, gripper, settings, top, robot)
            plans = [*(item for item in plans if item not in parts), found] if found.grasps else plans
    if any(item.grasps for item in plans) or settings.approach.directions not in ("auto", "any"):
        return plans
    return [_once_more(item, gripper, settings, top, robot) for item in plans]


def _once_more(
    item: ObjectPlan, gripper: Gripper, settings: PlannerSettings, top: int, robot: Robot | None
) -> ObjectPlan:
    """The plan for an object of a scene in which nothing has a grasp: from the sides between those that were tried."""
    if item.object.support is None:
        return item
    found = plan_object(item.object, gripper, settings, top, robot, between=True)
    return found if found.grasps else item


def in_picking_order(plans: list[ObjectPlan]) -> Iterator[ObjectPlan]:
    """The order of picking: that of the objects' best grasps, but later what others lie on, or what lies at an edge.

    Of grasps that hold as probably, those from straight above come first: what stands beside the others may be gone by
    then. Gravity distances of different objects compare only where nothing else does. Objects without a grasp come
    last, larger first.
    """
    for _, alike in groupby(sorted(plans, key=_how_late), key=_how_late):
        items = sorted(alike, key=lambda item: -len(item.object.points))
        best = [item.grasps[0] if item.grasps else None for item in items]
        chances = np.array([grasp.success.probability if grasp and grasp.success else 0.0 for grasp in best])
        distances = np.array([grasp.gravity_distance_m if grasp else 0.0 for grasp in best])
        aslant = np.array([grasp is not None and grasp.approach.known_from != "top" for grasp in best])
        places = np.argsort(np.lexsort((distances, -chances, aslant)))
        yield from (items[k] for k in by_probability(chances, places))


def _how_late(item: ObjectPlan) -> tuple[bool, bool, bool]:
    """What comes later whatever its grasps are like."""
    cloud = item.object
    return (not item.grasps, cloud.cut_off or cloud.at_edge, bool(cloud.supports))
