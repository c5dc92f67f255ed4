"""Robot arms: data for reach."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flatgrasp_cli.profiles.base import PositiveLength, Profile

SixNumbers = tuple[float, float, float, float, float, float]


class DenavitHartenberg(Profile):
    """Standard Denavit–Hartenberg rows, one number a joint."""

    d_m: SixNumbers
    a_m: SixNumbers
    alpha_deg: SixNumbers


class JointLimits(Profile):
    """Limits of each joint."""

    lower_deg: SixNumbers
    upper_deg: SixNumbers
    max_speed_deg_s: SixNumbers
    max_effort_nm: SixNumbers

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if any(low >= high for low, high in zip(self.lower_deg, self.upper_deg, strict=True)):
            raise ValueError("every lower_deg must be below its upper_deg")
        return self


class LinkRadii(Profile):
    """Capsule radii of the links, for clearance."""

    shoulder_m: PositiveLength
    upper_arm_m: PositiveLength
    elbow_m: PositiveLength
    forearm_m: PositiveLength
    wrist_m: PositiveLength


class CameraPose(Profile):
    """Pose of a camera's optical frame in the robot's `base_frame`."""

    position_m: tuple[float, float, float]
    orientation_xyzw: tuple[float, float, float, float]

    @model_validator(mode="after")
    def _unit(self) -> Self:
        if abs(math.hypot(*self.orientation_xyzw) - 1.0) > 1e-3:
            raise ValueError("orientation_xyzw must be a unit quaternion")
        return self


class Robot(Profile):
    """A six-joint arm of the UR family, by its Denavit–Hartenberg rows."""

    profile: Literal["robot"] = "robot"
    name: Annotated[str, Field(min_length=1)]
    base_frame: Literal["base", "base_link"]
    """`base` is the controller's (and the DH) base; ROS's `base_link` is turned by 180° about z against it."""
    dh: DenavitHartenberg
    joints: JointLimits
    links: LinkRadii
    reach_m: PositiveLength
    payload_kg: Annotated[float, Field(gt=0)]
    camera_pose: CameraPose | None = None
