"""Whether an arm can carry out a grasp: pre-grasp, approach, grasp and lift on one branch of its inverse kinematics.

Arrays over paths are (b, w, n): branch, waypoint, grasp; those over joint angles (j, b, w, n). Along a branch a joint
turns continuously, so its angles are known up to whole turns, as many for all waypoints. A hand turned by 180° about
its z axis has the last joint turned by as much and the others as they were, if that turns about the flange's z axis:
where the twin will do as well, the last joint's angles are known up to half turns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.model import Reach
from flatgrasp_cli.profiles.robot import Robot
from flatgrasp_cli.robot.arms import arm_of
from flatgrasp_cli.robot.motion import Motion

LIMITS = ("out of reach", "joint limit", "joint step", "manipulability", "below the table")
"""What may stop a branch, in the order of testing."""
MET = len(LIMITS)
BATCH = 128
"""Grasps followed at a time: few enough for their arrays to stay in the processor's cache."""
ROUNDING = 1e-9
"""Turns by which a joint may pass its limit: an angle of exactly 180° is within limits of 180°."""


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """The points p with `normal` (3,) · p = `offset_m` in the robot's base frame, the unit normal toward free space."""

    normal: FloatArray
    offset_m: float


def reach(
    robot: Robot,
    positions: FloatArray,
    axes: FloatArray,
    motion: Motion,
    table: Plane | None = None,
) -> tuple[Reach, ...]:
    """Whether the arm can carry out n grasps, each by the branch nearest to the profile's reference angles.

    The flange's `positions` (n, 3) at the grasps and its `axes` (n, 3, 3), whose rows are its x, y, z axes, are in the
    robot's `base_frame`, as are `motion` and `table`. The elbow and the wrists, with their radii, must stay above the
    table.
    """
    follower = _Follower(robot, motion, table)
    flange, axes = (follower.arm.in_own_base(vectors) for vectors in (positions, axes))
    before = flange - motion.approach_m * axes[:, 2]
    (near,) = (np.linalg.norm(before - follower.arm.shoulder, axis=1) <= follower.arm.span_m).nonzero()
    answers = [Reach(ok=False, waypoint="pre_grasp", limit=LIMITS[0])] * len(positions)
    for batch in (near[start : start + BATCH] for start in range(0, len(near), BATCH)):
        for row, answer in zip(batch.tolist(), follower.follow(flange[batch], axes[batch]), strict=True):
            answers[row] = answer
    return tuple(answers)


def is_too_far(robot: Robot, places: FloatArray) -> bool:
    """Whether the arm, stretched, brings its flange nowhere between `places` (n, 3) in the robot's `base_frame`.

    That is so if it ends short of the ball around them.
    """
    arm = arm_of(robot)
    middle = places.mean(axis=0)
    radius = np.linalg.norm(places - middle, axis=1).max()
    return bool(np.linalg.norm(middle - arm.in_own_base(arm.shoulder)) > arm.span_m + radius)


class _Follower:
    """A robot, a motion and a table in the base of its kinematics, ready to follow batches of grasps."""

    def __init__(self, robot: Robot, motion: Motion, table: Plane | None) -> None:
        self.arm, self.settings, self.approach_m = arm_of(robot), robot.reach, motion.approach_m
        self.back_first = motion.back_first
        self.twin = motion.twin and self.arm.turns_the_flange
        self.lift = self.arm.in_own_base(motion.lift_m * motion.lift_direction)
        self.lower, self.upper, self.reference = (
            np.radians(angles)[:, None, None, None]
            for angles in (robot.joints.lower_deg, robot.joints.upper_deg, robot.reach.reference_deg)
        )
        self.period = 2 * np.pi / np.array([1] * (robot.count - 1) + [2 if self.twin else 1])[:, None, None, None]
        self.normal = None if table is None else self.arm.in_own_base(table.normal)
        self.lowest = (0.0 if table is None else table.offset_m) + self.arm.radii_m[:, None, None, None]

    def follow(self, flange: FloatArray, axes: FloatArray) -> Iterator[Reach]:
        """The answers for n grasps, the flange's positions (n, 3) and axes (n, 3, 3) given."""
        path, step = self._unwound(flange, axes)
        least, most = self._turns_within_limits(path)
        ability = self.arm.manipulability(path)
        limit = self._limit(path, step, np.asarray((least <= most).all(axis=0)), ability)
        goes = (limit == MET).all(axis=1)
        turns, distance = self._nearest_turns(path[:, :, self.settings.steps], least[:, :, -1], most[:, :, -1])
        branch = np.argmin(np.where(goes, distance, np.inf), axis=0)
        stops = _stops(limit)
        for k, b in enumerate(branch.tolist()):
            yield self._answer(path[:, b, :, k], turns[:, b, k], ability[b, :, k]) if goes[b, k] else self._no(stops[k])

    def _unwound(self, flange: FloatArray, axes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Continuous angles (j, b, w, n) along the paths, and the largest turn (b, w, n) of any joint since before."""
        steps = self.settings.steps
        share = np.linspace(0.0, 1.0, steps + 1)[:, None, None]
        back = flange - (1 - share) * self.approach_m * axes[:, 2]
        returned = back[-2::-1] if self.back_first else back[:0]
        lifted = (back[0] if self.back_first else flange) + share[1:] * self.lift
        waypoints = np.concatenate([back, returned, lifted])
        path = self.arm.paths(waypoints, axes)
        turn = np.diff(path, axis=2)
        turn -= 2 * np.pi * np.round(turn / (2 * np.pi))
        path[:, :, 1:] = path[:, :, :1] + np.cumsum(turn, axis=2)
        step = np.zeros(path.shape[1:])
        step[:, 1:] = np.abs(turn).max(axis=0)
        return path, step

    def _turns_within_limits(self, path: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The least and the most periods (j, b, w, n) that may be added so that all angles so far are within limits."""
        least = (self.lower - np.minimum.accumulate(path, axis=2)) / self.period
        most = (self.upper - np.maximum.accumulate(path, axis=2)) / self.period
        return np.ceil(least - ROUNDING), np.floor(most + ROUNDING)

    def _limit(self, path: FloatArray, step: FloatArray, within: BoolArray, ability: FloatArray) -> IntArray:
        """Index (b, w, n) of the first limit that a waypoint fails, `MET` if none."""
        fails = [
            np.isnan(ability),
            ~within,
            step > np.radians(self.settings.max_step_deg),
            ability < self.settings.min_manipulability_share * self.arm.most_manipulability,
        ]
        if self.normal is not None:
            fails.append((self.arm.heights(path, self.normal) < self.lowest).any(axis=0))
        limit = np.full(ability.shape, MET)
        for index in reversed(range(len(fails))):
            limit[fails[index]] = index
        return limit

    def _nearest_turns(self, grasp: FloatArray, least: FloatArray, most: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Periods (j, b, n) to add, and what is left of the squared distance (b, n) of the grasp to the reference."""
        period, reference = self.period[:, :, 0], self.reference[:, :, 0]
        turns = np.clip(np.round((reference - grasp) / period), least, most)
        return turns, np.square(grasp + turns * period - reference).sum(axis=0)

    def _answer(self, path: FloatArray, turns: FloatArray, ability: FloatArray) -> Reach:
        """The answer of a branch that goes: its angles (j, w), periods to add (j,) and manipulability (w,)."""
        least = float(ability.min())
        return Reach(
            ok=True,
            joints_rad=(path[:, [0, self.settings.steps, -1]] + turns[:, None] * self.period[:, :, 0, 0]).T,
            manipulability=least,
            manipulability_share=least / self.arm.most_manipulability,
            twin=self.twin and bool(turns[-1] % 2),
        )

    def _no(self, stop: tuple[int, int]) -> Reach:
        """The answer where no branch goes: the waypoint and the limit at which the best one stops."""
        waypoint, limit = stop
        steps = self.settings.steps
        names = {0: "pre_grasp", steps: "grasp"}
        return Reach(
            ok=False, waypoint=names.get(waypoint, "approach" if waypoint < steps else "lift"), limit=LIMITS[limit]
        )


def _stops(limit: IntArray) -> list[tuple[int, int]]:
    """Waypoint and limit at which the branch stops that comes furthest, for n grasps; limits (b, w, n) as failed.

    Among branches that stop at the same waypoint the one furthest is that which fails the later test.
    """
    waypoints = limit.shape[1]
    first = np.argmax(limit < MET, axis=1)
    reason = np.take_along_axis(limit, first[:, None], axis=1)[:, 0]
    progress = np.where(reason < MET, first * MET + reason, waypoints * MET).max(axis=0)
    return [divmod(value, MET) for value in progress.tolist()]
