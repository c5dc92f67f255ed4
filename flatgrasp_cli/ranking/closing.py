"""What a hand meets in the plane that stands where it should not: beside the object, on it, or well on both sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.chain import Chain, closed_chain
from flatgrasp_cli.geometry.polygon import in_frames, left_normal
from flatgrasp_cli.model import OpenHands
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.ranking.errors import Errors

ON_EDGE_M = 1e-6
"""A contact nearer than this to the pad's edge, metres, is on it: rounding moves it by less."""
SHORTEST_M = 1e-4
"""The least breadth that a slope is taken over, metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Closed:
    """What p hands come to, (p,) each.

    `free` is whether the open fingers stand beside the object, with `room`, metres, between the nearer pad and the
    object, and `between` whether the object is between them.
    Once the object has turned as the pads turn it, its sides are a `wedge` of half this angle, radians, that friction
    has to hold.
    """

    free: BoolArray
    room: FloatArray
    between: BoolArray
    wedge: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Touch:
    """What one jaw of p hands meets: seen with +y out to that jaw, from midway between the pads.

    It stands `free` (p,) if the middle of its fingertips does, half as wide and half as thick: what they meet with
    their rims they push aside, or are pushed aside by.

    `reach` (p,) is where its pads come to rest, −∞ if nothing stops them. They touch from `low` to `high` (p,), and
    the object's side rises by `slope` (p,) there if they touch it only with an edge, otherwise 0.
    """

    free: BoolArray
    reach: FloatArray
    low: FloatArray
    high: FloatArray
    slope: FloatArray


def closed(loops: Sequence[FloatArray], hands: OpenHands, gripper: Gripper, tolerance_m: float) -> Closed:
    """Closes p hands on the silhouette `loops`; its points within `tolerance_m` of the outermost are touched alike."""
    points, breaks = closed_chain(loops)
    x, y = in_frames(points, hands.center, hands.axis)
    chain = Chain.of(x, y, breaks)
    face = 0.5 * hands.opening
    one = _touch(chain.flipped(), face, gripper, gripper.jaws[0], tolerance_m)
    other = _touch(chain, face, gripper, gripper.jaws[1], tolerance_m)
    between = np.isfinite(one.reach) & np.isfinite(other.reach) & (one.reach + other.reach > 0)
    width = np.where(between, one.reach + other.reach, np.inf)
    # angles, from the closing axis toward +x: of the line from one contact to the other, and of both inward normals
    least, most = (np.arctan2(run, width) for run in (other.low - one.high, other.high - one.low))
    first, second = np.arctan(one.slope), -np.arctan(other.slope)
    middle, wedge = 0.5 * (first + second), 0.5 * np.abs(first - second)
    turn = np.maximum(np.maximum(least - middle, middle - most), 0.0)
    room = face + 0.25 * gripper.finger_thickness_m - np.maximum(one.reach, other.reach)
    return Closed(one.free & other.free, room, between, wedge, turn, width)


def _touch(chain: Chain, face: FloatArray, gripper: Gripper, offsets: tuple[float, ...], tolerance_m: float) -> _Touch:
    """What a jaw with fingers at `offsets` meets as it closes from `face` (p,), for a silhouette seen with +y out."""
    rim = 0.25 * gripper.finger_thickness_m
    near, far = face + rim, face + 3 * rim
    free, found = np.ones(len(face), dtype=np.bool_), []
    for offset in offsets:
        core = 0.25 * gripper.finger_width_m
        meets, lowest, highest = chain.clipped(offset - core, offset + core)
        free &= ~(meets & (highest > near) & (lowest < far)).any(axis=0) & ~chain.holds(offset, 0.5 * (near + far))
        left, right = offset - 2 * core, offset + 2 * core
        meets, _, highest = chain.clipped(left, right)
        found.append((left, right, meets & (highest <= near), highest))
    reach = np.max([np.where(inside, highest, -np.inf).max(axis=0) for _, _, inside, highest in found], axis=0)
    low, high, floor = np.full(len(face), np.inf), np.full(len(face), -np.inf), reach.copy()
    level = reach - tolerance_m
    at_left, at_right = np.zeros(len(face), dtype=np.bool_), np.zeros(len(face), dtype=np.bool_)
    for left, right, inside, _ in found:
        for rows in (slice(None, -1), slice(1, None)):
            x = chain.x[rows].clip(left, right)
            y = chain.y[rows] + chain.slope * (x - chain.x[rows])
            touched = inside & (y >= level)
            low = np.minimum(low, np.where(touched, x, np.inf).min(axis=0))
            high = np.maximum(high, np.where(touched, x, -np.inf).max(axis=0))
            floor = np.minimum(floor, np.where(touched, y, np.inf).min(axis=0))
            top = touched & (y >= reach - 1e-9)
            at_left |= (top & (x <= left + ON_EDGE_M)).any(axis=0)
            at_right |= (top & (x >= right - ON_EDGE_M)).any(axis=0)
    steep = np.where(at_right & ~at_left, 1.0, np.where(at_left & ~at_right, -1.0, 0.0))
    known = np.isfinite(low) & np.isfinite(high)
    breadth = np.where(known, np.maximum(np.where(known, high - low, 0.0), SHORTEST_M), 1.0)
    with np.errstate(invalid="ignore"):
        slope = np.where(known, steep * (reach - floor) / breadth, 0.0)
    return _Touch(free, reach, np.where(known, low, 0.0), np.where(known, high, 0.0), slope)


def moved(center: FloatArray, axis: FloatArray, errors: Errors) -> tuple[FloatArray, FloatArray]:
    """Centres and axes (k, s, 2) of k hands, from where they should be and as they miss in s samples."""
    aside = left_normal(axis)
    where = center[:, None] + errors.across[:, None] * aside[:, None] + errors.along[:, None] * axis[:, None]
    turned = np.cos(errors.yaw)[:, None] * axis[:, None] + np.sin(errors.yaw)[:, None] * aside[:, None]
    return where, turned
