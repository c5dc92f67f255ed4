"""Which grasp is best: the one that most probably holds and, among equals, the paper's."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model import GraspCandidates
from flatgrasp_cli.profiles.settings import VarietySettings
from flatgrasp_cli.ranking.closing import RIM_SHARE
from flatgrasp_cli.ranking.errors import friction_suffices
from flatgrasp_cli.ranking.success import Situation
from flatgrasp_cli.ranking.variety import differing

TIE = 0.01
"""Probabilities that differ by less are equal: samples tell them apart no better."""
CONTENDERS = 48
"""Grasps of an object that are tried at all: the best by the estimate of those that lie farther apart than the hand
usually misses by, or are turned by more than it seldom exceeds, two standard deviations."""
FINALISTS = 16
"""And those that are tried with all samples: more than are listed."""


def best_first(grasps: GraspCandidates, situation: Situation) -> GraspCandidates:
    """All of p grasps in their order: those that were tried, then the others by what was estimated of them."""
    settings = situation.settings
    if settings.ranking.prefer == "gravity_distance":
        grasps = grasps.having(merit=-grasps.gravity_distance)
        return grasps.select(np.lexsort((grasps.j, grasps.i, grasps.required_friction, grasps.gravity_distance)))
    grasps = grasps.having(merit=estimated(grasps, situation))
    order = by_probability(grasps.merit, grasps.gravity_distance)
    unsure = situation.unsure
    apart = VarietySettings(apart_m=unsure.position_m, apart_deg=min(2 * unsure.yaw_deg, 90.0))
    contenders = np.array(differing(grasps, order, apart, CONTENDERS), dtype=np.intp)
    rough = situation.briefly.tried(grasps.select(contenders))
    places = by_probability(rough.probability, rough.gravity_distance)
    sure = situation.to_the_end.tried(rough.select(places[:FINALISTS]))
    best = by_probability(sure.probability, sure.gravity_distance)
    finalists, left = contenders[places[:FINALISTS]], contenders[places[FINALISTS:]]
    grasps.merit[contenders], grasps.merit[finalists] = rough.probability, sure.probability
    estimates = np.ones(len(grasps), dtype=np.bool_)
    estimates[contenders] = False
    others = order[estimates[order]]
    return grasps.select(np.concatenate([finalists[best], left, others])).having(
        success=_first_of(len(grasps), sure.success[best]),
        causes=_first_of(len(grasps), sure.causes[best]),
        probability=_first_of(len(grasps), sure.probability[best]),
    )


def _first_of(count: int, known: FloatArray) -> FloatArray:
    """A column (count, …) that begins with what is `known`; the rest is not."""
    column = np.full((count, *known.shape[1:]), np.nan)
    column[: len(known)] = known
    return column


def by_probability(probability: FloatArray, tied: FloatArray | IntArray) -> IntArray:
    """The order (p,) of grasps: the most probable first, those within `TIE` of it by the smaller `tied`, and so on."""
    order = np.lexsort((tied, -probability))
    short = (-probability[order]).tolist()  # rising, and plain numbers: most groups are small
    ranked, least = order.tolist(), tied.tolist()
    begin = 0
    while begin < len(ranked):
        end = bisect_right(short, short[begin] + TIE, begin)
        ranked[begin:end] = sorted(ranked[begin:end], key=least.__getitem__)
        begin = end
    return np.array(ranked, dtype=np.intp)


def estimated(grasps: GraspCandidates, situation: Situation) -> FloatArray:
    """About how probable it is that p grasps hold (p,), without trying them: which of them are worth a trial.

    The hand misses along its closing axis alone, and the walls lean as far as they probably do; weight is left out.
    """
    settings, gripper = situation.settings, situation.gripper
    unsure, friction = situation.unsure, settings.balance.friction_with(gripper)
    room = grasps.margin + RIM_SHARE * gripper.finger_thickness_m
    misses = situation.errors.along_apart
    beside = np.searchsorted(misses, room, side="right") / len(misses)
    half = 0.5 * np.nan_to_num(grasps.grip, nan=np.inf)
    leaning = grasps.lean[:, 0] + unsure.outline_m / half
    need = np.hypot(np.tan(0.5 * np.radians(grasps.force_balance_deg)), leaning)
    rubs = friction_suffices(need, friction, unsure)
    dark = 1 - unsure.occupied_share * np.minimum(np.nan_to_num(grasps.unseen) / gripper.finger_thickness_m, 1.0)
    return np.asarray(beside * rubs * dark)
