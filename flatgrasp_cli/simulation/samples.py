"""The objects of the paper's figures 18 and 20 as solids, lying on the table z = 0; metres, true scale.

Their masses are those of such things in a shop, in kilograms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flatgrasp_cli.simulation.solids import Solid, box, ellipsoid, ring, rod, turned


@dataclass(frozen=True, slots=True)
class Sample:
    """An object of the paper: how it is made, and what it weighs."""

    solids: Callable[[], Sequence[Solid]]
    mass_kg: float


def teddy_bear() -> list[Solid]:
    """A bear 26 cm tall on its back."""
    return [
        ellipsoid((0.048, 0.058, 0.035), (0, 0, 0.035)),
        ellipsoid((0.040, 0.037, 0.034), (0, 0.085, 0.034)),
        ellipsoid((0.016, 0.014, 0.009), (0, 0.080, 0.068)),
        *(ellipsoid((0.015, 0.015, 0.010), (s * 0.032, 0.116, 0.034)) for s in (-1, 1)),
        *(ellipsoid((0.045, 0.017, 0.017), (s * 0.070, 0.030, 0.030), s * 20) for s in (-1, 1)),
        *(ellipsoid((0.020, 0.052, 0.020), (s * 0.036, -0.085, 0.026), s * 14) for s in (-1, 1)),
    ]


def electric_drill() -> list[Solid]:
    """A cordless drill on its side."""
    return [
        rod(0.029, 0.150, (0, 0, 0.030)),
        rod(0.021, 0.030, (0.090, 0, 0.030)),
        rod(0.014, 0.030, (0.118, 0, 0.030)),
        rod(0.003, 0.060, (0.160, 0, 0.030)),
        box((0.040, 0.125, 0.034), (-0.040, -0.075, 0.030), -10),
        box((0.090, 0.045, 0.058), (-0.040, -0.150, 0.030), 0),
    ]


def pistol() -> list[Solid]:
    """A pistol on its side, with a trigger guard."""
    return [
        box((0.190, 0.030, 0.026), (0, 0, 0.015)),
        box((0.120, 0.020, 0.022), (0.030, -0.020, 0.015)),
        box((0.044, 0.105, 0.028), (-0.075, -0.060, 0.015), -14),
        ring(0.020, 0.004, (-0.022, -0.045, 0.015)),
        box((0.006, 0.020, 0.006), (-0.022, -0.036, 0.015), 15),
    ]


def spray_bottle() -> list[Solid]:
    """A trigger spray bottle on its side."""
    body = [(0.0, 0.0), (0.034, 0.0), (0.036, 0.005), (0.036, 0.110), (0.030, 0.130), (0.014, 0.150), (0.013, 0.170)]
    lower, upper = [*body[:6], (0.0, 0.150)], [(0.0, 0.150), *body[5:], (0.0, 0.170)]
    return [
        turned(body, [lower, upper], (-0.090, 0, 0.036), (0, 90, 0)),
        box((0.030, 0.030, 0.028), (0.093, 0, 0.036)),
        box((0.026, 0.085, 0.026), (0.118, -0.015, 0.036)),
        rod(0.008, 0.016, (0.118, -0.062, 0.036), 90),
        box((0.050, 0.010, 0.014), (0.085, -0.040, 0.036), 25),
    ]


def pan() -> list[Solid]:
    """A frying pan of 20 cm with a hanging hole in its handle."""
    outline = [(0.0, 0.004), (0.080, 0.004), (0.097, 0.040), (0.100, 0.040), (0.083, 0.0), (0.0, 0.0)]
    bottom, wall = [outline[0], outline[1], outline[4], outline[5]], outline[1:5]
    return [
        turned(outline, [bottom, wall], (0, 0, 0)),
        box((0.130, 0.024, 0.012), (0.160, 0, 0.036)),
        ring(0.018, 0.007, (0.243, 0, 0.036)),
    ]


def hammer() -> list[Solid]:
    """A claw hammer."""
    return [
        rod(0.016, 0.250, (-0.020, 0, 0.014), 0, 0.8),
        box((0.030, 0.070, 0.028), (0.115, 0.005, 0.014)),
        rod(0.015, 0.030, (0.115, -0.045, 0.015), 90),
        *(box((0.011, 0.055, 0.016), (0.115 + s * 0.010, 0.063, 0.014), s * 8) for s in (-1, 1)),
    ]


def juice_box() -> list[Solid]:
    """A 0.2 l juice box with its straw."""
    return [box((0.118, 0.048, 0.038), (0, 0, 0.019)), rod(0.003, 0.045, (0.070, 0.012, 0.030), 20)]


SAMPLES = {
    "teddy_bear": Sample(teddy_bear, 0.20),
    "electric_drill": Sample(electric_drill, 1.00),
    "pistol": Sample(pistol, 0.40),
    "spray_bottle": Sample(spray_bottle, 0.50),
    "pan": Sample(pan, 0.70),
    "hammer": Sample(hammer, 0.60),
    "juice_box": Sample(juice_box, 0.22),
}
"""By the names of their clouds in sample_data; the first five are those of the paper's simulation."""
