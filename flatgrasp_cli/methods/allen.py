"""Reference [1] of the paper as a method of its own: grasps of two point fingers, from contact space alone.

Allen, Burdick & Rimon (ICRA 2012). It knows no hand: `shortcomings` says why one cannot carry such a grasp out.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import cross, left_normal, share_inside
from flatgrasp_cli.model import Cage, GraspCandidates, PlaneShape, Silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import CagingSettings, PlannerSettings
from flatgrasp_cli.proof.caging import Hands, Immobilisation, immobilising_grasps
from flatgrasp_cli.surroundings.interface import Surroundings

THIN_M = 1e-4
"""Fingers that overlap the silhouette by less than a sliver of this width touch it."""


def point_fingers(
    shape: PlaneShape,
    surroundings: Surroundings,
    gripper: Gripper,
    settings: PlannerSettings,
    funnel: Funnel,
    top: int,
) -> tuple[None, GraspCandidates]:
    """The best `top` of the grasps that two point fingers close into, whatever the hand can do.

    There is no table of finger candidates that they are pairs of.
    """
    grasps = point_finger_grasps(shape.silhouette, shape.gravity_center.area, settings.caging)
    funnel.count(
        "immobilising", len(grasps), "no two points hold this outline without friction; a convex one has none that do"
    )
    tip, touched = np.full(len(grasps), surroundings.lowest_m), np.full((len(grasps), 2), gripper.finger_width_m)
    return None, grasps.having(tip=tip, touch=tip, touched_m=touched).first(top)


def point_finger_grasps(silhouette: Silhouette, center: FloatArray, settings: CagingSettings) -> GraspCandidates:
    """The grasps of a silhouette that two point fingers close into, the one that forgives most first.

    Where the distance of the fingers is least, their line is normal to the silhouette, or to its generalised normal at
    a corner: the force balance is exact and no friction is needed. `center` (2,) is the object's centre of gravity.
    Each finger is a candidate of its own.
    """
    found = immobilising_grasps(silhouette.loops, settings)
    contacts = np.array([one.contacts for one in found]).reshape(-1, 2, 2)
    width = np.array([one.width_m for one in found])
    axis = (contacts[:, 1] - contacts[:, 0]) / width[:, None]
    middle, none = contacts.mean(axis=1), np.zeros(len(found))
    return GraspCandidates(
        i=2 * np.arange(len(found)),
        j=2 * np.arange(len(found)) + 1,
        middle=middle,
        axis=axis,
        distance=width,
        force_balance_deg=none,
        torque_arm_m=none,
        required_friction=none,
        pads=np.column_stack([0.5 * width, 0.5 * width]),
        opening=np.array([one.width_m if one.basin_m is None else one.basin_m for one in found]),
        gravity_distance=np.abs(cross(axis, center - middle)),
        inside_share=share_inside(silhouette.loops, contacts[:, 0], contacts[:, 1]),
        merit=np.array([min(one.depth_m, one.width_m) for one in found]),
        contacts=contacts,
        variance=none,
        arc_ratio=np.ones(len(found)),
    )


def cage_of(found: Immobilisation, closing: str) -> Cage:
    """The cage that comes with an immobilising grasp."""
    inward = closing == "inward"
    margin = None if found.escape_m is None else abs(found.escape_m - found.width_m)
    cage = Cage(inward, not inward, None, margin_m=margin, closes_into_m=found.width_m)
    if inward:
        return replace(cage, opening_max_m=found.escape_m, basin_opening_max_m=found.basin_m)
    return replace(cage, opening_min_m=found.escape_m, basin_opening_min_m=found.basin_m)


def shortcomings(silhouette: Silhouette, hands: Hands, gripper: Gripper, settings: PlannerSettings) -> list[str | None]:
    """Why a hand cannot carry out each of k grasps; None where it can.

    Its fingers have a width and a thickness, open only so far, and need the silhouette flat where their pads press.
    """
    import shapely

    region = shapely.Polygon(silhouette.loops[0], silhouette.loops[1:])
    shapely.prepare(region)
    return [_shortcoming(region, hands, k, gripper, settings) for k in range(len(hands))]


def _shortcoming(region: Any, hands: Hands, k: int, gripper: Gripper, settings: PlannerSettings) -> str | None:
    import shapely

    width, clearance = float(hands.width[k]), settings.hand.clearance_m
    if width + 2 * clearance > gripper.max_opening_m:
        return f"it opens {gripper.max_opening_m:.3f} m, not {width + 2 * clearance:.3f} m"
    if width < gripper.min_opening_m:
        return f"it closes to {gripper.min_opening_m:.3f} m, not to {width:.3f} m"
    far = 0.5 * width + settings.hand.contact_tolerance_m
    for side, offsets in ((-1.0, gripper.jaws[0]), (1.0, gripper.jaws[1])):
        for offset in offsets:
            left, right = offset - 0.5 * gripper.finger_width_m, offset + 0.5 * gripper.finger_width_m
            box = _placed(shapely.box(left, side * far, right, side * (far + gripper.finger_thickness_m)), hands, k)
            if shapely.area(shapely.intersection(region, box)) > THIN_M * gripper.finger_width_m:
                size = f"{gripper.finger_width_m:.3f} m × {gripper.finger_thickness_m:.3f} m"
                return f"a finger of {size} meets the object"
            near = far - 2 * settings.hand.contact_tolerance_m
            pad = _placed(shapely.box(left, side * near, right, side * far), hands, k)
            if shapely.area(shapely.intersection(region, pad)) < settings.hand.variance_max_share * shapely.area(pad):
                return "the outline is too narrow there for a pad to press on"
    return None


def _placed(shape: Any, hands: Hands, k: int) -> Any:
    """A shape in the frame of hand `k`, x across and y along its closing axis, in the plane."""
    import shapely

    axes = np.stack([left_normal(hands.axis[k : k + 1])[0], hands.axis[k]])
    return shapely.transform(shape, lambda corners: hands.center[k] + corners @ axes)
