"""Beyond the paper: how deep the fingertips go, and what fingers and palm keep clear of.

The hand moves straight against the plane's normal, so fingers and palm sweep upright boxes: they meet a point exactly
if it lies within their footprint and above their end. A map of the highest points tells that for all pairs at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.funnel import Funnel, Miss
from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.surroundings.below import fingers_meet, palm_meets, palm_room, too_low, under_fingers, under_palm
from flatgrasp_cli.surroundings.maps import NOISE_M, Relief
from flatgrasp_cli.surroundings.slices import lowest_tip
from flatgrasp_cli.surroundings.walls import Walls, walls

MIN_GRIP_SHARE = 0.5
"""Share of a wall's height that the pads must hold where the wall is too low for the least grip: the fingertips'
clearance over the table takes a third of it."""
MARGINS = 4
"""Openings that are tried, from the one that is aimed at down to the least: by default 6 mm a side apart, less than a
finger is thick."""


@dataclass(frozen=True, slots=True, eq=False)
class _Upright:
    """What p pairs hold, heights (p,) in metres.

    `wall` is the top of the lower of the two walls, `firm` the same without what is only a flank, `need` the least
    grip, and `seen` the height at which the boundaries on both sides were seen. `found` are the walls themselves.
    """

    wall: FloatArray
    firm: FloatArray
    need: FloatArray
    seen: FloatArray
    found: Walls


def descended(
    fingers: FingerCandidates, grasps: GraspCandidates, around: Relief, gripper: Gripper, funnel: Funnel
) -> GraspCandidates:
    """The pairs on which the hand can come down far enough, with `opening`, `tip`, `grip`, `margin`, `touch`."""
    settings, depth, maps = around.settings, around.settings.depth, around.maps
    margins, clear_m = _margins(grasps, gripper, settings), settings.hand.clearance_m
    outward = margins[:-1] + margins[1:]  # as far beyond a finger as the next smaller opening leaves beside its pad
    below, unseen = under_fingers(grasps, np.concatenate([margins, outward]), maps.rest, maps.highest, gripper, clear_m)
    held = _held(fingers, grasps, around, gripper)
    lowest = np.minimum(around.lowest_m, lowest_tip(held.firm, depth))
    lowest = np.maximum(lowest, around.level_m - depth.slice_step_m)  # what lies deeper is for a lower slice
    headroom, openings = gripper.finger_length_m - depth.palm_clearance_m, grasps.width + 2 * margins
    palm = under_palm(grasps.hands, openings, maps.coarse, float(lowest.min()) + headroom, gripper)
    tips = _tips(below, np.concatenate([palm, palm[:-1]]) - headroom, lowest, around)
    widest, choice = _widest(tips[:MARGINS]), _roomiest(tips)
    columns, pairs = np.arange(len(grasps)), np.stack([grasps.i, grasps.j])
    tip = tips[choice, columns]

    def miss(value: float) -> Miss:
        nearest = int(np.argmin(held.need - (held.firm - tip)))
        if held.firm[nearest] - lowest[nearest] < held.need[nearest]:
            return too_low(float(held.firm[nearest] - lowest[nearest]), float(held.need[nearest]))
        met_by_palm = float(palm[choice[nearest], nearest])
        if met_by_palm - headroom >= tip[nearest]:
            return palm_meets(value, met_by_palm, gripper)
        one = np.array([nearest])
        others, _ = under_fingers(grasps.select(one), margins[:, one], maps.others, maps.others, gripper, clear_m)
        return fingers_meet(value, float(below[choice[nearest], nearest]), float(others[choice[nearest], 0]))

    kept = funnel.at_most("depth", grasps, held.need - (held.firm - tip), 0.0, miss)
    grasps = grasps.having(
        opening=openings[choice, columns],
        tip=tip,
        grip=held.wall - tip,
        margin=margins[widest, columns],
        unseen=unseen[choice, columns],
        touch=np.clip(held.seen, tip, np.maximum(held.wall, tip)),
        lean=held.found.lean(pairs, tip, held.wall),
        feet=held.found.feet(pairs, tip),
    ).select(kept)
    room = palm_room(grasps, maps.coarse, headroom, gripper, settings.hand)
    grasps = grasps.having(margin=np.minimum(grasps.margin, room), palm_room=room)
    return _looked_into(grasps, funnel) if depth.unseen == "refuse" else grasps


def _held(fingers: FingerCandidates, grasps: GraspCandidates, around: Relief, gripper: Gripper) -> _Upright:
    """What the pairs hold, by the walls at both of their finger candidates."""
    friction = around.settings.balance.friction_with(gripper)
    found = walls(fingers, around.maps.surface, around.envelope, around.level_m, friction)
    wall = np.minimum(found.top[grasps.i], found.top[grasps.j])
    # Between two flanks the object slips out; if one side is upright, the other may be slanted.
    firm = wall - np.minimum(found.flank[grasps.i], found.flank[grasps.j])
    need = MIN_GRIP_SHARE * np.clip(wall, 0.0, around.height_m)
    need = np.minimum(around.settings.depth.min_grip_m, need)
    seen = np.maximum(found.boundary[grasps.i], found.boundary[grasps.j])
    return _Upright(wall=wall, firm=firm, need=need, seen=seen, found=found)


def _tips(below: FloatArray, palm_tip: FloatArray, lowest: FloatArray, around: Relief) -> FloatArray:
    """Heights (MARGINS, p) at which the fingertips end, from what is `below` the fingers at each of the openings.

    `palm_tip` (MARGINS, p) is where they end if the palm meets something, `lowest` (p,) how low they may go.
    """
    depth = around.settings.depth
    clearance = np.where(below > around.lowest_m, depth.obstacle_clearance_m, depth.min_clearance_m)
    met = np.where(below > around.ground_m, below + clearance, -np.inf)  # anything lower is the plane's own ripple
    return np.maximum(np.maximum(met, palm_tip), lowest)


def _widest(tips: FloatArray) -> IntArray:
    """Which is the widest of the openings (p,) that lets the tips down as far as any, by their `tips` (MARGINS, p)."""
    return np.asarray(np.argmax(tips <= tips.min(axis=0) + NOISE_M, axis=0))


def _roomiest(tips: FloatArray) -> IntArray:
    """Which of these openings (p,) leaves most room on the narrower side of the fingers: at the pad, or outward.

    A finger that is set down as far out as it goes has a neighbour right behind it, and of that the sensor may not have
    seen all. After the `tips` (MARGINS, p) of the openings come those (MARGINS − 1, p) of all but the smallest with the
    fingers thicker outward by what the next smaller one leaves at the pads: where they come down as far even so, the
    next has less room at the pads than this one has on either side.
    """
    low = tips[MARGINS:] <= tips.min(axis=0) + NOISE_M
    return np.where(low.any(axis=0), np.argmax(low, axis=0), MARGINS - 1)


def _looked_into(grasps: GraspCandidates, funnel: Funnel) -> GraspCandidates:
    """The pairs whose way the sensor saw entirely."""
    kept = funnel.at_most("unseen", grasps, grasps.unseen, 0.0, lambda value: f"{value:.3f} m of the way is hidden")
    return grasps.select(kept)


def _margins(grasps: GraspCandidates, gripper: Gripper, settings: PlannerSettings) -> FloatArray:
    """Free space (MARGINS, p) beside each pad on the approach, metres: from what is aimed at down to the least."""
    room, beyond = grasps.room.min(axis=1) - gripper.finger_thickness_m, grasps.beyond
    spare = 0.5 * (gripper.max_opening_m - grasps.width)
    most = np.minimum(np.minimum(room, settings.hand.preshape_m + beyond), spare)
    least = np.minimum(settings.hand.clearance_m + beyond, most)
    return np.asarray(most + np.linspace(0.0, 1.0, MARGINS)[:, None] * (least - most))
