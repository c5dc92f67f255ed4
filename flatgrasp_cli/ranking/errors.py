"""How far the hand may miss, and what of the object is not known: one set of samples for all grasps."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from statistics import NormalDist

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels.trial import suffices
from flatgrasp_cli.profiles.uncertainty import Uncertainty

PRIMES = np.array([2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0])
"""One for each of a sample's numbers."""


@dataclass(frozen=True, eq=False)
class Errors:
    """All that is not known, s samples of it.

    The hand misses by `across` its closing axis, `along` it and in `height` (s,), metres, and is turned by `yaw` (s,),
    radians. The object's sides are off by `outline`
    (s,), in standard deviations, its centre of gravity by `center` (s, 2), as a share of its length, and its mass is
    that of `density` (s,), kg/m³. `luck` (s,), 0 to 1, tells how much of what may be there really is.
    """

    across: FloatArray
    along: FloatArray
    height: FloatArray
    yaw: FloatArray
    outline: FloatArray
    center: FloatArray
    density: FloatArray
    luck: FloatArray

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.yaw)

    @cached_property
    def along_apart(self) -> FloatArray:
        """How far the hand misses along its closing axis, either way (s,), the least first."""
        return np.sort(np.abs(self.along))

    @cached_property
    def misses(self) -> FloatArray:
        """How far the hand misses across its closing axis and along it, and cosine and sine of its turn (s, 4)."""
        return np.column_stack([self.across, self.along, np.cos(self.yaw), np.sin(self.yaw)])


@lru_cache(maxsize=8)
def errors_of(unsure: Uncertainty, seed: int, first: int = 0, last: int | None = None) -> Errors:
    """The samples of the stated errors, from the `first` to before the `last`.

    They are the same for the same settings and seed, on any machine.
    """
    if first > 0 or last is not None:
        everything = errors_of(unsure, seed)
        return Errors(**{each.name: getattr(everything, each.name)[first:last] for each in fields(Errors)})
    *rows, density, luck = _sequence(unsure.samples, seed).T
    inverse = NormalDist().inv_cdf
    across, along, height, yaw, *center, outline = np.array([[inverse(value) for value in row] for row in rows])
    low, high = unsure.density_kg_m3
    return Errors(
        across=unsure.position_m * across,
        along=unsure.position_m * along,
        height=unsure.height_m * height,
        yaw=np.radians(unsure.yaw_deg) * yaw,
        outline=outline,
        center=unsure.center_share * np.column_stack(center),
        density=low + (high - low) * density,
        luck=luck,
    )


def friction_suffices(need: FloatArray, friction: float, unsure: Uncertainty) -> FloatArray:
    """How probable it is (n,) that pads have the friction that grasps `need` (n,), if about `friction` is meant."""
    return suffices(need, friction, unsure.friction_share)


def _sequence(count: int, seed: int) -> FloatArray:
    """Points (count, d) spread evenly in the unit cube, strictly inside it.

    Richtmyer's sequence: multiples of the primes' square roots, modulo 1, from a start that the seed gives. scipy's
    Sobol points are no better for so few, and importing scipy.stats takes longer than a plan.
    """
    start = np.random.default_rng(seed).random(len(PRIMES))
    steps = np.sqrt(PRIMES)
    points = np.mod(start + np.arange(1, count + 1)[:, None] * steps, 1.0)
    least = np.finfo(np.float64).eps  # the normal distribution ends at the cube's faces
    return np.asarray(np.clip(points, least, 1 - least))
