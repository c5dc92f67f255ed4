"""A gripper's dimensions, measured on the shapes of its URDF with the fingers open and closed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.profiles.urdf import Joint, Urdf
from flatgrasp_cli.sources.urdf_shapes import points_of

TIP_M = 0.02
"""How far from the fingertips' ends the pads are measured: about a pad's height."""
MOVES_M = 1e-4
"""Points that move less between open and closed belong to the palm."""
STRAIGHT_M = 5e-4
"""Tips that come out by less as they close move straight."""


@dataclass(frozen=True, slots=True)
class Hand:
    """What was measured, in metres and newtons.

    `approach` and `closing` are axes of the URDF's base, as "+x"; `force_n` is that of fingers that slide.
    """

    name: str
    approach: str
    closing: str
    parallel: bool
    min_opening: float
    max_opening: float
    finger_width: float
    finger_thickness: float
    finger_length: float | None
    tip_advance: float
    palm_offset: float | None
    hand_width: float | None
    palm: float | None
    force_n: float | None


def measured(urdf: Urdf) -> Hand:
    """Measure a gripper.

    Raises
    ------
    ProfileError
        If it has no fingers that close on each other.
    """
    low, high = (_points(urdf, share) for share in (0.0, 1.0))
    moving = {link for link in low if len(low[link]) and np.abs(high[link] - low[link]).max() > MOVES_M}
    if len(moving) < 2:
        raise ProfileError(f"{urdf.path}: wants two fingers with shapes that move; {len(moving)} links do")
    axes = _axes(urdf, {link: low[link] for link in moving}, {link: high[link] for link in moving})
    states = sorted((_State(points, moving, axes) for points in (low, high)), key=lambda state: state.opening)
    closed, opened = states
    if opened.opening - closed.opening < MOVES_M or opened.opening <= 0:
        raise ProfileError(f"{urdf.path}: its fingers do not open along {_name(axes[0])}; is it a gripper's URDF?")
    palm = np.vstack([np.empty((0, 3)), *(low[link] for link in low if link not in moving)]) @ axes.T
    has_palm = len(palm) > 0
    top = float(palm[:, 1].max()) if has_palm else 0.0
    sliding = [each for each in _driven(urdf) if each.kind == "prismatic"]
    return Hand(
        name=urdf.name,
        approach=_name(axes[1]),
        closing=_name(axes[0]),
        parallel=len(sliding) == len(_driven(urdf)) and abs(closed.end - opened.end) < STRAIGHT_M,
        min_opening=max(closed.opening, 0.0),
        max_opening=opened.opening,
        finger_width=opened.width,
        finger_thickness=opened.thickness,
        finger_length=opened.end - top if has_palm else None,
        tip_advance=max(closed.end - opened.end, 0.0),
        palm_offset=max(top, 0.0) if has_palm else None,
        hand_width=float(np.ptp(palm[:, 2])) if has_palm else None,
        palm=float(np.ptp(palm[:, 0])) if has_palm else None,
        force_n=max((each.effort for each in sliding), default=0.0) or None,
    )


class _State:
    """The fingers at one opening, in the hand's axes: closing, approach, width."""

    def __init__(self, points: dict[str, FloatArray], moving: set[str], axes: FloatArray) -> None:
        fingers = [points[link] @ axes.T for link in sorted(moving)]
        places = [float(finger[:, 0].mean()) for finger in fingers]
        middle = 0.5 * (min(places) + max(places))
        jaws = [
            np.vstack([finger for finger, place in zip(fingers, places, strict=True) if (place > middle) == side])
            for side in (False, True)
        ]
        self.end = float(min(jaw[:, 1].max() for jaw in jaws))
        tips = [jaw[jaw[:, 1] > jaw[:, 1].max() - TIP_M] for jaw in jaws]
        self.opening = float(tips[1][:, 0].min() - tips[0][:, 0].max())
        self.width = float(max(np.ptp(tip[:, 2]) for tip in tips))
        self.thickness = float(max(np.ptp(tip[:, 0]) for tip in tips))


def _axes(urdf: Urdf, low: dict[str, FloatArray], high: dict[str, FloatArray]) -> FloatArray:
    """The hand's closing axis, approach and width (3, 3), rows, each along an axis of the URDF's base."""
    shifts = np.array([(high[link] - low[link]).mean(axis=0) for link in low])
    spread = np.abs(shifts - shifts.mean(axis=0)).max(axis=0)  # what fingers do together is no closing
    closing = int(np.argmax(spread))
    ends = np.vstack(list(low.values()))
    far = np.where(np.abs(ends.max(axis=0)) >= np.abs(ends.min(axis=0)), ends.max(axis=0), ends.min(axis=0))
    far[closing] = 0.0
    approach = int(np.argmax(np.abs(far)))
    if spread[closing] < MOVES_M:
        raise ProfileError(f"{urdf.path}: its fingers do not move toward each other")
    axes = np.zeros((3, 3))
    axes[0, closing], axes[1, approach], axes[2, 3 - closing - approach] = 1.0, np.sign(far[approach]), 1.0
    return axes


def _name(axis: FloatArray) -> str:
    k = int(np.argmax(np.abs(axis)))
    return f"{'+' if axis[k] > 0 else '-'}{'xyz'[k]}"


def _driven(urdf: Urdf) -> list[Joint]:
    return [each for each in urdf.joints.values() if each.kind in ("prismatic", "revolute") and each.mimic is None]


def _points(urdf: Urdf, share: float) -> dict[str, FloatArray]:
    """Points (n, 3) of every link in the base's frame, each driven joint at a share of its range."""
    found = {}
    for link in urdf.links:
        turn, place = Rotation.identity(), np.zeros(3)
        for joint in urdf.chain_to(link):
            place = place + turn.apply(joint.xyz)
            turn = turn * Rotation.from_euler("xyz", joint.rpy)
            value = _value(urdf, joint, share)
            if joint.kind == "prismatic":
                place = place + turn.apply(np.array(joint.axis) * value)
            elif joint.kind != "fixed":
                turn = turn * Rotation.from_rotvec(np.array(joint.axis) * value)
        shapes = points_of(urdf, link)
        found[link] = turn.apply(shapes) + place if len(shapes) else shapes
    return found


def _value(urdf: Urdf, joint: Joint, share: float, depth: int = 0) -> float:
    if joint.mimic is None or depth > len(urdf.joints):
        low, high = joint.limits if joint.kind in ("prismatic", "revolute") else (0.0, 0.0)
        return low + share * (high - low)
    other = next((each for each in urdf.joints.values() if each.name == joint.mimic.joint), None)
    if other is None:
        raise ProfileError(f"{urdf.path}: joint {joint.name!r} mimics {joint.mimic.joint!r}, which is not there")
    return joint.mimic.multiplier * _value(urdf, other, share, depth + 1) + joint.mimic.offset
