"""The hand's fingers in the plane: the points on their pads, and the boxes that they sweep."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.profiles.gripper import Gripper

PAD_SHARES = (0.5, 0.1, 0.9)
"""Where on the pads' common width two points are taken: any pair of points proves a cage, so the best one counts."""


@dataclass(frozen=True, slots=True, eq=False)
class Hands:
    """k grasps in plane coordinates: the point midway between the pads `center` (k, 2), unit closing `axis` (k, 2).

    The pads are `width` (k,) apart in the grasp and `opening` (k,) on the approach.
    """

    center: FloatArray
    axis: FloatArray
    width: FloatArray
    opening: FloatArray

    def __len__(self) -> int:
        """Number of grasps."""
        return len(self.width)

    def select(self, keep: IntArray) -> Hands:
        """The grasps that `keep` names."""
        return Hands(self.center[keep], self.axis[keep], self.width[keep], self.opening[keep])


def pad_points(hands: Hands, gripper: Gripper) -> tuple[FloatArray, FloatArray]:
    """Pairs of points (c, k, 2, 2) on opposite pads of k hands, c of them each, and how far aside (c,) of one another.

    They are taken for each finger of one jaw with each of the other: in the middle and near the ends of the width that
    both cover, or on their nearest edges.
    """
    half, offsets = 0.5 * gripper.finger_width_m, []
    for a in gripper.jaws[0]:
        for b in gripper.jaws[1]:
            low, high = max(a, b) - half, min(a, b) + half
            if low <= high:
                offsets += [(low + share * (high - low),) * 2 for share in PAD_SHARES]
            else:
                offsets.append((high, low) if a < b else (low, high))
    x = np.array(offsets)
    y = 0.5 * hands.width[:, None] * np.array([-1.0, 1.0])
    across = left_normal(hands.axis)
    points = hands.center[:, None] + y[..., None] * hands.axis[:, None] + x[:, None, :, None] * across[:, None]
    return points, np.abs(x[:, 1] - x[:, 0])


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """A finger's sweep in the frames of k hands: `low` ≤ x ≤ `high` across, `near` ≤ y ≤ `far` (k,) along the axis."""

    low: float
    high: float
    near: FloatArray
    far: FloatArray

    @property
    def corners(self) -> tuple[tuple[float, FloatArray], ...]:
        """The four corners, x and y (k,)."""
        return ((self.low, self.near), (self.low, self.far), (self.high, self.near), (self.high, self.far))


def sweeps(hands: Hands, begin: FloatArray, gripper: Gripper, *, outward: bool) -> tuple[Box, ...]:
    """The boxes that each finger covers between the approach and the opening `begin` (k,)."""
    if outward:  # the pads are the fingers' outer faces
        inner, outer = 0.5 * np.minimum(begin, hands.opening) - gripper.finger_thickness_m, 0.5 * begin
    else:
        inner, outer = 0.5 * begin, 0.5 * np.maximum(begin, hands.opening) + gripper.finger_thickness_m
    half = 0.5 * gripper.finger_width_m
    return tuple(
        Box(offset - half, offset + half, *((-outer, -inner) if side == 0 else (inner, outer)))
        for side, offsets in enumerate(gripper.jaws)
        for offset in offsets
    )
