"""Whether what is gripped comes up with the hand: its weight, and its turning about the pads."""

from __future__ import annotations

from typing import NamedTuple

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels import lifting as kernels

STANDARD_GRAVITY = 9.80665
STRESS = 1.5
"""The load of lifting, as a multiple of the weight: arms speed up and slow down by half of gravity."""


class Load(NamedTuple):
    """An object that is lifted, in s samples of what is not known of it.

    The centre of its box of this `size` (3,), metres, is the plane's origin, and its centre of gravity is about
    `middle` (2,). Really it pulls at `pulls` (s, 2), with the weight of `mass` (s,), kg, along the unit vector `down`
    (3,): to a hand that comes aslant the object's middle may lie beside the contacts by being deeper.
    """

    size: FloatArray
    middle: FloatArray
    pulls: FloatArray
    mass: FloatArray
    down: FloatArray


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


def friction_to_lift(load: Load, hands: FloatArray, grips: FloatArray, force_n: float, lift_m: float) -> Needs:
    """The friction that p grips need in s samples, whose fingers press with `force_n` newtons.

    The `grips` (p, 7) are the centre, the closing axis, the height of the fingertips, and the width and the height that
    the pads cover, metres; really `hands` (p, s, 5) stand there, rows of centre, closing axis and half the opening.
    Weight: 2·μ·N ≥ m·(g + a). Turning, about the line of the contacts, by the arm of the weight beside that: evenly
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
    weight = load.mass * STANDARD_GRAVITY / (2 * force_n)
    turning, slide, tilt = kernels.needs(hands, grips, load.size, load.middle, load.pulls, weight, load.down, lift_m)
    return Needs(STRESS * weight, turning, slide, tilt)
