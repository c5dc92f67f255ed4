"""Whether what is gripped comes up with the hand: its weight, and its turning about the pads."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray

STANDARD_GRAVITY = 9.80665
STRESS = 1.5
"""The load of lifting, as a multiple of the weight: arms speed up and slow down by half of gravity."""
MEAN_RADIUS = 0.27
"""The mean distance of a rectangle's points from its middle, in diagonals: 0.2706 of a square's, 0.25 of a line's."""


class Load(NamedTuple):
    """What p grips have to bear in s samples: `mass` (s,), kg, at `arm` (p, s), metres beside the line of the contacts.

    `beyond` (p,) is how far the object goes on from there, metres.
    """

    mass: FloatArray
    arm: FloatArray
    beyond: FloatArray


class Failures(NamedTuple):
    """(p, s): the object slips out by its weight, or it turns about the pads and so stays on the table."""

    weight: BoolArray
    turns: BoolArray


def lifting_failures(load: Load, bears: FloatArray, pads: FloatArray, lift_m: float) -> Failures:
    """How p grips fail in s samples, each pad of which bears a friction of `bears` (s,) newtons.

    `pads` (p, 2) are the width and the height that they cover, metres. Weight: 2·μ·N ≥ m·(g + a). Turning: evenly
    pressed pads bear the torque 2·μ·N·r, r being the mean distance from their middle; what turns nevertheless hangs
    down from the hand, and is not lifted if it goes on for more than the lift's height `lift_m`.
    """
    weight = load.mass * STANDARD_GRAVITY
    radius = MEAN_RADIUS * np.hypot(pads[:, 0], pads[:, 1])
    turning = 2 * bears * radius[:, None] < weight * load.arm
    too_heavy = np.broadcast_to(2 * bears < STRESS * weight, turning.shape)
    return Failures(too_heavy, turning & (load.beyond > lift_m)[:, None])
