"""What would help where there is no grasp: the option, setting, gripper or robot, with its number.

A remedy gets past the stage that kept nothing. What later stages say, only another run can tell.
"""

from __future__ import annotations

from collections.abc import Callable

from flatgrasp_cli.model import ObjectPlan, Rejection
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.remedies import arm, balance, hand, scene

OF_STAGE: dict[str, Callable[[Plan, ObjectPlan, Rejection], str | None]] = {
    "main_plane": scene.no_points,
    "support": scene.hanging,
    "approach": scene.other_direction,
    "silhouette": scene.one_piece,
    "immobilising": balance.not_immobilised,
    "finger_candidates": hand.narrow_fingers,
    "pairs": hand.narrow_fingers,
    "open_sides": scene.other_view,
    "seen": scene.other_view,
    "force_balance": balance.force_unbalanced,
    "torque_balance": balance.torque_unbalanced,
    "pads": balance.beside_pads,
    "grasping_range": hand.too_wide,
    "variance": balance.not_flat,
    "operability": hand.no_room,
    "palm": hand.long_fingers,
    "depth": hand.not_deep_enough,
    "unseen": scene.unseen,
    "cage": balance.no_cage,
    "reach": arm.out_of_reach,
}


def remedy_of(plan: Plan, item: ObjectPlan | None) -> str | None:
    """What would help an object that has no grasp, or the scene if no object was found; None if nothing is known."""
    if item is None:
        return scene.of_scene(plan)
    rejection = item.rejection
    known = rejection and OF_STAGE.get(rejection.stage)
    return known(plan, item, rejection) if rejection and known else None
