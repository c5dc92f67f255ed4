"""What a hand meets in the plane that does not stand where it should: whether it closes on the object all the same."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray, chunks
from flatgrasp_cli.geometry.chain import closed_chain
from flatgrasp_cli.geometry.polygon import dot, left_normal
from flatgrasp_cli.model import OpenHands
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.ranking.errors import Errors

RIM_SHARE = 0.25
"""The share of a fingertip's size, on each side, that is its rim: what it meets with that it pushes aside, or is pushed
aside by. Of 48 simulated fingertips that came down on an object with no more than that, 42 held it nevertheless."""
ON_EDGE_M = 1e-6
"""A contact nearer than this to the pad's edge, metres, is on it: rounding moves it by less."""
SHORTEST_M = 1e-6
"""The least breadth that a slope is taken over, metres."""
AT_ONCE = 30
"""As many hands at once as chunks are made for: what they meet is a small part of the silhouette."""


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


class _Edges(NamedTuple):
    """The parts of the silhouette's edges, from a to b, that lie in a strip along the closing axis of some hands.

    (e,) each, in the order of the `hand` that sees them; x is across the closing axis, and y out to the jaw.
    """

    hand: IntArray
    ax: FloatArray
    ay: FloatArray
    bx: FloatArray
    by: FloatArray

    def select(self, keep: BoolArray | IntArray) -> _Edges:
        """Those that a mask or an index array names."""
        return _Edges(hand=self.hand[keep], ax=self.ax[keep], ay=self.ay[keep], bx=self.bx[keep], by=self.by[keep])

    def within(self, low: float, high: float) -> _Edges:
        """Those that meet a narrower strip, cut to it."""
        met = np.flatnonzero((np.minimum(self.ax, self.bx) < high) & (np.maximum(self.ax, self.bx) > low))
        hand, ax, ay, bx, by = self.select(met)
        run = bx - ax
        slope = (by - ay) / np.where(run == 0, 1.0, run)
        from_x, to_x = ax.clip(low, high), bx.clip(low, high)
        return _Edges(hand=hand, ax=from_x, ay=ay + slope * (from_x - ax), bx=to_x, by=by + slope * (to_x - bx))

    def above(self, level: FloatArray) -> _Edges:
        """Those that reach farther out than `level` (e,), cut to what does."""
        met = np.flatnonzero(self.top >= level)
        (hand, ax, ay, bx, by), level = self.select(met), level[met]
        rise = by - ay
        run = (bx - ax) / np.where(rise == 0, 1.0, rise)
        from_y, to_y = np.maximum(ay, level), np.maximum(by, level)
        return _Edges(hand=hand, ax=ax + run * (from_y - ay), ay=from_y, bx=ax + run * (to_y - ay), by=to_y)

    @property
    def top(self) -> FloatArray:
        """How far out each reaches."""
        return np.asarray(np.maximum(self.ay, self.by))


class _Outline(NamedTuple):
    """The silhouette's vertices, as p hands see them, at `x` and `y` (p, n); all but a loop's last are `joined`."""

    x: FloatArray
    y: FloatArray
    joined: BoolArray

    def within(self, low: float, high: float) -> _Edges:
        """What the hands see of it in a strip."""
        below, above = self.x < high, self.x > low
        meets = (below[:, :-1] | below[:, 1:]) & (above[:, :-1] | above[:, 1:]) & self.joined
        hand, edge = np.divmod(np.flatnonzero(meets), self.x.shape[1] - 1)
        begin = hand * self.x.shape[1] + edge
        ends = (column.take(row) for row in (begin, begin + 1) for column in (self.x, self.y))
        return _Edges(hand, *ends).within(low, high)


class _Pad(NamedTuple):
    """A finger's pad from `left` to `right`, and what of the object it may touch."""

    left: float
    right: float
    edges: _Edges


class _Touch(NamedTuple):
    """What one jaw of p hands comes to, (p,) each, with `free` as in `Closed`.

    Its pads come to rest at `reach`, −∞ if nothing stops them. If they touch the object only with an edge, `slope` is
    how steep its side is there.
    """

    free: BoolArray
    reach: FloatArray
    slope: FloatArray


def closed(loops: Sequence[FloatArray], hands: OpenHands, gripper: Gripper, tolerance_m: float) -> Closed:
    """Closes p hands on the silhouette `loops`; its points within `tolerance_m` of the outermost are touched alike."""
    points, breaks = closed_chain(loops)
    joined = np.ones(len(points) - 1, dtype=np.bool_)
    joined[breaks] = False
    parts = []
    across = left_normal(hands.axis)
    for part in chunks(len(hands), max(1, len(points) // AT_ONCE)):
        face, aside, along = 0.5 * hands.opening[part], across[part], hands.axis[part]
        x = aside @ points.T - dot(hands.center[part], aside)[:, None]
        y = along @ points.T - dot(hands.center[part], along)[:, None]
        one, other = (
            _touch(_Outline(x, sign * y, joined), face, offsets, gripper, tolerance_m)
            for sign, offsets in zip((-1.0, 1.0), gripper.jaws, strict=True)
        )
        slopes = np.arctan(one.slope) + np.arctan(other.slope)  # inward normals, toward the same side
        parts.append(
            Closed(
                free=one.free & other.free,
                room=face + RIM_SHARE * gripper.finger_thickness_m - np.maximum(one.reach, other.reach),
                between=np.isfinite(one.reach + other.reach) & (one.reach + other.reach > 0),
                wedge=0.5 * np.abs(slopes),
            )
        )
    return Closed(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _touch(
    outline: _Outline, face: FloatArray, offsets: tuple[float, ...], gripper: Gripper, tolerance_m: float
) -> _Touch:
    """What a jaw with fingers at `offsets` comes to that closes from `face` (p,), seen with +y out to it."""
    rim, core = RIM_SHARE * gripper.finger_thickness_m, (0.5 - RIM_SHARE) * gripper.finger_width_m
    near, far = face + rim, face + gripper.finger_thickness_m - rim
    free, pads = np.ones(len(face), dtype=np.bool_), []
    for offset in offsets:
        left, right = offset - 0.5 * gripper.finger_width_m, offset + 0.5 * gripper.finger_width_m
        edges = outline.within(left, right)
        free &= ~_overlap(edges.within(offset - core, offset + core), near, far)
        free &= ~_holds(edges, offset, 0.5 * (near + far))
        pads.append(_Pad(left, right, edges.select(edges.top <= near[edges.hand])))
    reach = np.max([_highest(pad.edges.hand, pad.edges.top, len(face)) for pad in pads], axis=0)
    return _Touch(free, reach, _slope(pads, reach, tolerance_m))


def _overlap(edges: _Edges, near: FloatArray, far: FloatArray) -> BoolArray:
    """Whether any of the edges passes between `near` and `far` (p,)."""
    met = (edges.top > near[edges.hand]) & (np.minimum(edges.ay, edges.by) < far[edges.hand])
    return np.asarray(np.bincount(edges.hand[met], minlength=len(near)) > 0)


def _holds(edges: _Edges, x: float, y: FloatArray) -> BoolArray:
    """Whether the points (x, y) (p,) lie inside: oddly many edges pass above."""
    hand, ax, ay, bx, by = edges.select((edges.ax > x) != (edges.bx > x))
    above = ay + (x - ax) * (by - ay) / (bx - ax) > y[hand]
    return np.asarray(np.bincount(hand[above], minlength=len(y)) % 2 == 1)


def _slope(pads: Sequence[_Pad], reach: FloatArray, tolerance_m: float) -> FloatArray:
    """How steeply (p,) the object's side rises toward +x where it touches the pads only at their edge; otherwise 0."""
    count = len(reach)
    hands, places, heights = [], [], []
    at_left, at_right = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    for left, right, edges in pads:
        high = edges.above(reach[edges.hand] - tolerance_m)
        hand, x, y = np.tile(high.hand, 2), np.append(high.ax, high.bx), np.append(high.ay, high.by)
        top = y >= reach[hand] - ON_EDGE_M
        at_left[hand[top & (x <= left + ON_EDGE_M)]] = True
        at_right[hand[top & (x >= right - ON_EDGE_M)]] = True
        hands.append(hand)
        places.append(x)
        heights.append(y)
    hand, x, y = np.concatenate(hands), np.concatenate(places), np.concatenate(heights)
    breadth = _highest(hand, x, count) + _highest(hand, -x, count)
    found = np.isfinite(breadth)
    rise = np.where(found, reach + _highest(hand, -y, count), 0.0)
    steep = at_right.astype(np.float64) - at_left
    return np.asarray(steep * rise / np.where(found, breadth, 1.0).clip(SHORTEST_M))


def _highest(hand: IntArray, values: FloatArray, count: int) -> FloatArray:
    """The largest of the `values` (e,) of each hand (count,); −∞ for one that has none."""
    largest = np.full(count, -np.inf)
    np.maximum.at(largest, hand, values)
    return largest


def moved(center: FloatArray, axis: FloatArray, errors: Errors) -> tuple[FloatArray, FloatArray]:
    """Centres and axes (k, s, 2) of k hands, from where they should be and as they miss in s samples."""
    aside = left_normal(axis)
    where = center[:, None] + errors.across[:, None] * aside[:, None] + errors.along[:, None] * axis[:, None]
    turned = np.cos(errors.yaw)[:, None] * axis[:, None] + np.sin(errors.yaw)[:, None] * aside[:, None]
    return where, turned
