"""Robot arms: data for reach."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flatgrasp_cli.profiles.base import FarPlace, Place, Profile, Size, Turn
from flatgrasp_cli.profiles.chain import Chain, Lock
from flatgrasp_cli.profiles.uncertainty import HandUncertainty

SixPlaces = tuple[Place, Place, Place, Place, Place, Place]
SixTurns = tuple[Turn, Turn, Turn, Turn, Turn, Turn]
Most = Annotated[float, Field(ge=0, le=1e6)]
Turns = Annotated[tuple[Turn, ...], Field(min_length=6, max_length=7)]
Mosts = Annotated[tuple[Most, ...], Field(min_length=6, max_length=7)]
SIX, SEVEN = 6, 7
UR_BASES = ("base", "base_link")
SHORTEST_LINK_M = 0.01
UR_ALPHA_DEG: SixTurns = (90.0, 0.0, 0.0, 90.0, -90.0, 0.0)
"""The twists that make the lift, elbow and wrist 1 axes parallel, on which the closed-form kinematics rests."""


class DenavitHartenberg(Profile):
    """Standard Denavit–Hartenberg rows, one number a joint."""

    d_m: SixPlaces
    """Offsets d along z of the frame before, metres."""
    a_m: SixPlaces
    """Link lengths a along x, metres."""
    alpha_deg: SixTurns
    """Twists α about x, degrees."""

    @model_validator(mode="after")
    def _of_the_family(self) -> Self:
        (_, d2, d3, *_), (a1, a2, a3, *rest) = self.d_m, self.a_m
        if (d2, d3, a1, *rest) != (0.0,) * 6 or self.alpha_deg != UR_ALPHA_DEG:
            raise ValueError(
                "only arms of the UR family are known: d_m 2 and 3 and a_m 1, 4, 5 and 6 must be 0, "
                f"alpha_deg {list(map(int, UR_ALPHA_DEG))}"
            )
        if min(abs(a2), abs(a3)) < SHORTEST_LINK_M:
            raise ValueError(f"a_m 2 and 3, the lengths of upper arm and forearm, must be {SHORTEST_LINK_M} m at least")
        return self


class JointLimits(Profile):
    """Limits of each joint."""

    lower_deg: Turns
    """Least angles, degrees."""
    upper_deg: Turns
    """Largest angles, degrees."""
    max_speed_deg_s: Mosts
    """Largest speeds, degrees a second."""
    max_effort_nm: Mosts
    """Largest torques, newton metres."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if any(low >= high for low, high in zip(self.lower_deg, self.upper_deg, strict=False)):
            raise ValueError("every lower_deg must be below its upper_deg")
        return self


class LinkRadii(Profile):
    """Capsule radii of the links; elbow, forearm and wrist stay at least that far above a table."""

    shoulder_m: Size
    """Of the shoulder, metres."""
    upper_arm_m: Size
    """Of the upper arm, metres."""
    elbow_m: Size
    """Of the elbow, metres."""
    forearm_m: Size
    """Of the forearm, metres."""
    wrist_m: Size
    """Of the three wrist links, metres."""


class ReachSettings(Profile):
    """How a grasp is approached and lifted, and what the arm must keep on the way."""

    reference_deg: Turns
    """Joint angles of the arm's usual stance, degrees: of several ways to reach a grasp the nearest to it is taken."""
    steps: Annotated[int, Field(ge=1, le=1000)]
    """The number of waypoints from the pre-grasp pose to the grasp, and again from there to the end of the lift."""
    max_step_deg: Annotated[float, Field(ge=0.1, le=180)]
    """The most that a joint may turn from one waypoint to the next, degrees."""
    min_manipulability_share: Annotated[float, Field(ge=0, lt=1)]
    """Least manipulability, as a share of the arm's largest."""


class CameraPose(Profile):
    """Pose of a camera's optical frame in the robot's `base_frame`."""

    position_m: tuple[FarPlace, FarPlace, FarPlace]
    """Where its origin is: x, y, z in metres."""
    orientation_xyzw: tuple[float, float, float, float]
    """How it is turned: a unit quaternion [x, y, z, w]."""

    @model_validator(mode="after")
    def _unit(self) -> Self:
        if abs(math.hypot(*self.orientation_xyzw) - 1.0) > 1e-3:
            raise ValueError("orientation_xyzw must be a unit quaternion")
        return self

    def half_turned(self) -> CameraPose:
        """The same pose seen from a base turned by 180° about z: from `base` in `base_link`, or back."""
        (x, y, z), (qx, qy, qz, qw) = self.position_m, self.orientation_xyzw
        return CameraPose(position_m=(-x, -y, z), orientation_xyzw=(-qy, qx, qw, -qz))


class Robot(Profile):
    """An arm: one of the UR family by its Denavit–Hartenberg rows, or any other by its chain of joints."""

    profile: Literal["robot"] = "robot"
    """What kind of profile this is."""
    name: Annotated[str, Field(min_length=1)]
    """The robot's name."""
    base_frame: Annotated[str, Field(min_length=1)]
    """The frame of its base. Of a UR arm, `base` is the controller's (and the DH) base; ROS's `base_link` is turned by
    180° about z against it."""
    dh: DenavitHartenberg | None = None
    """The links and joints of a UR arm; None: `chain` has them."""
    chain: Chain | None = None
    """The joints of any other arm; None: `dh` has them."""
    lock: Lock | None = None
    """Which of seven joints is tried at several values; None with six."""
    joints: JointLimits
    """What its joints can do."""
    links: LinkRadii
    """How thick its links are."""
    reach: ReachSettings
    """What counts as reached."""
    reach_m: Size
    """How far the arm reaches by its data sheet, metres; for people, reach is computed."""
    payload_kg: Annotated[float, Field(ge=1e-3, le=1e4)] | None = None
    """What it lifts by its data sheet, kilograms; None: not known."""
    camera_pose: CameraPose | None = None
    """Where the camera stands in `base_frame`, unless a pose is given with the clouds; None: not known."""
    uncertainty: HandUncertainty | None = None
    """How well its hand's place is known, where that is better or worse than usual."""

    @model_validator(mode="after")
    def _has_one_kind_of_joints(self) -> Self:
        if (self.dh is None) == (self.chain is None):
            raise ValueError("dh, the rows of a UR arm, or chain, the joints of any other: one of them is wanted")
        if self.dh is not None and self.base_frame not in UR_BASES:
            raise ValueError(f"base_frame {self.base_frame!r}: of a UR arm it is one of {', '.join(UR_BASES)}")
        if (self.lock is None) != (self.count == SIX):
            raise ValueError("lock: an arm of seven joints needs it, one of six must not have it")
        return self

    @model_validator(mode="after")
    def _counts_its_joints(self) -> Self:
        lists = (*self.joints.model_dump().values(), self.reach.reference_deg)
        if any(len(values) != self.count for values in lists):
            raise ValueError(f"joints and reach.reference_deg want a number for each of the {self.count} joints")
        return self

    @property
    def count(self) -> int:
        """The number of joints."""
        return SIX if self.chain is None else len(self.chain.joints)

    @model_validator(mode="after")
    def _stands_within_limits(self) -> Self:
        limits = zip(self.joints.lower_deg, self.reach.reference_deg, self.joints.upper_deg, strict=False)
        if any(not low <= reference <= high for low, reference, high in limits):
            raise ValueError("every reference_deg must lie within its joint's limits")
        return self
