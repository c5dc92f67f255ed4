"""What a hand meets in the plane that does not stand where it should: whether it closes on the object all the same."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.chain import closed_chain
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.kernels.closing import touched
from flatgrasp_cli.model import OpenHands
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.ranking.errors import Errors

RIM_SHARE = 0.25
"""The share of a fingertip's size, on each side, that is its rim: what it meets with that it pushes aside, or is pushed
aside by. Of 48 simulated fingertips that came down on an object with no more than that, 42 held it nevertheless."""


class Closed(NamedTuple):
    """What p hands come to, (p,) each.

    `free` is whether the open fingers stand beside the object, with `room`, metres, between the nearer pad and it, and
    `between` whether the object is between them. Once the pads have turned the object as they do, its sides are a
    wedge: each lies aslant by the angle `wedge`, radians, and friction has to hold that.
    """

    free: BoolArray
    room: FloatArray
    between: BoolArray
    wedge: FloatArray


def closed(loops: Sequence[FloatArray], hands: OpenHands, gripper: Gripper, tolerance_m: float) -> Closed:
    """Closes p hands on the silhouette `loops`; its points within `tolerance_m` of the outermost are touched alike."""
    points, breaks = closed_chain(loops)
    edges = np.delete(np.arange(len(points) - 1), breaks)
    face, rim = 0.5 * hands.opening, RIM_SHARE * gripper.finger_thickness_m
    half, core = 0.5 * gripper.finger_width_m, (0.5 - RIM_SHARE) * gripper.finger_width_m
    tip = np.array([half, core, rim, gripper.finger_thickness_m - rim])
    seen = np.column_stack([hands.center, hands.axis, face])
    fingers = np.array([[jaw, offset] for jaw in (0, 1) for offset in gripper.jaws[jaw]])
    (one_free, one_reach, one_slope), (other_free, other_reach, other_slope) = touched(
        points, edges, seen, fingers, tip, tolerance_m
    )
    wedge = np.arctan(one_slope) + np.arctan(other_slope)  # inward normals, toward the same side
    return Closed(
        free=(one_free > 0) & (other_free > 0),
        room=face + rim - np.maximum(one_reach, other_reach),
        between=np.isfinite(one_reach + other_reach) & (one_reach + other_reach > 0),
        wedge=0.5 * np.abs(wedge),
    )


def moved(center: FloatArray, axis: FloatArray, errors: Errors) -> tuple[FloatArray, FloatArray]:
    """Centres and axes (k, s, 2) of k hands, from where they should be and as they miss in s samples."""
    aside = left_normal(axis)
    where = center[:, None] + errors.across[:, None] * aside[:, None] + errors.along[:, None] * axis[:, None]
    turned = np.cos(errors.yaw)[:, None] * axis[:, None] + np.sin(errors.yaw)[:, None] * aside[:, None]
    return where, turned
