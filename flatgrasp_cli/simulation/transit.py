"""The way of the hand from where the camera looked to the pre-grasp pose.

It is looked at pose by pose and not driven: nothing but contacts could happen on it. An arm's joints go straight, or if
that touches something, by way of a pose above.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Pose
from flatgrasp_cli.simulation.execution import Execution, Order, touch_in_words
from flatgrasp_cli.simulation.world import Touch, World

STEP_RAD = 0.02
"""Turn of a joint between two looks: a hand a metre away moves by 2 cm."""
ABOVE_M = 0.15
"""How far above the pre-grasp the way round leads: higher than what lies on the table is, as a rule."""


def go_to(world: World, order: Order, start: FloatArray, near: FloatArray | None) -> Execution | None:
    """Put the hand at the pre-grasp, open; the collision where its way there from the control `start` is not free.

    `near` are an arm's joints (6,) that those at the pre-grasp are near to; None for a floating hand, which is put
    there at once.
    """
    if near is None:
        world.place(world.carrier.controls([order.pre_grasp])[0], order.opening_m)
        touched = world.touched()
    else:
        over = Pose(order.pre_grasp.position + np.array([0.0, 0.0, ABOVE_M]), order.pre_grasp.orientation)
        end, above = world.carrier.controls([order.pre_grasp, over], near)
        touched = _swept(world, [start, end], order.opening_m)
        if touched and not np.isnan(above).any():
            touched = _swept(world, [start, above, end], order.opening_m)
    if not touched:
        return None
    return Execution(
        status="collision",
        clean=False,
        reason=touch_in_words(max(touched), "to the pre-grasp"),
        thing=None,
        lifted_m=0.0,
        pushed_m=0.0,
    )


def _swept(world: World, stops: list[FloatArray], opening_m: float) -> set[Touch]:
    """What the robot touches on straight ways from stop to stop; it ends at the last, or at the first touch."""
    for begin, end in pairwise(stops):
        steps = max(int(np.abs(end - begin).max() / STEP_RAD), 1)
        for share in np.arange(1, steps + 1) / steps:
            world.place(begin + share * (end - begin), opening_m)
            world.data.time += STEP_RAD  # as if at a radian a second
            if world.watch is not None:
                world.watch()
            if touched := world.touched():
                return touched
    return set()
