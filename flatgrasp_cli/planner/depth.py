"""Beyond the paper: how deep the fingertips go over a support plane, and what fingers and palm keep clear of.

The hand comes straight down on the plane, so fingers and palm sweep upright boxes: they meet a point exactly when it
lies over their footprint, above their end. A map of the highest points answers that for all pairs at once.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.lines import fitted_lines
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.planner.below import fingers_meet, palm_meets, too_low, under_fingers, under_palm
from flatgrasp_cli.planner.funnel import Funnel, Miss
from flatgrasp_cli.planner.hand import Fit, centers, openings
from flatgrasp_cli.planner.slices import lowest_tip
from flatgrasp_cli.planner.view import View
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import HandSettings, PlannerSettings

PALM_CELL_M = 0.005
INWARD_M = np.array([0.001, 0.002, 0.003, 0.004, 0.005, 0.007, 0.009])
"""How far in from the outline it is looked for what a pad rests on: a wall, or a flank."""
SEEN_PLACES, WALL_PLACES = 3, 5
"""Of those the ones that are seen at the boundary, and in which the wall's top is looked for."""
LEAST_SLOPE = 0.5
"""What rises less is an object's top."""
MIN_GRIP_SHARE = 0.5
"""Of a wall that is too low for the least grip the pads must hold this share."""
FLANK_OUTWARD_M = np.array([0.002, 0.003, 0.004])
ALONG_PAD = np.array([-0.4, -0.2, 0.0, 0.2, 0.4])
"""Places along a pad, in widths of it."""
MARGINS = 4
LOWER_M = 0.001
"""A smaller opening must let the fingertips down by more than this to be chosen."""


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """What a slice above `level_m` stands on and amid: height maps over the support plane.

    `surface` is the mean height of the slice's own points, `average` that of all of the object's. `rest` is the highest
    of all others that fingers can meet, the free plane being 0 and what no ray reached −inf; `fine` that of everything,
    for the parts of fingers that are away from the contact, and `whole` the same, coarser, for the palm. `view` is what
    the sensor saw of all that. Fingertips may end at `lowest_m`, lower beside a part that is too low for that; what is
    no higher than `ground_m` is no obstacle.
    """

    level_m: float
    lowest_m: float
    ground_m: float
    surface: HeightMap
    average: HeightMap
    rest: HeightMap
    fine: HeightMap
    whole: HeightMap
    view: View


@dataclass(frozen=True, slots=True, eq=False)
class Landing:
    """How the hand comes down on p pairs: `opening` to come with, `tip` height over the plane, both (p,).

    `grip` is the pads' height on the object, `margin` the free space beside each pad, `unseen` how much of the fingers'
    way, both sides together, no ray reached; `touch` is the height at which both sides were seen, that of the contacts.
    Of an object seen alone grip and unseen are not known: NaN.
    """

    opening: FloatArray
    tip: FloatArray
    grip: FloatArray
    margin: FloatArray
    unseen: FloatArray
    touch: FloatArray

    def select(self, keep: IntArray) -> Landing:
        """The rows that `keep` names."""
        return Landing(*(getattr(self, column.name)[keep] for column in fields(self)))


def at_mid_height(fit: Fit, gripper: Gripper, settings: HandSettings) -> Landing:
    """How the hand comes to an object seen alone: fingertips in the main plane, at the box's mid-height."""
    opening, unknown = openings(fit, gripper, settings), np.full(len(fit.width), np.nan)
    level = np.zeros(len(opening))
    return Landing(opening, level, unknown, 0.5 * (opening - fit.width), unknown, level)


def upright(fingers: FingerCandidates, terrain: Terrain, wall_drop: float) -> BoolArray:
    """Which candidates (m,) stand before a wall, and not on a flank that goes on outward below the slice's level."""
    below = terrain.rest.over(*pad_places(fingers, -FLANK_OUTWARD_M, ALONG_PAD))
    drop = terrain.level_m - np.maximum(below, 0.0)
    steep = drop >= wall_drop * FLANK_OUTWARD_M[:, None, None]
    return np.asarray(steep.mean(axis=(0, 1)) >= 0.5)


def _walls(fingers: FingerCandidates, terrain: Terrain, friction: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What pads rest on before each candidate (m,): the wall's top, its boundary, and how much of it is but a flank.

    All are heights over the plane. The top is typical of the places along the pad, the boundary a mean of what was seen
    there; the slice's level where nothing was. What rises inward less steeply than 1/μ is a flank: it is a wall only as
    far as it is high at the boundary. The highest points tell it, for those of an upright face are its mean.
    """
    places = pad_places(fingers, INWARD_M, ALONG_PAD)
    heights = terrain.surface.over(*places)  # (distances, places, m)
    known = np.isfinite(heights)
    tops = heights[:WALL_PLACES].max(axis=0)
    top = np.sort(np.where(np.isfinite(tops), tops, terrain.level_m), axis=0)[len(ALONG_PAD) // 2]
    near, count = heights[:SEEN_PLACES], known[:SEEN_PLACES].sum(axis=(0, 1))
    total = np.where(known[:SEEN_PLACES], near, 0.0).sum(axis=(0, 1))
    seen = np.where(count > 0, total / np.maximum(count, 1), terrain.level_m)
    counts, totals = known.sum(axis=1), np.where(known, terrain.fine.over(*places), 0.0).sum(axis=1)
    _, slope = fitted_lines(INWARD_M, np.where(counts > 0, totals / np.maximum(counts, 1), np.nan).T)
    flank = (slope > LEAST_SLOPE) & (slope < 1 / friction)
    return top, seen, np.where(flank, slope * INWARD_M[WALL_PLACES - 1], 0.0)


def pad_places(fingers: FingerCandidates, inward: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """X and y (inward, along, m) of places so far `inward` of each candidate's chord and at such shares along it."""
    way = fingers.end - fingers.start
    x, y = (
        fingers.contact[:, k] + along[:, None] * way[:, k] + (inward[:, None] * fingers.direction[:, k])[:, None]
        for k in (0, 1)
    )
    return x, y


def land(
    fingers: FingerCandidates,
    pairs: GraspCandidates,
    fit: Fit,
    terrain: Terrain,
    hand: tuple[Gripper, PlannerSettings],
    funnel: Funnel,
) -> tuple[GraspCandidates, Fit, Landing]:
    """The pairs on which the hand can come down far enough, and how it does."""
    gripper, settings = hand
    depth = settings.depth
    margins = _margins(fit, gripper, settings)
    clear_m = settings.hand.clearance_m
    below, unseen = under_fingers(fingers, pairs, fit, margins, (terrain, gripper, clear_m))
    walls, seen, flanks = _walls(fingers, terrain, settings.balance.friction_with(gripper))
    wall = np.minimum(walls[pairs.i], walls[pairs.j])
    firm = wall - np.minimum(flanks[pairs.i], flanks[pairs.j])  # between two it slips; a slanted wall has but one
    need = np.minimum(depth.min_grip_m, MIN_GRIP_SHARE * np.maximum(wall, 0.0))
    lowest = np.minimum(terrain.lowest_m, lowest_tip(firm, depth))
    lowest = np.maximum(lowest, terrain.level_m - depth.slice_step_m)  # what is deeper is a lower slice's
    headroom = gripper.finger_length_m - depth.palm_clearance_m
    palm = under_palm(centers(fingers, pairs, fit), pairs.axis, terrain.whole, lowest.min() + headroom, gripper)
    clearance = np.where(below > terrain.lowest_m, depth.obstacle_clearance_m, depth.min_clearance_m)
    met = np.where(below > terrain.ground_m, below + clearance, -np.inf)  # what is no higher is the plane's own ripple
    met = np.maximum(met, palm - headroom)
    tips = np.maximum(met, max(terrain.lowest_m, terrain.level_m - depth.slice_step_m))
    tips = np.where(firm - tips.min(axis=0) < need, np.maximum(met, lowest), tips)  # too low there: a low part of it
    choice = np.argmax(tips <= tips.min(axis=0) + LOWER_M, axis=0)  # widest of those that let the tips down
    columns = np.arange(len(pairs))
    tip, margin = tips[choice, columns], margins[choice, columns]
    touch = np.clip(np.maximum(seen[pairs.i], seen[pairs.j]), tip, np.maximum(wall, tip))
    landing = Landing(fit.width + 2 * margin, tip, wall - tip, margin, unseen[choice, columns], touch)

    def miss(value: float) -> Miss:
        nearest = int(np.argmin(need - (firm - tip)))
        if firm[nearest] - lowest[nearest] < need[nearest]:
            return too_low(float(firm[nearest] - lowest[nearest]), float(need[nearest]))
        if palm[nearest] - headroom >= tip[nearest]:
            return palm_meets(value, float(palm[nearest]), gripper)
        one, world = np.array([nearest]), (replace(terrain, fine=terrain.rest), gripper, clear_m)
        alone, _ = under_fingers(fingers, pairs.select(one), fit.select(one), margins[:, one], world)
        return fingers_meet(value, float(below[choice[nearest], nearest]), float(alone[choice[nearest], 0]))

    kept = funnel.at_most("depth", pairs, need - (firm - tip), 0.0, miss)
    if depth.unseen == "refuse":
        plain = funnel.at_most(
            "unseen", pairs.select(kept), landing.unseen[kept], 0.0, lambda value: f"{value:.3f} m of the way is hidden"
        )
        kept = kept[plain]
    return pairs.select(kept), fit.select(kept), landing.select(kept)


def _margins(fit: Fit, gripper: Gripper, settings: PlannerSettings) -> FloatArray:
    """Free space (MARGINS, p) beside each pad to come with: from what is aimed at down to the least."""
    room = fit.room.min(axis=0) - gripper.finger_thickness_m
    most = np.minimum(np.minimum(room, settings.hand.preshape_m), 0.5 * (gripper.max_opening_m - fit.width))
    least = np.minimum(settings.hand.clearance_m, most)
    return np.asarray(most + np.linspace(0.0, 1.0, MARGINS)[:, None] * (least - most))
