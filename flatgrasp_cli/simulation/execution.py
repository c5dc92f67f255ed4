"""One grasp, carried out: from the pre-grasp straight to the grasp, close, lift, shake; and what came of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Pose
from flatgrasp_cli.simulation.parts import NAMES, Kind
from flatgrasp_cli.simulation.world import Touch, World

SPEED_M_S = 0.15
"""Of the hand on its way in and up: a careful robot's."""
WAYPOINTS = 21
"""Poses on a straight way: 5 mm apart on 10 cm, between which an arm's joints go straight."""
HOLD_S = 0.2
"""Fingers press for so long before the lift."""
SHAKE_M, SHAKE_HZ, SHAKE_S = 0.015, (3.0, 2.0), 1.0
"""How far and how often the lifted hand is shaken along x and y: with half of gravity at its ends."""
SHORT_M = 0.005
"""A hand that ends farther from the grasp than this ran into something."""
HELD_SHARE = 0.5
"""What is still so far up, as a share of the lift, when the hand has been shaken, is held."""

UNSTABLE = "the physics became unstable: the object or the force is far from what hands hold"
OUT_OF_REACH = "the arm does not reach the way that it has to go by"

Outcome = Literal["held", "lost", "collision"]


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """A grasp to carry out: the palm's poses at pre-grasp, grasp and lift, and how far open the hand comes.

    If it goes `back_first`, the hand is at the pre-grasp pose again before it is lifted.
    """

    pre_grasp: Pose
    grasp: Pose
    lift: Pose
    opening_m: float
    back_first: bool = False

    @property
    def way_up(self) -> list[Pose]:
        """The way from the grasp to the lift."""
        if not self.back_first:
            return _straight(self.grasp, self.lift)
        return [*_straight(self.grasp, self.pre_grasp), *_straight(self.pre_grasp, self.lift)[1:]]


@dataclass(frozen=True, slots=True, eq=False)
class Execution:
    """What came of a grasp.

    `clean` says that nothing was touched before the fingers closed. `thing` is the number of what was held, None for
    nothing; `lifted_m` how far up the place came that was between the fingertips, `pushed_m` how far anything was moved
    before they closed.
    """

    status: Outcome
    clean: bool
    reason: str | None
    thing: int | None
    lifted_m: float
    pushed_m: float


def execute(world: World, order: Order) -> Execution:
    """Carry out a grasp by the hand of a world that is at its pre-grasp pose, open as ordered."""
    start = world.centers()
    way_in = world.carrier.controls(_straight(order.pre_grasp, order.grasp))
    way_up = world.carrier.controls(order.way_up, way_in[-1])
    if np.isnan(way_in).any() or np.isnan(way_up).any():
        return _ended("lost", OUT_OF_REACH)
    touched = world.touched() | world.ease(way_in, _seconds(world, _straight(order.pre_grasp, order.grasp), way_in))
    pushed_m = float(np.linalg.norm(world.centers() - start, axis=1).max())
    clean, hit = not touched, _hit(world, order, touched)
    if hit is not None:
        return replace(_ended("collision", hit), clean=clean, pushed_m=pushed_m)
    at_grasp, hand = way_in[-1:], world.hand
    world.follow(at_grasp, hand.seconds, (hand.control(order.opening_m), hand.closed))
    world.follow(at_grasp, HOLD_S)
    grip = _Grip(world, order)
    world.ease(way_up, _seconds(world, order.way_up, way_up))
    came_up = grip.held()
    shaken = world.carrier.controls(_shaken(order.lift))
    if not np.isnan(shaken).any():  # an arm that is stretched cannot shake
        world.follow(shaken, SHAKE_S)
    if world.unstable:
        return _ended("lost", UNSTABLE)
    held = grip.held()
    return Execution(
        status="lost" if held is None else "held",
        clean=clean,
        reason=None if held is not None else _why_lost(came_up is not None),
        thing=held,
        lifted_m=max(grip.risen_m(number) for number in world.present),
        pushed_m=pushed_m,
    )


class _Grip:
    """What is between the fingertips when they have closed, and whether it is still there.

    An object that is gripped at its end turns as it is lifted and may still touch the table, so what counts is the
    place where it was gripped, and that fingers touch it.
    """

    def __init__(self, world: World, order: Order) -> None:
        palm, turn = world.palm()
        self._world, self._lift_m = world, float(order.lift.position[2] - order.grasp.position[2])
        tips = palm + turn.apply([0.0, 0.0, world.hand.reach_m(world.model, world.data)])
        self._height_m = float(tips[2])
        self._places = {k: pose[1].inv().apply(tips - pose[0]) for k in world.present for pose in [world.pose(k)]}

    def risen_m(self, number: int) -> float:
        """How far the place of a thing that was between the fingertips has risen."""
        at, turn = self._world.pose(number)
        return float((at + turn.apply(self._places[number]))[2] - self._height_m)

    def held(self) -> int | None:
        """The number of the thing that is held; None if none is."""
        fingered = self._world.fingered()
        up = [number for number in fingered if self.risen_m(number) > HELD_SHARE * self._lift_m]
        return max(up, key=self.risen_m, default=None)


def _ended(status: Outcome, reason: str) -> Execution:
    """What comes of a grasp that is not carried out to its end."""
    return Execution(status=status, clean=False, reason=reason, thing=None, lifted_m=0.0, pushed_m=0.0)


def _straight(begin: Pose, end: Pose) -> list[Pose]:
    """Poses on the straight way between two of one orientation."""
    shares = np.linspace(0.0, 1.0, WAYPOINTS)
    return [Pose(begin.position + share * (end.position - begin.position), end.orientation) for share in shares]


def _shaken(lift: Pose) -> list[Pose]:
    """Poses of a hand that is shaken; it begins and ends at rest."""
    times = np.linspace(0.0, SHAKE_S, round(200 * SHAKE_S))
    fade = np.minimum(1.0, 10 * np.minimum(times, SHAKE_S - times) / SHAKE_S)
    shifts = np.zeros((len(times), 3))
    for axis, frequency in enumerate(SHAKE_HZ):
        shifts[:, axis] = SHAKE_M * fade * np.sin(2 * np.pi * frequency * times)
    return [Pose(lift.position + shift, lift.orientation) for shift in shifts]


def _seconds(world: World, way: list[Pose], controls: FloatArray) -> float:
    """How long a way takes: an easy start and end make the middle half as fast again as the mean."""
    long_m = sum(float(np.linalg.norm(b.position - a.position)) for a, b in pairwise(way))
    return max(1.5 * long_m / SPEED_M_S, world.carrier.seconds(controls))


def _hit(world: World, order: Order, touched: set[Touch]) -> str | None:
    """Why the way in is a collision; None where it is none: what the fingers brush may still be held."""
    hard = sorted(touch for touch in touched if touch != Touch(Kind.FINGER, Kind.THING))
    if hard:
        return touch_in_words(hard[-1])
    palm, _ = world.palm()
    if float(np.linalg.norm(palm - order.grasp.position)) > SHORT_M:
        return "the fingers ran into the object on the way to the grasp"
    return None


def touch_in_words(touch: Touch, way: str = "to the grasp") -> str:
    """What a part of the robot touched, in words."""
    return f"{NAMES[touch.part]} touched {NAMES[touch.what]} on the way {way}"


def _why_lost(lifted: bool) -> str:
    return "the object slipped out when it was shaken" if lifted else "the object was not lifted"
