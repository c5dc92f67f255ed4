"""A hand as boxes, for whoever draws it."""

from __future__ import annotations

from dataclasses import dataclass

from flatgrasp_cli.profiles import Gripper

PALM_THICKNESS_M = 0.01
"""Of a palm drawn in space: profiles do not say how thick it is."""


@dataclass(frozen=True, slots=True)
class Box:
    """A box square to the axes of the fingertips' frame, metres."""

    center: tuple[float, float, float]
    size: tuple[float, float, float]


def finger_boxes(gripper: Gripper, opening_m: float) -> list[tuple[float, float, float, float]]:
    """Each finger as (x_min, x_max, y_min, y_max) in the hand's frame, metres."""
    half, inner, outer = gripper.finger_width_m / 2, opening_m / 2, opening_m / 2 + gripper.finger_thickness_m
    minus = [(offset - half, offset + half, -outer, -inner) for offset in gripper.jaws[0]]
    plus = [(offset - half, offset + half, inner, outer) for offset in gripper.jaws[1]]
    return minus + plus


def hand_boxes(gripper: Gripper, opening_m: float, width_m: float) -> tuple[Box, ...]:
    """Each finger at an opening, and the palm last, where the fingertips' frame is that of fingers closed to a width.

    The palm stays where it is while fingers on an arc close, so that open ones end short of the frame's origin.
    """
    root = gripper.finger_length_at_m(width_m)
    tip = root - gripper.finger_length_at_m(opening_m)
    fingers = [_box(*sides, -root, -tip) for sides in finger_boxes(gripper, opening_m)]
    x, y = gripper.hand_width_m / 2, gripper.palm_m / 2
    return (*fingers, _box(-x, x, -y, y, -root - PALM_THICKNESS_M, -root))


def _box(x0: float, x1: float, y0: float, y1: float, z0: float, z1: float) -> Box:
    return Box(((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2), (x1 - x0, y1 - y0, z1 - z0))
