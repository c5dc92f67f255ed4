"""How far a hand may miss and still close into the same grasp.

A hand that misses by less than this stands free on the approach, and closing meets the object only once the fingers are
no further apart than `begin`, where the basin is certain: moving the hand from its right place to the wrong one at that
opening, its fingers touch nothing, so both placements are in one component of {σ ≤ begin}, and whatever is in it closes
into the same basin. What must be free is therefore each finger's sweep from its place on the approach to that at
`begin`, at every pose up to the error: exact geometry, not a sample of poses. Jaws are taken to move alike.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.chain import Chain, closed_chain
from flatgrasp_cli.geometry.polygon import in_frames
from flatgrasp_cli.kernels.clearance import clearance
from flatgrasp_cli.model import Tolerance
from flatgrasp_cli.proof.caging.hands import Box, Hands

TURNS, LEFT_M = 30, 1e-4
"""A turn goes on in steps that the clearance allows, until that is used up but for this."""
TOUCH_M = 1e-6
MOST_TURN = 0.5 * np.pi


def tolerances(loops: Sequence[FloatArray], hands: Hands, boxes: Sequence[Box]) -> tuple[Tolerance, ...]:
    """How far each of k hands may miss the region `loops` so that its `boxes` stay off it."""
    points, breaks = closed_chain(loops)
    outline = Chain.of(*in_frames(points, hands.center, hands.axis), breaks)
    position = _clearance(outline.x, outline.y, breaks, boxes)
    free = position > TOUCH_M
    position = np.where(free, position, 0.0)
    along, across = np.where(free, _shifts(outline, boxes), 0.0)
    lever = np.max([np.hypot(corner_x, corner_y) for box in boxes for corner_x, corner_y in box.corners], axis=0)
    turn = np.where(free, _turn(outline, boxes, lever, position), 0.0)
    figures = np.column_stack([position, along, across, np.degrees(turn), lever])
    return tuple(Tolerance(*row) for row in figures.tolist())


def _shifts(outline: Chain, boxes: Sequence[Box]) -> FloatArray:
    """How far (2, k) all boxes can move either way along y, and along x, until one touches."""
    turned, least = [], np.full((2, outline.x.shape[1]), np.inf)
    for box in boxes:
        meets, lowest, highest = outline.clipped(box.low, box.high)
        apart = np.maximum(lowest - box.far, box.near - highest)
        least[0] = np.minimum(least[0], np.where(meets, apart, np.inf).min(axis=0))
    for box in boxes:
        middle = 0.5 * (box.near + box.far)  # strips as wide as each hand's box: seen in units of it
        scale = 0.5 * (box.far - box.near)
        aside = Chain.of((outline.y - middle) / scale, outline.x, outline.breaks)
        meets, lowest, highest = aside.clipped(-1.0, 1.0)
        apart = np.maximum(lowest - box.high, box.low - highest)
        turned.append(np.where(meets, apart, np.inf).min(axis=0))
    least[1] = np.min(turned, axis=0)
    return np.asarray(np.maximum(least, 0.0))


def _clearance(x: FloatArray, y: FloatArray, breaks: IntArray, boxes: Sequence[Box]) -> FloatArray:
    """Distance (k,) of an outline, a chain with vertices (n, k), to the nearest of the boxes; 0 if they overlap."""
    joined = np.ones(len(x) - 1, dtype=np.uint8)
    joined[breaks] = 0
    apart = [clearance(x, y, joined, np.array([box.low, box.high]), np.stack([box.near, box.far])) for box in boxes]
    return np.asarray(np.min(apart, axis=0))


def _turn(
    outline: Chain,
    boxes: Sequence[Box],
    lever: FloatArray,
    clearance: FloatArray,
) -> FloatArray:
    """How far (k,) the hands can turn both ways, radians: no point of a finger moves faster than `lever` (k,) does."""
    x, y = (np.tile(each, 2) for each in (outline.x, outline.y))
    both = [Box(box.low, box.high, np.tile(box.near, 2), np.tile(box.far, 2)) for box in boxes]
    lever, left = np.tile(lever, 2), np.tile(clearance, 2)
    way = np.repeat([1.0, -1.0], len(clearance))
    angle = np.zeros(len(way))
    for _ in range(TURNS):
        angle = np.minimum(angle + left / lever, MOST_TURN)
        cosine, sine = np.cos(angle), way * np.sin(angle)
        left = _clearance(cosine * x + sine * y, cosine * y - sine * x, outline.breaks, both)
        if (left < LEFT_M).all():
            break
    return np.asarray(angle.reshape(2, -1).min(axis=0))
