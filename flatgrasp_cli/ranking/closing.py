"""What a hand meets in the plane that does not stand where it should: whether it closes on the object all the same."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import edges
from flatgrasp_cli.kernels import closing as kernels
from flatgrasp_cli.model import OpenHands
from flatgrasp_cli.profiles.gripper import Gripper

RIM_SHARE = 0.25
"""The share of a fingertip's size, on each side, that is its rim: what it meets with that it pushes aside, or is pushed
aside by. Of 48 simulated fingertips that came down on an object with no more than that, 42 held it nevertheless."""


class Closed(NamedTuple):
    """What k grasps' hands come to in s samples, (k, s) each.

    `free` is 1 where the open fingers stand beside the object, with `room`, metres, between the nearer pad and it, and
    `between` 1 where the object is between them. Once the pads have turned the object as they do, its sides are a
    wedge: each lies aslant by the angle of which `wedge` is the tangent, and friction has to hold that.
    """

    free: FloatArray
    room: FloatArray
    between: FloatArray
    wedge: FloatArray


def closed(loops: Sequence[FloatArray], hands: OpenHands, gripper: Gripper, tolerance_m: float) -> Closed:
    """Closes hands on the silhouette `loops`; its points within `tolerance_m` of the outermost are touched alike."""
    half, core = 0.5 * gripper.finger_width_m, (0.5 - RIM_SHARE) * gripper.finger_width_m
    rim = RIM_SHARE * gripper.finger_thickness_m
    fingers = np.array([[jaw, offset] for jaw in (0, 1) for offset in gripper.jaws[jaw]])
    widest = half + float(np.abs(fingers[:, 1]).max())
    tip = np.array([half, core, rim, gripper.finger_thickness_m - rim, widest])
    return Closed(*kernels.closed(*edges(loops), hands.where, fingers, tip, tolerance_m))
