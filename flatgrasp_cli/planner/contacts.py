"""Where the pads meet the object: not at the middle of a chord, but where the boundary bulges out."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import dot, left_normal
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.planner.hand import Fit, centers
from flatgrasp_cli.profiles.gripper import Gripper

HALF_WIDTH_AND_MORE = 0.5 + 1e-6
"""Half a finger's width, its very edges included."""


def pad_contacts(
    fingers: FingerCandidates, pairs: GraspCandidates, fit: Fit, gripper: Gripper, tolerance_m: float
) -> FloatArray:
    """The middles (p, 2, 2) of what p pairs' pads touch, of the −y jaw and of the +y jaw, in the plane.

    They lie on the pads, `fit.width` apart along the closing axis. A pad touches what of its candidate's boundary lies
    under one of the jaw's fingers and no more than `tolerance_m` below the highest point there.
    """
    center, across = centers(fingers, pairs, fit), left_normal(pairs.axis)
    touched = np.empty((len(pairs), 2, 2))
    for side, candidate, outward in ((0, pairs.i, -pairs.axis), (1, pairs.j, pairs.axis)):
        arcs = fingers.arcs[candidate] - center[:, None]
        x, y = dot(arcs, across[:, None]), dot(arcs, outward[:, None])
        offsets = np.asarray(gripper.jaws[side])
        nearest = np.abs(x[..., None] - offsets).min(axis=2)
        under = nearest <= np.maximum(HALF_WIDTH_AND_MORE * gripper.finger_width_m, nearest.min(axis=1, keepdims=True))
        highest = np.where(under, y, -np.inf).max(axis=1, keepdims=True)
        touches = under & (y >= highest - tolerance_m)
        aside = np.where(touches, x, 0.0).sum(axis=1) / touches.sum(axis=1)
        touched[:, side] = center + aside[:, None] * across + 0.5 * fit.width[:, None] * outward
    return touched
