"""Where the pads meet the object: not at the middle of a chord, but where the boundary bulges out."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.kernels.contacts import touched_aside
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import HandSettings

HALF_WIDTH_AND_MORE = 0.5 + 1e-6
"""Half a finger's width, as a share of it: rounding must not lose a point that lies exactly on the finger's edge."""


def touching(
    grasps: GraspCandidates, fingers: FingerCandidates, gripper: Gripper, settings: HandSettings
) -> GraspCandidates:
    """The final grasps with what their pads touch, and how far the boundary strays from them."""
    width = np.stack([fingers.width[grasps.i], fingers.width[grasps.j]], axis=1)
    return grasps.having(
        contacts=pad_contacts(fingers, grasps, gripper, settings.contact_tolerance_m),
        touched_m=np.minimum(gripper.finger_width_m, width),  # a small object meets less of the pads
        variance=fingers.variance[grasps.i] + fingers.variance[grasps.j],
        arc_ratio=np.maximum(fingers.arc_ratio[grasps.i], fingers.arc_ratio[grasps.j]),
    )


def pad_contacts(
    fingers: FingerCandidates, grasps: GraspCandidates, gripper: Gripper, tolerance_m: float
) -> FloatArray:
    """The middles (p, 2, 2) of what p pairs' pads touch, of the −y jaw and of the +y jaw, in the plane.

    They lie on the pads, the object's width apart along the closing axis. A pad touches the part of its candidate's
    boundary that lies under one of the jaw's fingers, no more than `tolerance_m` below the highest point there.
    """
    center, width, across = grasps.center, grasps.width, left_normal(grasps.axis)
    half = HALF_WIDTH_AND_MORE * gripper.finger_width_m
    touched = np.empty((len(grasps), 2, 2))
    for side, candidate, sign in ((0, grasps.i, -1.0), (1, grasps.j, 1.0)):
        outward, jaw = sign * grasps.axis, sign * np.asarray(gripper.jaws[side])
        hands = np.concatenate([center, outward], axis=1)
        aside = sign * touched_aside(hands, fingers.arcs, candidate, jaw, half, tolerance_m)
        touched[:, side] = center + aside[:, None] * across + 0.5 * width[:, None] * outward
    return touched
