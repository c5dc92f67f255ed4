"""Beyond the paper: what the settings say of objects on a support plane, and of proofs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from flatgrasp_cli.profiles.base import Component, Derived, Length, Profile, Share, Size, Step, not_zero


class DepthSettings(Profile):
    """Over a support plane: how deep the fingertips go, and what they and the palm keep clear of."""

    table_clearance_m: Length
    """Free space between fingertips and support plane, metres, and between them and the middle of a low object."""
    min_clearance_m: Length
    """The least free space over the support plane, metres, for an object that is too low for both."""
    palm_clearance_m: Derived
    """Free space between the palm and whatever is highest below it, metres; null: as over the table."""
    obstacle_clearance_m: Length
    """Free space between fingertips and what lies below them, metres."""
    min_grip_m: Size
    """Least height of the pads on the object, metres; half of the object's height where that is less."""
    slice_step_m: Step
    """Outlines are taken at levels this far apart, metres."""
    wall_drop: Annotated[float, Field(ge=0, le=20)]
    """Least steepness of the object below the fingertips, a ratio of height to breadth: a flatter flank would push the
    fingers off."""
    unseen: Literal["rank", "refuse", "ignore"]
    """Finger places that no ray reached, in the object's shadow: hold less probably, are refused, or count as free."""
    approach_m: Length
    """From the pre-grasp pose to the grasp, along the approach, metres."""
    lift_m: Length
    """From the grasp to the lift pose, along the support plane's normal, metres."""


LEAST_TILT_DEG = 5.0
"""A direction that differs by less from straight down is that, degrees: hands are turned by as much by mistake."""


class ApproachSettings(Profile):
    """Beyond the paper: from where the hand comes to what it cannot grasp from straight above."""

    directions: Literal["auto", "top", "view", "any"] | tuple[Component, Component, Component]
    """Straight down, and from other sides where that is not `enough` (auto); straight down alone; along the sensor's
    view; whichever of all is best; or as this vector of any length points, in the cloud's frame."""
    enough: Share
    """A grasp whose probability of success is at least this share of 1 ends the search for a better direction."""
    tilts_deg: tuple[Annotated[float, Field(ge=LEAST_TILT_DEG, le=90)], ...]
    """How far from straight down, degrees: each only if those before it leave nothing that is enough. Empty: none."""
    max_tilt_deg: Annotated[float, Field(ge=0, le=90)]
    """The largest angle to straight down, degrees, whatever the direction follows from."""
    around: Annotated[int, Field(ge=1, le=36)]
    """The number of sides from which it is tried at each tilt."""
    hidden_share: Share
    """Largest share of the space that an aslant hand moves through that the sensor did not see."""

    @field_validator("directions")
    @classmethod
    def _direction(cls, directions: str | tuple[float, float, float]) -> str | tuple[float, float, float]:
        return directions if isinstance(directions, str) else not_zero(directions)


class VarietySettings(Profile):
    """Beyond the paper: how much the listed grasps of an object differ."""

    apart_m: Length
    """Of two grasps nearer than this to each other, metres, and turned by less than `apart_deg`, the better one is
    listed; 0: all are."""
    apart_deg: Annotated[float, Field(ge=0, le=90)]
    """The least angle between the closing axes of two grasps at about one place, degrees."""


class RankingSettings(Profile):
    """Which of an object's grasps is best."""

    prefer: Literal["success", "gravity_distance", "cage"]
    """The grasp that most probably holds; the paper's, nearest to the centre of gravity; or grasps with a cage first,
    of those the one that forgives the largest miss."""


class CagingSettings(Profile):
    """Beyond the paper: within which openings the object cannot get away."""

    certify: bool
    """Whether the best grasps get certificates."""
    mass_kg: Annotated[float, Field(ge=1e-4, le=1e4)] | None
    """The object's mass, kilograms, for the margins of lifting it; None: not known."""
    require: bool
    """Whether a grasp without a cage is none."""
    considered: Annotated[int, Field(ge=1, le=1000)]
    """The number of the best grasps that compete when cages decide."""
    closing: Literal["inward", "outward"]
    """Whether the fingers close on the object or open in a notch or a hole of it."""
    tolerance_m: Derived
    """How far the outline may be simplified, metres, null: `uncertainty.outline_m`; more if it has more
    than `max_vertices` then."""
    max_vertices: Annotated[int, Field(ge=8, le=1000)]
    """Largest number of the outline's vertices: time grows with their square."""
    noise_m: Derived
    """By how much the outline may be wrong in the guaranteed limits, metres; null: 1.5 times as much as
    `uncertainty.outline_m`."""
    told_apart_m: Derived
    """Grasps less deep than this, metres, from their width to the opening that leads to the next one, count as one;
    null: twice `noise_m`."""
