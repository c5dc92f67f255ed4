"""§III.B.3: the closing axis of a pair, and whether the hand spans the object along it."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import cross
from flatgrasp_cli.kernels import pads as kernels
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import HandSettings


def closing_axes(fingers: FingerCandidates, grasps: GraspCandidates, method: str) -> GraspCandidates:
    """The pairs with the axis to close along: n_i − n_j, along which both pads lie flush, or the line of contacts."""
    if method == "contacts":
        return grasps
    axis = fingers.direction.take(grasps.i, axis=0) - fingers.direction.take(grasps.j, axis=0)
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    return grasps.having(axis=np.where(length > 1e-9, axis / np.maximum(length, 1e-9), grasps.axis))


def on_pads(fingers: FingerCandidates, grasps: GraspCandidates, gripper: Gripper, funnel: Funnel) -> GraspCandidates:
    """The pairs whose contacts both lie under the pads, though not in their middles when closing along the bisector."""
    apart = fingers.contact.take(grasps.j, axis=0) - fingers.contact.take(grasps.i, axis=0)
    aside = 0.5 * np.abs(cross(grasps.axis, apart))
    beside_pad = (aside - half_widths(gripper)).max(axis=0)
    kept = funnel.at_most(
        "pads", grasps, beside_pad, 0.0, lambda value: f"in the best pair a contact lies {value:.3f} m beside its pad"
    )
    return grasps.select(kept)


def half_widths(gripper: Gripper) -> FloatArray:
    """Half the width of each jaw (2, 1), all of its fingers together, metres."""
    return 0.5 * np.array([[gripper.jaw_width_m(0)], [gripper.jaw_width_m(1)]])


def in_range(
    fingers: FingerCandidates, grasps: GraspCandidates, gripper: Gripper, settings: HandSettings, funnel: Funnel
) -> GraspCandidates:
    """The pairs that the hand can span, with its clearance on both sides."""
    width = extents(fingers, grasps).sum(axis=0) if settings.width == "extent" else grasps.distance
    width = np.where(width < gripper.min_opening_m, np.inf, width)

    def miss(value: float) -> str:
        if not np.isfinite(value):
            return f"every graspable width is below the gripper's smallest opening {gripper.min_opening_m:.4f} m"
        clear = f" with {settings.clearance_m:.3f} m clearance a side" if settings.clearance_m > 0 else ""
        return f"narrowest graspable width {value:.3f} m, gripper opens {gripper.max_opening_m:.3f} m{clear}"

    limit = gripper.max_opening_m - 2 * settings.clearance_m
    return grasps.select(funnel.at_most("grasping_range", grasps, width, limit, miss))


def extents(fingers: FingerCandidates, grasps: GraspCandidates) -> FloatArray:
    """How far (2, p) each candidate's stretch of boundary reaches out along −axis and along +axis, metres.

    Their sum is the width that the jaws must clear; the distance between the contacts can be less.
    """
    reach: FloatArray = kernels.extents(grasps.middle, grasps.axis, fingers.arcs, np.stack([grasps.i, grasps.j]))
    return reach
