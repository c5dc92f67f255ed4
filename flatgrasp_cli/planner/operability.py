"""§III.B.5: room for the fingers beside the object, and where the pads come to rest."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import FloatArray, chunks
from flatgrasp_cli.geometry.chain import closed_chain
from flatgrasp_cli.geometry.polygon import in_frames
from flatgrasp_cli.kernels import pads as kernels
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, Silhouette
from flatgrasp_cli.planner.grasping_range import extents, half_widths
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import HandSettings


def operable(
    silhouette: Silhouette,
    fingers: FingerCandidates,
    grasps: GraspCandidates,
    gripper: Gripper,
    settings: HandSettings,
    funnel: Funnel,
) -> GraspCandidates:
    """The pairs at which the fingers have room beside the object, with `pads` and `room`."""
    if settings.operability == "swept":
        pads, room = swept_fit(silhouette, fingers, grasps, gripper, settings.contact_tolerance_m)
    else:
        pads, room = eq2_fit(silhouette, grasps, gripper, settings.contact_tolerance_m)
    # B.3 judged by each candidate's own stretch of boundary; the exact width may still differ.
    width, widest_m = pads.sum(axis=0), gripper.max_opening_m - 2 * settings.clearance_m
    fits = (width >= gripper.min_opening_m) & (width <= widest_m)
    hidden = np.column_stack([fingers.hidden[grasps.i], fingers.hidden[grasps.j]])
    pads, room = _with_hidden(pads.T, room.T, hidden, widest_m)
    grasps = grasps.having(pads=pads, room=room, hidden=hidden)
    need = gripper.finger_thickness_m + settings.clearance_m + grasps.beyond
    shortage = np.where(fits, need - grasps.room.min(axis=1), np.inf)

    def miss(value: float) -> str:
        if not np.isfinite(value):
            return f"between the pads every pair is wider than the gripper opens, {gripper.max_opening_m:.3f} m"
        finger_m = gripper.finger_thickness_m + settings.clearance_m
        return f"most room behind a pad {max(finger_m - value, 0.0):.3f} m, the finger needs {finger_m:.3f} m"

    return grasps.select(funnel.at_most("operability", grasps, shortage, 0.0, miss))


def _with_hidden(
    pads: FloatArray, room: FloatArray, hidden: FloatArray, widest_m: float
) -> tuple[FloatArray, FloatArray]:
    """Pads and room (p, 2) where the object goes on out of sight by half of what is `hidden` (p, 2) at most.

    That is how far it goes on in the mean. If the hand does not open so far, it goes on by what the hand still spans.
    """
    half = 0.5 * hidden
    spare, total = np.maximum(widest_m - pads.sum(axis=1), 0.0), half.sum(axis=1)
    beyond = half * np.minimum(1.0, spare / np.where(total > 0, total, 1.0))[:, None]
    return np.ascontiguousarray(pads + beyond), np.ascontiguousarray(np.maximum(room - beyond, 0.0))


def swept_fit(
    silhouette: Silhouette, fingers: FingerCandidates, grasps: GraspCandidates, gripper: Gripper, tolerance_m: float
) -> tuple[FloatArray, FloatArray]:
    """Exact: where the pads come to rest and how far each finger could back off, (2, p) each, by the whole silhouette.

    Each finger sweeps a strip of its width along the closing axis. A pad rests on the outermost boundary that lies no
    more than `tolerance_m` beyond its candidate's own reach. The next boundary outward ends the room; where boundary
    runs on past the tolerance without a gap, there is none. Nor is there any for a pad that comes to rest half its
    width below its candidate: it rests on something else.
    """
    points, breaks = closed_chain(silhouette.loops)
    edges = np.delete(np.arange(len(points) - 1), breaks)
    reach = extents(fingers, grasps)
    offsets = np.array([[jaw, offset] for jaw in (0, 1) for offset in gripper.jaws[jaw]])
    hands = np.concatenate([grasps.middle, grasps.axis], axis=1)
    pads, room = kernels.swept(points, edges, hands, offsets, 0.5 * gripper.finger_width_m, reach + tolerance_m)
    sunk = reach - pads > half_widths(gripper)
    return pads, np.where(sunk, 0.0, room)


def eq2_fit(
    silhouette: Silhouette, grasps: GraspCandidates, gripper: Gripper, tolerance_m: float
) -> tuple[FloatArray, FloatArray]:
    """Eq. (2) as printed: no hull point with |x| ≤ w_h/2 and d/2 ≤ |y| ≤ w_o, d being the contacts' distance.

    Pads and room are (2, p). `tolerance_m` is added to d/2, for the contacts themselves satisfy the inequality.
    """
    vertices = np.concatenate(silhouette.loops)
    half = 0.5 * grasps.distance
    free = np.empty((2, len(grasps)), dtype=np.bool_)
    for part in chunks(len(grasps), len(vertices)):
        x, y = in_frames(vertices, grasps.middle[part], grasps.axis[part])
        in_strip = np.abs(x) <= 0.5 * gripper.hand_width_m
        begin = half[part] + tolerance_m
        for side, outward in ((0, -y), (1, y)):
            free[side, part] = ~(in_strip & (outward >= begin) & (outward <= gripper.max_opening_m)).any(axis=0)
    return np.stack([half, half]), np.where(free, np.inf, 0.0)
