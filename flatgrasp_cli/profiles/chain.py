"""An arm's joints one after the other, as a URDF has them."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from flatgrasp_cli.profiles.base import Place, Profile, Turn

Part = Annotated[float, Field(ge=-1, le=1)]


class FramePlace(Profile):
    """Where a frame is in the one before it."""

    xyz_m: tuple[Place, Place, Place]
    """Its origin: x, y, z in metres."""
    rpy_deg: tuple[Turn, Turn, Turn] = (0.0, 0.0, 0.0)
    """How it is turned about the fixed axes x, y, z, in this order, degrees."""


class JointPlace(FramePlace):
    """Where a joint is in the frame of the joint before it, the first in the base frame; all joints at 0."""

    axis: tuple[Part, Part, Part] = (0.0, 0.0, 1.0)
    """What it turns about, in its own frame: a unit vector."""

    @model_validator(mode="after")
    def _unit(self) -> Self:
        if abs(math.hypot(*self.axis) - 1.0) > 1e-6:
            raise ValueError("axis must be a unit vector")
        return self


class Chain(Profile):
    """Six or seven turning joints, base to wrist, and the flange."""

    joints: Annotated[tuple[JointPlace, ...], Field(min_length=6, max_length=7)]
    """The joints' places."""
    flange: FramePlace
    """The flange's place in the frame of the last joint, z out of it."""


class Lock(Profile):
    """How the joint too many of a seven-joint arm is dealt with: it is tried at several values, and kept on the way."""

    joint: Annotated[int, Field(ge=1, le=7)] | None = None
    """The number of that joint, from 1 at the base: one without which the others have a closed form. None: the last,
    the third, or another for which they do."""
    values: Annotated[int, Field(ge=1, le=100)]
    """The number of its values, evenly spaced within its limits, or over a turn if they are wider."""
