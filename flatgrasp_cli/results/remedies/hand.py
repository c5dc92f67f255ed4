"""What would help where the hand does not fit: another one, if one ships that does."""

from __future__ import annotations

import math
from functools import cache

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import ObjectPlan, Rejection
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper, list_profiles, load_gripper
from flatgrasp_cli.results.remedies.words import mm

COARSE_SHARE = 0.25
"""Points farther apart than this share of an object's smaller side leave its silhouette ragged."""
MILLIMETRES_M = 1.0
"""What is wider than this between the pads may be a cloud in millimetres."""
TINY_M = 0.003
"""What is no longer than this may be a cloud in kilometres, or scaled twice."""


def narrow_fingers(plan: Plan, item: ObjectPlan, _rejection: Rejection) -> str | None:
    """A hand whose fingers find a place on the silhouette."""
    box = item.box
    if box is not None and max(box.size[:2]) < TINY_M:
        return f"clouds are taken in metres, this object is {1e3 * max(box.size[:2]):.2g} mm long: see --scale"
    mine = _widest_jaw(plan.gripper)
    narrow = min(_shipped_grippers(), key=_widest_jaw)
    if _widest_jaw(narrow) >= mine:
        return None
    return f"--gripper {narrow.name} has fingers {mm(_widest_jaw(narrow))} wide, {plan.gripper.name} {mm(mine)}"


def too_wide(plan: Plan, item: ObjectPlan, rejection: Rejection) -> str | None:
    """A hand that opens as far as it must, or closes as far."""
    gripper = plan.gripper
    if rejection.value is None:
        smaller = [each for each in _shipped_grippers() if each.min_opening_m < gripper.min_opening_m]
        near = min(smaller, key=lambda each: abs(each.max_opening_m - gripper.max_opening_m), default=None)
        return f"--gripper {near.name} closes to {mm(near.min_opening_m)}" if near else None
    need = rejection.value + 2 * plan.settings.hand.clearance_m
    asked = f"{math.ceil(1e3 * need)} mm are needed, {gripper.name} opens {mm(gripper.max_opening_m)}"
    wider = [each for each in _shipped_grippers() if each.max_opening_m >= need]
    if wider:
        hand = min(wider, key=lambda each: each.max_opening_m)
        return f"{asked}: --gripper {hand.name} opens {mm(hand.max_opening_m)}"
    if need > MILLIMETRES_M:
        return f"{asked}; if the cloud is in millimetres: --scale 0.001"
    widest = max(_shipped_grippers(), key=lambda each: each.max_opening_m)
    table = "; if it is objects on a table: --scene table" if item.object.support is None else ""
    return f"{asked}, and {widest.name}, the widest shipped gripper, {mm(widest.max_opening_m)}{table}"


def no_room(plan: Plan, _item: ObjectPlan, rejection: Rejection) -> str | None:
    """A hand with fingers as thin as the room behind the pads, or one that opens further."""
    gripper = plan.gripper
    if rejection.value is None:
        wider = [each for each in _shipped_grippers() if each.max_opening_m > gripper.max_opening_m]
        hand = min(wider, key=lambda each: each.max_opening_m, default=None)
        return f"--gripper {hand.name} opens {mm(hand.max_opening_m)}" if hand else None
    room = gripper.finger_thickness_m - rejection.value
    return _thinner(gripper, room) if room > 0 else "clear what stands in the fingers' way, or leave a gap there"


def _thinner(gripper: Gripper, room_m: float) -> str:
    thin = [each for each in _shipped_grippers() if each.finger_thickness_m <= room_m]
    hand = min(thin, key=lambda each: abs(each.max_opening_m - gripper.max_opening_m), default=None)
    if hand is None:
        return f"fingers no thicker than {mm(room_m)} would fit, {gripper.name}'s are {mm(gripper.finger_thickness_m)}"
    mine = f"{gripper.name}'s {mm(gripper.finger_thickness_m)}"
    return f"--gripper {hand.name} has fingers {mm(hand.finger_thickness_m)} thick, {mine}"


def long_fingers(plan: Plan, item: ObjectPlan, rejection: Rejection) -> str | None:
    """A hand whose palm stays clear."""
    if rejection.value is None:
        return None
    need = plan.gripper.finger_length_m + rejection.value
    longer = [each for each in _shipped_grippers() if each.finger_length_m >= need]
    hand = min(longer, key=lambda each: each.finger_length_m, default=None)
    if hand is not None:
        return f"fingers of {mm(need)} are needed: --gripper {hand.name} has {mm(hand.finger_length_m)}"
    side = "; or come from another side: --up X,Y,Z" if item.object.support is None else ""
    return f"fingers of {mm(need)} are needed, no shipped gripper has them{side}"


def not_deep_enough(plan: Plan, item: ObjectPlan, rejection: Rejection) -> str | None:
    """The remedy against each of what keeps the hand from coming down."""
    if rejection.cause == "palm":
        return long_fingers(plan, item, rejection)
    if rejection.cause == "neighbours":
        return "take away what stands beside it, or grasp that first; thinner fingers need less room"
    silhouette, box = item.silhouette, item.box
    if rejection.cause == "itself" and silhouette is not None and box is not None:
        return _finer(len(item.object.points), box.size[:2])
    if rejection.cause == "low":
        depth = plan.settings.depth
        return (
            f"depth.min_clearance_m ({depth.min_clearance_m:g} now) brings the tips nearer to the table, "
            f"depth.min_grip_m ({depth.min_grip_m:g} now) lets the pads hold less: --set KEY=VALUE"
        )
    return None


def _finer(points: int, sides: FloatArray) -> str | None:
    """Said of an object on which too few points lie to tell its silhouette."""
    apart, narrow = math.sqrt(float(sides[0] * sides[1]) / points), float(min(sides))
    if apart < COARSE_SHARE * narrow:
        return None
    return f"its outline is ragged, {points} points some {1e3 * apart:.0f} mm apart: look closer, or with more pixels"


@cache
def _shipped_grippers() -> tuple[Gripper, ...]:
    return tuple(map(load_gripper, list_profiles("gripper")))


def _widest_jaw(gripper: Gripper) -> float:
    return max(gripper.jaw_width_m(0), gripper.jaw_width_m(1))
