"""One cloud → one Plan: composes the planner's parts; what the command line and the Python API call."""

from __future__ import annotations

import time
from dataclasses import dataclass

from flatgrasp_cli.model import Cloud, Grasp, ObjectCloud, ObjectPlan
from flatgrasp_cli.planner import plan_object
from flatgrasp_cli.profiles import Gripper, PlannerSettings, load_settings


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The answer for one cloud, with the profile and the settings that it was found with."""

    cloud: Cloud
    gripper: Gripper
    settings: PlannerSettings
    objects: tuple[ObjectPlan, ...]
    plan_ms: float

    @property
    def best(self) -> Grasp | None:
        """The best grasp of the first object that has one."""
        return next((obj.grasps[0] for obj in self.objects if obj.grasps), None)

    @property
    def reason(self) -> str | None:
        """Why there is no grasp; None when there is one."""
        if self.best is not None:
            return None
        rejection = self.objects[0].rejection
        return rejection.reason if rejection else None


def plan(cloud: Cloud, gripper: Gripper, settings: PlannerSettings | None = None, *, top: int = 10) -> Plan:
    """Plan grasps on a cloud that shows one object.

    Parameters
    ----------
    cloud
        From `read_clouds`, or made of points (n, 3) in metres and a viewpoint (3,).
    gripper
        From `load_gripper`.
    settings
        From `load_settings`; the shipped defaults when None.
    top
        How many grasps to keep, best first.
    """
    resolved = (settings or load_settings()).resolve(gripper)
    began = time.perf_counter()
    objects = (plan_object(ObjectCloud(0, cloud.points, cloud.viewpoint), gripper, resolved, top),)
    return Plan(cloud, gripper, resolved, objects, 1e3 * (time.perf_counter() - began))
