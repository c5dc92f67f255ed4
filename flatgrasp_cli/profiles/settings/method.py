"""The paper's own sections: what the settings say of §III, section by section."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from flatgrasp_cli.profiles.base import Angle, Derived, Length, Profile, Share, Size, Step
from flatgrasp_cli.profiles.gripper import Gripper

Friction = Annotated[float, Field(ge=0.01, le=5)]
LEAST_COVERAGE = 0.01
"""An outline of less than a hundredth of the points is one of nothing."""


class MainPlaneSettings(Profile):
    """§III.A.1: the oriented bounding box."""

    method: Literal["pca", "min_area"]
    """In-plane axes: covariance eigenvectors (the paper's PCL) or the smallest rectangle around the projection."""


class SilhouetteSettings(Profile):
    """§III.A.2: the concave hull."""

    alpha_m: Step | None
    """Radius α of the hull's empty discs, metres; None: from the points' spacing."""
    min_coverage: Annotated[float, Field(ge=LEAST_COVERAGE, le=1)]
    """α grows until the largest piece holds this share of the points."""
    tolerance_m: Derived
    """How far the outline may be simplified (Douglas–Peucker), metres; null: half of `uncertainty.outline_m`."""
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

    model: Literal["profile", "paper"]
    """The hand as its profile has it, or what the paper knows of it: two equal fingers, and a width w_h of theirs."""
    closing_axis: Literal["bisector", "contacts"]
    """The hand closes along the two directions' bisector (pads lie flush) or along the line of contacts."""
    width: Literal["extent", "midpoints"]
    """The object's width: its extent under the pads, or the distance of the contacts."""
    clearance_m: Derived
    """Least free space between each pad and the object before closing, metres; null: twice `uncertainty.outline_m`."""
    preshape_m: Size
    """Free space aimed at between each pad and the object, where there is room, metres."""
    variance_max: Annotated[float, Field(ge=1e-6, le=1e3)] | None
    """Largest variance, in metres; None: variance_max_share of the candidate's width."""
    variance_max_share: Share
    """Largest variance, as a share of the candidate's width, where `variance_max` is None."""
    operability: Literal["swept", "eq2"]
    """Exact swept rectangles of fingers and palm, or the paper's eq. (2) on the hull's points."""
    contact_tolerance_m: Derived
    """Boundary this far beyond the contact, metres, still counts as the contact; null: twice
    `uncertainty.outline_m`."""


class GravitySettings(Profile):
    """§III.C: gravity."""

    center: Literal["area", "points"]
    """Centre of the outline's area, or the mean of the points."""
