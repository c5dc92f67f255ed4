"""Beyond the paper: what the settings say of the scene."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from flatgrasp_cli.profiles.base import Angle, Component, FarPlace, Profile, Share, Size, not_zero


class SceneSettings(Profile):
    """Beyond the paper: the support plane and the objects on it."""

    mode: Literal["auto", "object", "table", "bin"]
    """Whether the cloud shows one object alone, objects on a support plane or things in a bin; auto: judged by
    the cloud."""
    crop: tuple[FarPlace, FarPlace, FarPlace, FarPlace, FarPlace, FarPlace] | None
    """Region of interest: x_min, x_max, y_min, y_max, z_min, z_max in metres; what lies outside does not exist."""
    select: Literal["all", "nearest", "largest"] | tuple[FarPlace, FarPlace]
    """Which objects are planned: all, the one nearest to the sensor, the largest, or the one nearest to (x, y) in
    metres, none where that is farther away than the nearest is long."""
    up: tuple[Component, Component, Component] | None
    """Normal of the support plane, roughly, in the cloud's frame, a vector of any length; None: the biggest plane
    facing the sensor."""
    max_tilt_deg: Angle
    """How far the support plane's normal may lie from `up`, degrees."""
    max_view_deg: Angle
    """Without `up`: how far it may lie from the direction to the sensor, degrees."""
    min_plane_share: Share
    """Share of the points that a support plane has at least."""
    min_height_m: Size
    """Least height of an object, metres; more where the support plane's own cells scatter as high as that."""
    min_size_m: Size
    """Objects whose footprint is smaller than a square of this side, metres, are taken for outliers."""
    max_size_m: Size
    """A surface that goes on without a seam for longer than this, in metres, is no object but an obstacle."""
    seam_deg: Annotated[float, Field(ge=5, le=180)]
    """A concave bend of more than this, degrees, parts two objects that touch; 180: none does."""
    seam_color: Annotated[float, Field(ge=1, le=300)] | None
    """The difference of colours, a number in the units of a and b of CIE Lab, of which 2.3 can just be seen, that parts
    objects whose surfaces are flush, in coloured clouds; None: colours part nothing, for prints differ as much."""
    least_part_m: Size
    """What touches another object and is smaller than a square of this side, metres, is a part of that."""

    @field_validator("crop")
    @classmethod
    def _ordered(cls, crop: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if crop is not None and not all(low < high for low, high in zip(crop[::2], crop[1::2], strict=True)):
            raise ValueError("every minimum must be below its maximum")
        return crop

    @field_validator("up")
    @classmethod
    def _direction(cls, up: tuple[float, float, float] | None) -> tuple[float, float, float] | None:
        return None if up is None else not_zero(up)
