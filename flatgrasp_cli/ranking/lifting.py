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

    By `turn` (p, s), radians, it turns about that line until it hangs; `tilt` (p, s), metres, is the arm of its weight
    about the pads' other axis, across the approach, above 0 on the side that the closing axis points to. `beyond` (p,)
    is how far the object goes on from that line, metres, on the side of its middle.
    """

    mass: FloatArray
    arm: FloatArray
    turn: FloatArray
    tilt: FloatArray
    beyond: FloatArray


class Needs(NamedTuple):
    """Friction coefficients that it takes to bear an object's weight (s,), and to keep it from turning (p, s).

    `slide` (p, s), metres, is how far what turns slides through pads whose friction is √2 of what the weight takes,
    infinite where it must not turn, and `tilt` (p, s), metres, how far apart, up and down, the forces of both pads move
    to bear the weight beside them, with the sign of the load's.
    """

    weight: FloatArray
    turning: FloatArray
    slide: FloatArray
    tilt: FloatArray


def friction_to_lift(load: Load, force_n: float, pads: FloatArray, lift_m: float) -> Needs:
    """The friction that p grips need in s samples, whose fingers press with `force_n` newtons.

    `pads` (p, 2) are the width and the height that they cover, metres. Weight: 2·μ·N ≥ m·(g + a). Turning: evenly
    pressed pads bear the torque 2·μ·N·r, r being the mean distance from their middle. What turns nevertheless hangs
    down from the hand: its centre of gravity comes up by the arm less than the lift's height `lift_m`. If it goes on
    for more than that, its far end stays where it lay, and the centre comes up by the share 1 − arm/beyond of the lift.
    What comes up by less than half is not lifted.

    What turns slides meanwhile: a pad bears the force f and the torque τ together within the limit
    surface (f / f_max)² + (τ / (r·f_max))² = 1 and slides along its normal (Goyal, Ruina & Papadopoulos, "Planar
    sliding with dry friction", Wear 143, 1991; the ellipse is Lee & Cutkosky's, 1991), that is by r·w / √(1 − w²) for
    each radian, w being the share of the friction that bears the weight.

    Tilting: the forces of both pads move to opposite ends of the height h that they hold and bear N·h, and friction
    bears μ·N·b besides, b being how far apart they are; what tilts further is levered out.
    """
    weight, radius = load.mass * STANDARD_GRAVITY / (2 * force_n), _mean_radius(pads)[:, None]
    too_low = load.arm > 0.5 * np.maximum(load.beyond, lift_m)[:, None]
    slide = np.where(too_low, np.inf, radius * load.turn)
    return Needs(STRESS * weight, weight * load.arm / radius, slide, 2 * weight * load.tilt)


def _mean_radius(pads: FloatArray) -> FloatArray:
    """The mean distance (p,) of a rectangle's points from its middle, metres, by its sides `pads` (p, 2)."""
    wide, high = np.maximum(pads, np.finfo(np.float64).eps).T  # pads that hold nothing cover no height
    return np.asarray(
        (2 * np.hypot(wide, high) + wide**2 / high * np.arcsinh(high / wide) + high**2 / wide * np.arcsinh(wide / high))
        / 12
    )
