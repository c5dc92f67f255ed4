"""What a grasp costs: the paper's gravity distance and what people look for besides, in metres of that distance."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import dot, left_normal
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, PlaneShape
from flatgrasp_cli.profiles.settings import GravitySettings

MISSES_M, MISS_STEP_M, MISS_DEG = (-0.010, -0.005, 0.005, 0.010), 0.003, 15.0
"""Sideways misses that a grasp should forgive, metres: what an arm and its camera may be off by together. And how near
another grasp must be to where the hand is then, metres and degrees: about a step between step points, and an angle that
pads of μ = 0.3 hold."""
MOST_NEIGHBOURS, NEIGHBOURS_AT_ONCE = 500, 64
"""Grasps that each is compared with, an even sample of all: along a side they are closer together than `MISS_STEP_M`
even so. And how many of them are compared at once, which no result depends on."""
MOST_FRICTION = 10.0
"""Required friction above which more costs no more: a pair that would have to pull needs infinitely much, and its cost
should still be a number, larger than all others (10 m)."""


def grasp_cost(
    fingers: FingerCandidates, grasps: GraspCandidates, shape: PlaneShape, settings: GravitySettings
) -> FloatArray:
    """What p pairs cost on an object of that `shape`, metres (p,)."""
    friction = np.minimum(grasps.required_friction, MOST_FRICTION)
    gap = settings.gap_weight * (1 - grasps.inside_share) * grasps.distance
    in_holes = (fingers.loop[grasps.i] > 0).astype(np.float64) + (fingers.loop[grasps.j] > 0)
    cost = (
        grasps.gravity_distance
        + gap
        + settings.overhang_weight * overhang(fingers, grasps, shape.gravity_center.place)
        + settings.hole_cost_m * in_holes
        + settings.width_weight * grasps.width
        + settings.friction_weight_m * friction**2
    )
    if settings.lonely_cost_m > 0:
        cost = cost + settings.lonely_cost_m * loneliness(grasps.center, grasps.axis)
    return np.asarray(cost)


def overhang(fingers: FingerCandidates, grasps: GraspCandidates, center: FloatArray) -> FloatArray:
    """How far (p,) the centre of gravity lies beyond the contacts, along the grasping line, in metres."""
    one, other = (fingers.contact.take(k, axis=0) for k in (grasps.i, grasps.j))
    middle, along = 0.5 * (one + other), (other - one) / grasps.distance[:, None]
    return np.maximum(np.abs(dot(center - middle, along)) - 0.5 * grasps.distance, 0.0)


def loneliness(middles: FloatArray, axes: FloatArray) -> FloatArray:
    """Share (p,) of the small sideways misses of the hand that do not bring it to another of the p grasps.

    Where the sides are parallel there are other grasps on both sides; on a bump or at an end there are none.
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
