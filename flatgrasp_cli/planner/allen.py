"""Reference [1] of the paper as a method of its own: grasps of two point fingers, from contact space alone.

Allen, Burdick & Rimon (ICRA 2012). It knows no hand: `shortcomings` says why one cannot carry such a grasp out.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import quaternion_from_axes
from flatgrasp_cli.geometry.polygon import cross, left_normal, share_inside
from flatgrasp_cli.model import Cage, Grasp, Silhouette
from flatgrasp_cli.planner.caging import Hands, Immobilisation, immobilising_grasps
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings

THIN_M = 1e-4
"""Fingers that overlap the outline by less than a sliver of this width touch it."""


def point_finger_grasps(
    outline: Silhouette, center: FloatArray, tip_m: float, settings: PlannerSettings
) -> tuple[Grasp, ...]:
    """The grasps of an outline that two point fingers close into, the one that forgives most first.

    Where the distance of the fingers is least, their line is normal to the outline, or to its generalised normal at a
    corner: the force balance is exact and no friction is needed. `center` (2,) is the object's centre of
    gravity, `tip_m` the height of the fingertips.
    """
    found = immobilising_grasps(outline.loops, settings.caging)
    return tuple(_grasp(k, one, outline, center, tip_m) for k, one in enumerate(found))


def cage_of(found: Immobilisation, closing: str) -> Cage:
    """The cage that comes with an immobilising grasp."""
    inward = closing == "inward"
    margin = None if found.escape_m is None else abs(found.escape_m - found.width_m)
    cage = Cage(inward, not inward, None, margin_m=margin, closes_into_m=found.width_m)
    if inward:
        return replace(cage, opening_max_m=found.escape_m, basin_opening_max_m=found.basin_m)
    return replace(cage, opening_min_m=found.escape_m, basin_opening_min_m=found.basin_m)


def shortcomings(outline: Silhouette, hands: Hands, gripper: Gripper, settings: PlannerSettings) -> list[str | None]:
    """Why a hand cannot carry out each of k grasps; None where it can.

    Its fingers have a width and a thickness, open only so far, and need the outline flat where their pads press.
    """
    import shapely

    region = shapely.Polygon(outline.loops[0], outline.loops[1:])
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
            box = _rectangle(hands, k, (left, right), (side * far, side * (far + gripper.finger_thickness_m)))
            if shapely.area(shapely.intersection(region, box)) > THIN_M * gripper.finger_width_m:
                size = f"{gripper.finger_width_m:.3f} m × {gripper.finger_thickness_m:.3f} m"
                return f"a finger of {size} meets the object"
            near = far - 2 * settings.hand.contact_tolerance_m
            pad = _rectangle(hands, k, (left, right), (side * near, side * far))
            if shapely.area(shapely.intersection(region, pad)) < settings.hand.variance_max_share * shapely.area(pad):
                return "the outline is too narrow there for a pad to press on"
    return None


def _rectangle(hands: Hands, k: int, x: tuple[float, float], y: tuple[float, float]) -> Any:
    import shapely

    across = left_normal(hands.axis[k : k + 1])[0]
    corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
    return shapely.Polygon([hands.center[k] + a * across + b * hands.axis[k] for a, b in corners])


def _grasp(k: int, found: Immobilisation, outline: Silhouette, center: FloatArray, tip_m: float) -> Grasp:
    frame, contacts = outline.frame, found.contacts
    axis = (contacts[1] - contacts[0]) / found.width_m
    middle = contacts.mean(axis=0)
    heights = np.full((2, 1), tip_m)
    hand_x, hand_y = left_normal(axis[None])[0] @ frame.axes[:2], axis @ frame.axes[:2]
    return Grasp(
        rank=k + 1,
        position=frame.to_world(np.array([[*middle, tip_m]]))[0],
        orientation=quaternion_from_axes(np.stack([hand_x, hand_y, -frame.axes[2]])),
        opening_m=found.width_m if found.basin_m is None else found.basin_m,
        width_m=found.width_m,
        contacts=frame.to_world(np.concatenate([contacts, heights], axis=1)),
        fingers=(2 * k, 2 * k + 1),
        force_balance_deg=0.0,
        torque_arm_m=0.0,
        required_friction=0.0,
        variance_m=0.0,
        gravity_distance_m=float(abs(cross(axis, center - middle))),
        inside_share=float(share_inside(outline.loops, contacts[:1], contacts[1:])[0]),
        arc_ratio=1.0,
        cost_m=float(-min(found.depth_m, found.width_m)),
    )
