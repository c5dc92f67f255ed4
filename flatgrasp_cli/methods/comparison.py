"""The paper's comparison with its reference [1]: our grasps of a cloud, and those of two point fingers."""

from __future__ import annotations

from dataclasses import dataclass

from flatgrasp_cli.methods.allen import point_finger_grasps, shortcomings
from flatgrasp_cli.model import GraspCandidates, ObjectPlan
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.proof import hands_of


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """One object: our plan, the point fingers' grasps, and why our hand cannot carry each of those out, or None.

    `theirs` lie in the plane of our silhouette; None where there is no silhouette.
    """

    ours: ObjectPlan
    theirs: GraspCandidates | None
    verdicts: list[str | None]


def compare(item: ObjectPlan, gripper: Gripper, settings: PlannerSettings) -> Comparison:
    """Both methods' grasps on the silhouette of one object."""
    if item.shape is None:
        return Comparison(item, None, [])
    silhouette = item.shape.silhouette
    found = point_finger_grasps(silhouette, item.shape.gravity_center.area, settings.caging)
    return Comparison(item, found, shortcomings(silhouette, hands_of(found), gripper, settings))
