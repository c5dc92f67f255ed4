"""The paper's comparison with its reference [1]: our grasps of a cloud, and those of two point fingers."""

from __future__ import annotations

from dataclasses import dataclass

from flatgrasp_cli.model import Grasp, ObjectPlan
from flatgrasp_cli.planner.allen import point_finger_grasps, shortcomings
from flatgrasp_cli.planner.certification import hands_of
from flatgrasp_cli.planning import Plan


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """One object: our plan, the point fingers' grasps, and why our hand cannot carry each of those out, or None."""

    ours: ObjectPlan
    theirs: tuple[Grasp, ...]
    verdicts: list[str | None]


def compare(plan: Plan) -> list[Comparison]:
    """Both methods' grasps on the outline of each object of a plan."""
    return [_of_object(item, plan) for item in plan.objects]


def _of_object(item: ObjectPlan, plan: Plan) -> Comparison:
    outline, center = item.trace.silhouette, item.trace.gravity_center
    if outline is None or center is None:
        return Comparison(item, (), [])
    found = point_finger_grasps(outline, center.area, 0.0, plan.settings)
    if not found:
        return Comparison(item, (), [])
    return Comparison(item, found, shortcomings(outline, hands_of(found, outline), plan.gripper, plan.settings))
