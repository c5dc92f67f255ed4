"""How far a hand may miss, and what is not known of the object that it closes on."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Annotated

from pydantic import Field, field_validator

from flatgrasp_cli.profiles.base import Length, Profile

Spread = Annotated[float, Field(ge=0, lt=1)]
"""A share to either side, or a chance; 0 switches it off."""
Density = Annotated[float, Field(ge=1, le=25_000)]
"""Kilograms per cubic metre: no lighter than foam, and a little heavier than gold."""


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """The figures themselves; those that are usual where nobody knows better."""

    position_m: float = 0.005
    """What an arm and a camera that were calibrated to one another miss by."""
    height_m: float = 0.002
    """Over a table that both see."""
    yaw_deg: float = 5.0
    """As far as a hand's calibration and the way of a grasped thing turn it."""
    friction_share: float = 0.4
    """Rubber on what people handle has a friction of 0.3 to 0.7."""
    outline_m: float = 0.001
    """What a silhouette is known to at 0.8 m, an Xtion's noise."""
    density_kg_m3: tuple[float, float] = (200.0, 1200.0)
    """Boxes of cereals, and full bottles or tools with their hollows."""
    center_share: float = 0.1
    """A handle of half an object's length puts the centre of gravity so far towards the head."""
    occupied_share: float = 0.05
    """In the shadow beside an object there is seldom anything."""
    force_n: float = 40.0
    """Hands of this size press with 30 to 235 N."""
    samples: int = 128
    """One of them is then less than what counts as equal, a hundredth."""


class HandUncertainty(Profile):
    """What an arm's or a hand's own profile may say of how well it is known; None: not known."""

    position_m: Length | None = None
    """Standard deviation of the hand's place in the plane across the approach, on each axis, metres: calibration of arm
    and camera together."""
    height_m: Length | None = None
    """Standard deviation of the fingertips' place along the approach, metres."""
    yaw_deg: Annotated[float, Field(ge=0, le=90)] | None = None
    """Standard deviation of the hand's turn about the approach, degrees."""
    friction_share: Spread | None = None
    """The pads' friction is evenly distributed within this share of what is counted on, to either side."""


class UncertaintySettings(HandUncertainty):
    """All that is not known when a hand closes; None: the gripper's profile, the robot's, or the usual figure."""

    outline_m: Length | None = None
    """Standard deviation of where the object's sides are, metres: the sensor's noise."""
    density_kg_m3: tuple[Density, Density] | None = None
    """The least and the largest mean density of objects, with their hollows, kilograms per m³, unless the mass is known
    (`caging.mass_kg`)."""
    center_share: Spread | None = None
    """Standard deviation of the centre of gravity, as a share of the object's length, on each axis."""
    occupied_share: Spread | None = None
    """The share of places that no ray of the sensor reached in which something stands."""
    force_n: Annotated[float, Field(ge=0.01, le=1e5)] | None = None
    """With what force the fingers press, newtons; None: with the `max_force_n` of the gripper's profile."""
    samples: Annotated[int, Field(ge=1, le=4096)] | None = None
    """The number of times that each grasp which may win is tried in thought."""

    @field_validator("density_kg_m3")
    @classmethod
    def _rising(cls, density: tuple[float, float] | None) -> tuple[float, float] | None:
        if density is not None and density[0] > density[1]:
            raise ValueError("the least density comes first, then the largest")
        return density

    @property
    def figures(self) -> Uncertainty:
        """The figures, the usual ones for what is None."""
        return _figures(self)

    def resolved(self, *known: HandUncertainty | None) -> UncertaintySettings:
        """The same without None: what the first of the profiles `known` tells of it, or the usual figure."""
        told: dict[str, object] = {}
        for one in (self, *known):
            values = {} if one is None else one.model_dump(exclude_none=True)
            told = {**values, **told}
        return self.model_copy(update={**asdict(Uncertainty()), **told})


@lru_cache(maxsize=8)
def _figures(settings: UncertaintySettings) -> Uncertainty:
    return Uncertainty(**{name: value for name, value in settings.model_dump().items() if value is not None})
