"""Settings of the planner, section by section of the paper. `null` (None) means: derive it, as the comment says."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, field_validator

from flatgrasp_cli.profiles.base import FarPlace, Length, Profile, Size, Step
from flatgrasp_cli.profiles.gripper import Gripper

Angle = Annotated[float, Field(ge=0.01, le=180)]
Weight = Annotated[float, Field(ge=0, le=100)]
Share = Annotated[float, Field(ge=1e-4, lt=1)]
Friction = Annotated[float, Field(ge=0.01, le=5)]
Component = Annotated[float, Field(ge=-1e6, le=1e6)]


class SceneSettings(Profile):
    """Before the paper: the support plane and the objects on it."""

    mode: Literal["auto", "object", "table"]
    """Whether the cloud shows one object alone or objects on a support plane; auto: as the cloud says."""
    crop: tuple[FarPlace, FarPlace, FarPlace, FarPlace, FarPlace, FarPlace] | None
    """Region of interest: x_min, x_max, y_min, y_max, z_min, z_max in metres; what lies outside does not exist."""
    select: Literal["all", "nearest", "largest"] | tuple[FarPlace, FarPlace]
    """Which objects are planned: all, the one nearest to the sensor, the largest, or the one nearest to (x, y) in
    metres."""
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
    """Least height of an object, metres."""
    noise_factor: Annotated[float, Field(ge=1, le=20)]
    """An object stands this many times the standard deviation of the support plane's raster above it."""
    gap_m: Length
    """Parts of an object may be this far apart, metres; objects closer than this count as one."""
    min_size_m: Size
    """Objects whose footprint is smaller than a square of this side, metres, are taken for outliers."""
    max_size_m: Size
    """What is longer, in metres, is no object but furniture, and only an obstacle."""

    @field_validator("crop")
    @classmethod
    def _ordered(cls, crop: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if crop is not None and not all(low < high for low, high in zip(crop[::2], crop[1::2], strict=True)):
            raise ValueError("every minimum must be below its maximum")
        return crop

    @field_validator("up")
    @classmethod
    def _direction(cls, up: tuple[float, float, float] | None) -> tuple[float, float, float] | None:
        if up is not None and math.hypot(*up) < 1e-6:
            raise ValueError("must not be zero")
        return up


class MainPlaneSettings(Profile):
    """§III.A.1: the oriented bounding box."""

    method: Literal["pca", "min_area"]
    """In-plane axes: covariance eigenvectors (the paper's PCL) or the smallest rectangle around the projection."""


class SilhouetteSettings(Profile):
    """§III.A.2: the concave hull."""

    alpha_m: Step | None
    """Radius α of the hull's empty discs, metres; None: from the points' spacing."""
    min_coverage: Annotated[float, Field(ge=0.01, le=1)]
    """α grows until the largest piece holds this share of the points."""
    tolerance_m: Length
    """How far the outline may be simplified (Douglas–Peucker), metres."""
    min_hole_m: Length
    """Holes whose area is less than that of a disc of this diameter, metres, are taken for missing pixels and filled.
    """
    inner_loops: bool
    """Whether fingers may stand on the edges of holes."""


class FingerSettings(Profile):
    """§III.A.3: step points, finger candidates, grasping directions."""

    step: Literal["chord", "arc_length"]
    """Step points lie `step_m` apart in a straight line (eq. 1), or along the boundary."""
    step_m: Annotated[float, Field(ge=5e-4, le=10)] | None
    """The paper's r, metres; None: a 200th of the perimeter, 2 to 6 mm. Pairs, and memory, grow with its inverse
    square: half a millimetre, finer than any depth camera, is the least."""
    chord_share_max: Share | None
    """Longest chord, as a share of the outline's longer side: on less than that a single finger's pad may bear. None:
    chords are as long as the jaw is wide, however small the object."""
    arc_ratio_max: Annotated[float, Field(gt=1, le=1e6)] | None
    """Longest boundary under a chord, a ratio to the chord: beyond it the boundary folds around a thin part. None: any.
    """
    walk: Literal["cyclic", "open"]
    """Whether the boundary goes on past its last point (the paper's Ω does not)."""
    direction: Literal["signed_area", "random_rays"]
    """Inward side by the loop's orientation, checked for each candidate; or by the paper's rays and cross products."""
    delta_m: Step
    """The paper's δ, step of the search for a point inside, metres."""
    rays: Annotated[int, Field(ge=1, le=10_000)]
    """With `random_rays`: the number of rays that vote on whether a point lies inside."""
    variance: Literal["mean", "rms", "max", "sum"]
    """§III.B.4: distances of the boundary to the chord: mean, root mean square, maximum, or the paper's plain sum."""


class BalanceSettings(Profile):
    """§III.B.1 and B.2: force and torque balance."""

    friction: Friction | None
    """The friction coefficient μ that sets the thresholds; None: the gripper's pad_friction."""
    facing: bool
    """Drop pairs that would push apart, which the paper forgets."""
    force_share: Share
    """k: γ may use this share of the friction cone, 2·k·atan(μ)."""
    force_balance_max_deg: Angle | None
    """Largest γ, degrees; None: 2·k·atan(μ)."""
    torque: Literal["friction", "arm", "normalised"]
    """Threshold on required friction (μ), on the torque arm T_s (m), or on T/d."""
    torque_max: Annotated[float, Field(ge=1e-6, le=1e6)] | None
    """Limit of what `torque` names: a friction coefficient, metres, or a ratio; None: μ, or for the other two what the
    friction cone leaves."""

    def friction_with(self, gripper: Gripper) -> float:
        """The friction coefficient that is counted on."""
        return self.friction if self.friction is not None else gripper.pad_friction


class HandSettings(Profile):
    """§III.B.3 to B.5: grasping range, variance, operability."""

    closing_axis: Literal["bisector", "contacts"]
    """The hand closes along the two directions' bisector (pads lie flush) or along the line of contacts."""
    width: Literal["extent", "midpoints"]
    """The object's width: its extent under the pads, or the distance of the contacts."""
    clearance_m: Length
    """Least free space between each pad and the object before closing, metres."""
    preshape_m: Size
    """Free space aimed at between each pad and the object, where there is room, metres."""
    variance_max: Annotated[float, Field(ge=1e-6, le=1e3)] | None
    """Largest variance, in metres; None: variance_max_share of the candidate's width."""
    variance_max_share: Share
    """Largest variance, as a share of the candidate's width, where `variance_max` is None."""
    operability: Literal["swept", "eq2"]
    """Exact swept rectangles of fingers and palm, or the paper's eq. (2) on the hull's points."""
    contact_tolerance_m: Length
    """Boundary this far beyond the contact, metres, still counts as the contact."""


class DepthSettings(Profile):
    """Over a support plane: how deep the fingertips go, and what they and the palm keep clear of."""

    table_clearance_m: Length
    """Free space between fingertips and support plane, metres."""
    min_clearance_m: Length
    """The same for an object hardly higher than that, metres."""
    low_object_share: Share
    """Fingertips go down to this share of a low object's height."""
    palm_clearance_m: Length
    """Free space between the palm and whatever is highest below it, metres."""
    obstacle_clearance_m: Length
    """Free space between fingertips and what lies below them, metres."""
    min_grip_m: Size
    """Least height of the pads on the object, metres; half of the object's height where that is less."""
    good_grip_m: Size
    """Height of the pads on the object beyond which more is no better, metres."""
    slice_step_m: Step
    """Outlines are taken at levels this far apart, metres."""
    wall_drop: Annotated[float, Field(ge=0, le=20)]
    """Least steepness of the object below the fingertips, a ratio of height to breadth: a flatter flank would push the
    fingers off."""
    standing_ratio: Annotated[float, Field(ge=0.01, le=1e3)]
    """An object this many times as high as its footprint is long, a ratio, may be grasped from the side, if not from
    above."""
    unseen: Literal["rank", "refuse", "ignore"]
    """Finger places that no ray reached, in the object's shadow: rank lower, refuse, or take for free."""
    approach_m: Length
    """From the pre-grasp pose to the grasp, along the approach, metres."""
    lift_m: Length
    """From the grasp to the lift pose, along the support plane's normal, metres."""


class GravitySettings(Profile):
    """§III.C: gravity and the final choice."""

    center: Literal["area", "points"]
    """Centre of the outline's area, or the mean of the points."""
    overhang_weight: Weight
    """Cost in metres of each metre that the centre of gravity lies beyond the contacts along the grasping line: the
    paper's distance to that line does not see it, the pads' friction does."""
    gap_weight: Weight
    """Cost of each metre of the closing segment outside the object, in metres of gravity distance."""
    width_weight: Weight
    """Cost in metres of each metre of width."""
    friction_weight_m: Weight
    """Cost of required friction 1, metres; of less in proportion to its square, so that a small slant costs nothing."""
    lonely_cost_m: Length
    """Cost of a grasp that has no other within a centimetre on either hand, metres: one that forgives no miss."""
    level_weight: Weight
    """Cost in metres of each metre that the fingertips stay above the support plane."""
    grip_weight: Weight
    """Cost in metres of each metre that the pads' height on the object falls short of `depth.good_grip_m`."""
    low_grip_weight: Weight
    """Cost in metres of each metre that it falls short of `depth.min_grip_m`: a blade is gripped for want of a handle.
    """
    margin_weight: Weight
    """Cost of no space beside the pads, a ratio to `hand.preshape_m`; of some by the square of what is missing."""
    hole_cost_m: Length
    """Cost of a finger in a hole, where it has little room on any side, metres."""
    unseen_weight: Weight
    """Cost in metres of each metre of the fingers' way that no ray reached, both sides together."""


class CagingSettings(Profile):
    """Beyond the paper: within which openings the object cannot get away."""

    certify: bool
    """Whether the best grasps get certificates."""
    mass_kg: Annotated[float, Field(ge=1e-4, le=1e4)] | None
    """The object's mass, kilograms, for the margins of lifting it; None: not known."""
    prefer: Literal["cost", "cage"]
    """cage: grasps with a cage first, of those the one that forgives the largest miss."""
    require: bool
    """Whether a grasp without a cage is none."""
    considered: Annotated[int, Field(ge=1, le=1000)]
    """The number of the cheapest grasps that compete when cages decide."""
    closing: Literal["inward", "outward"]
    """Whether the fingers close on the object or open in a notch or a hole of it."""
    tolerance_m: Length
    """How far the outline may be simplified, metres; more if it has more than `max_vertices` then."""
    max_vertices: Annotated[int, Field(ge=8, le=1000)]
    """Largest number of the outline's vertices: time grows with their square."""
    noise_m: Length
    """By how much the outline may be wrong in the guaranteed limits, metres."""
    told_apart_m: Length
    """Grasps less deep than this, metres, from their width to the opening that leads to the next one, count as one."""


class PlannerSettings(Profile):
    """Everything that the planner can be told."""

    profile: Literal["planner"] = "planner"
    """What kind of profile this is."""
    name: str
    """The profile's name: of a shipped one, or of the file's own."""
    method: Literal["lei_wisse", "allen"]
    """Whose grasps: the paper's, or those of two point fingers (Allen, Burdick & Rimon 2012, its reference [1])."""
    seed: Annotated[int, Field(ge=0, lt=2**32)]
    """The number from which everything random follows."""
    scene: SceneSettings
    """Before the paper: the support plane and the objects on it."""
    main_plane: MainPlaneSettings
    """§III.A.1: the oriented bounding box."""
    silhouette: SilhouetteSettings
    """§III.A.2: the concave hull."""
    fingers: FingerSettings
    """§III.A.3: step points, finger candidates, grasping directions."""
    balance: BalanceSettings
    """§III.B.1 and B.2: force and torque balance."""
    hand: HandSettings
    """§III.B.3 to B.5: grasping range, variance, operability."""
    depth: DepthSettings
    """Beyond the paper: how deep the fingertips go over a support plane."""
    gravity: GravitySettings
    """§III.C: gravity and the final choice."""
    caging: CagingSettings
    """Beyond the paper: proofs."""

    def resolve(self, gripper: Gripper) -> PlannerSettings:
        """The same with every None that the gripper decides replaced; those that the object decides stay None."""
        balance = self.balance
        friction = balance.friction_with(gripper)
        cone = math.atan(friction)
        gamma = balance.force_balance_max_deg or math.degrees(2 * balance.force_share * cone)
        torque_max = balance.torque_max
        if torque_max is None:
            # facts of the friction cone: T/d < sin(φ − γ/2)·cos(γ/2) keeps a pair with the largest γ force closed
            rest = max(cone - math.radians(gamma) / 2, 0.0)
            normalised = math.sin(rest) * math.cos(math.radians(gamma) / 2)
            arm = normalised * gripper.max_opening_m
            torque_max = {"friction": friction, "normalised": normalised, "arm": arm}[balance.torque]
        resolved = {"friction": friction, "force_balance_max_deg": min(gamma, 180.0), "torque_max": torque_max}
        return self.model_copy(update={"balance": balance.model_copy(update=resolved)})
