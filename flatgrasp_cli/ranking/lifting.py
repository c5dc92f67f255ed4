"""Whether what is gripped comes up with the hand: its weight, and its turning about the pads."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray

STANDARD_GRAVITY = 9.80665
STRESS = 1.5
"""The load of lifting, as a multiple of the weight: arms speed up and slow down by half of gravity."""


class Load(NamedTuple):
    """What p grips have to bear in s samples: `mass` (s,), kg, at `arm` (p, s), metres beside the line of the contacts.

    `beyond` (p,) is how far the object goes on from there, metres.
    """

    mass: FloatArray
    arm: FloatArray
    beyond: FloatArray


class Needs(NamedTuple):
    """Friction coefficients that it takes to bear an object's weight (s,), and to keep it from turning (p, s)."""

    weight: FloatArray
    turning: FloatArray


def friction_to_lift(load: Load, force_n: float, pads: FloatArray, lift_m: float) -> Needs:
    """The friction that p grips need in s samples, whose fingers press with `force_n` newtons.

    `pads` (p, 2) are the width and the height that they cover, metres. Weight: 2·μ·N ≥ m·(g + a). Turning: evenly
    pressed pads bear the torque 2·μ·N·r, r being the mean distance from their middle; what turns nevertheless hangs
    down from the hand, and is lifted all the same unless it goes on for more than the lift's height `lift_m`.
    """
    weight = load.mass * STANDARD_GRAVITY / (2 * force_n)
    turning = weight * load.arm / _mean_radius(pads)[:, None]
    stays = (load.beyond > lift_m)[:, None]
    return Needs(STRESS * weight, np.where(stays, turning, 0.0))


def _mean_radius(pads: FloatArray) -> FloatArray:
    """The mean distance (p,) of a rectangle's points from its middle, metres, by its sides `pads` (p, 2)."""
    wide, high = np.maximum(pads, np.finfo(np.float64).eps).T  # pads that hold nothing cover no height
    return np.asarray(
        (2 * np.hypot(wide, high) + wide**2 / high * np.arcsinh(high / wide) + high**2 / wide * np.arcsinh(wide / high))
        / 12
    )
