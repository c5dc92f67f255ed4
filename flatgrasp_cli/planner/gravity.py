"""§III.C: gravity, and the choice of the final grasp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.polygon import area_centroid, cross, dot, left_normal, share_inside
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, GravityCenter, Silhouette
from flatgrasp_cli.planner.depth import Landing
from flatgrasp_cli.planner.hand import Fit, centers
from flatgrasp_cli.profiles.settings import GravitySettings, PlannerSettings

MISSES_M, MISS_STEP_M, MISS_DEG = (-0.010, -0.005, 0.005, 0.010), 0.003, 15.0
"""Sideways misses that a grasp should forgive, and how near to one another grasp must be."""
MOST_NEIGHBOURS, NEIGHBOURS_AT_ONCE = 500, 64
MOST_FRICTION = 10.0
"""Where more friction costs no more: a pair that would have to pull needs infinitely much."""


@dataclass(frozen=True, slots=True, eq=False)
class RankingCost:
    """For p pairs gravity distance, share of the segment inside the outline, and cost in metres, (p,) each."""

    distance: FloatArray
    inside_share: FloatArray
    cost: FloatArray

    def select(self, keep: IntArray) -> RankingCost:
        """The rows that `keep` names."""
        return RankingCost(self.distance[keep], self.inside_share[keep], self.cost[keep])


def gravity_center(whole: Silhouette, settings: GravitySettings) -> GravityCenter:
    """The object's centre of gravity in the plane, from the silhouette of the whole object.

    `area`: the centroid of the silhouette, as of a plate; `points`: the mean of the visible points, which follows their
    density.
    """
    points = whole.points.mean(axis=0)
    return GravityCenter(area_centroid(whole.loops) if whole.loops else points, points, settings.center)


def gravity_distance(fingers: FingerCandidates, pairs: GraspCandidates, center: FloatArray) -> FloatArray:
    """Distance (p,) of the centre of gravity to each grasping line, the one through both contacts, in metres."""
    contact = fingers.contact.take(pairs.i, axis=0)
    along = (fingers.contact.take(pairs.j, axis=0) - contact) / pairs.distance[:, None]
    return np.abs(cross(along, center - contact))


def overhang(fingers: FingerCandidates, pairs: GraspCandidates, center: FloatArray) -> FloatArray:
    """How far (p,) the centre of gravity lies beyond the contacts, along the grasping line, in metres."""
    one, other = (fingers.contact.take(k, axis=0) for k in (pairs.i, pairs.j))
    middle, along = 0.5 * (one + other), (other - one) / pairs.distance[:, None]
    return np.maximum(np.abs(dot(center - middle, along)) - 0.5 * pairs.distance, 0.0)


def ranking_cost(
    fingers: FingerCandidates,
    pairs: GraspCandidates,
    outline: Silhouette,
    center: FloatArray,
    fit: Fit,
    settings: GravitySettings,
) -> RankingCost:
    """What the pairs are ranked by: the paper's gravity distance, plus what the settings add to it.

    `center` (2,) is the object's centre of gravity in the plane of the `outline`.
    """
    distance = gravity_distance(fingers, pairs, center)
    share = share_inside(outline.loops, fingers.contact[pairs.i], fingers.contact[pairs.j])
    friction = np.minimum(pairs.required_friction, MOST_FRICTION)
    gap = settings.gap_weight * (1 - share) * pairs.distance
    in_holes = (fingers.loop[pairs.i] > 0).astype(np.float64) + (fingers.loop[pairs.j] > 0)
    cost = (
        distance
        + gap
        + settings.overhang_weight * overhang(fingers, pairs, center)
        + settings.hole_cost_m * in_holes
        + settings.width_weight * fit.width
        + settings.friction_weight_m * friction**2
    )
    if settings.lonely_cost_m > 0:
        cost = cost + settings.lonely_cost_m * _loneliness(centers(fingers, pairs, fit), pairs.axis)
    return RankingCost(distance, share, cost)


def _loneliness(middles: FloatArray, axes: FloatArray) -> FloatArray:
    """Share (p,) of small sideways misses of the hand after which it is not at another of the p grasps.

    Where the sides are parallel there is a grasp on either hand; on a bump or at an end there is none.
    """
    middle, axis = middles.astype(np.float32), axes.astype(np.float32)  # a matrix of all with all: half the work
    across = left_normal(axes).astype(np.float32)
    every = -(-len(middles) // MOST_NEIGHBOURS)
    at_along, at_aside = ((middle * way).sum(axis=1) for way in (axis, across))
    met = np.zeros((len(MISSES_M), len(middles)), dtype=np.bool_)
    for first in range(0, len(middles), every * NEIGHBOURS_AT_ONCE):
        some = slice(first, first + every * NEIGHBOURS_AT_ONCE, every)
        near = np.abs(middle[some] @ axis.T - at_along) < MISS_STEP_M
        near &= np.abs(axis[some] @ axis.T) > np.float32(np.cos(np.radians(MISS_DEG)))
        aside = middle[some] @ across.T - at_aside
        for k, miss in enumerate(MISSES_M):
            met[k] |= (near & (aside > miss - MISS_STEP_M) & (aside < miss + MISS_STEP_M)).any(axis=0)
    return np.asarray(1.0 - met.mean(axis=0))


def landing_cost(landing: Landing, settings: PlannerSettings) -> FloatArray:
    """What the way down to p pairs adds to their cost, metres (p,): shallow, tight or hidden grasps rank lower."""
    weights = settings.gravity
    shallow = np.maximum(settings.depth.good_grip_m - landing.grip, 0.0)
    tight = np.maximum(settings.hand.preshape_m - landing.margin, 0.0) ** 2 / settings.hand.preshape_m
    unseen = landing.unseen if settings.depth.unseen == "rank" else 0.0
    return np.asarray(
        weights.level_weight * landing.tip
        + weights.grip_weight * shallow
        + weights.low_grip_weight * np.maximum(settings.depth.min_grip_m - landing.grip, 0.0)
        + weights.margin_weight * tight
        + weights.unseen_weight * unseen
    )


def best_first(pairs: GraspCandidates, cost: FloatArray) -> IntArray:
    """Order (p,) of the pairs by cost; equal ones by required friction, then by index."""
    return np.lexsort((pairs.j, pairs.i, pairs.required_friction, cost))
