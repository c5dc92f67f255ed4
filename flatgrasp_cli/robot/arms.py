"""What reach asks of an arm, whatever its kinematics: paths of joint angles, and what limits them.

Joint angles are (j, …), those along paths (j, b, w, n): joint, branch, waypoint, grasp. Positions and directions are in
the arm's own base, which `in_own_base` takes those of the robot's `base_frame` to, and those of its own base back.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Protocol

import numpy as np

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.profiles.chain import Chain
from flatgrasp_cli.profiles.robot import DenavitHartenberg, Robot
from flatgrasp_cli.robot.chain import Joints, Stance
from flatgrasp_cli.robot.closed_form import ClosedForm
from flatgrasp_cli.robot.frames import in_dh_base
from flatgrasp_cli.robot.kinematics import forward, heights, inverse, manipulability, max_manipulability

STANCES = 4096
"""Joint angles, drawn evenly, among which an arm's largest manipulability is looked for: other draws of as many differ
by some percent, where the limit is a few percent of it."""
FOLLOWED = 8
"""Solutions of a grasp that are followed, those nearest to the reference stance, of which the nearest that goes on is
taken: as many as an arm of six joints usually has. Of seven there are as many for each value of the locked one."""
ALONG = 1e-6
"""By how much the last axis may miss the flange's z axis, metres and sine."""


class Arm(Protocol):
    """The kinematics of an arm."""

    @property
    def most_manipulability(self) -> float:
        """The largest manipulability, Yoshikawa's, of any joint angles, m³."""

    @property
    def radii_m(self) -> FloatArray:
        """How thick the links are where `heights` are asked for (k,), metres."""

    @property
    def shoulder(self) -> FloatArray:
        """Where the second joint is (3,), which the arm's reach is measured from."""

    @property
    def span_m(self) -> float:
        """The flange gets no farther from the shoulder than this, metres: with the links stretched, in any pose."""

    @property
    def turns_the_flange(self) -> bool:
        """Whether the last joint turns about the flange's z axis."""

    def in_own_base(self, vectors: FloatArray) -> FloatArray:
        """Points or directions (…, 3), given in the robot's `base_frame`, in the arm's own base, and back."""

    def paths(self, waypoints: FloatArray, axes: FloatArray) -> FloatArray:
        """Joint angles (j, b, w, n) that bring the flange to `waypoints` (w, n, 3), its `axes` (n, 3, 3) kept.

        They stay on their branch from waypoint to waypoint, up to whole turns; NaN where it does not exist.
        """

    def manipulability(self, angles: FloatArray) -> FloatArray:
        """Yoshikawa's measure (…) at joint angles (j, …), m³."""

    def heights(self, angles: FloatArray, normal: FloatArray) -> FloatArray:
        """How high (k, …) along `normal` (3,) the arm's links are from the elbow on, at joint angles (j, …)."""

    def links(self, angles: FloatArray) -> FloatArray:
        """Places (k, 3) along the links, from the base to the flange, at joint angles (j,)."""


class UrArm:
    """An arm of the UR family, in its Denavit–Hartenberg base."""

    turns_the_flange = True

    def __init__(self, robot: Robot, dh: DenavitHartenberg) -> None:
        self._dh, self._base = dh, robot.base_frame
        self.shoulder: FloatArray = np.array([0.0, 0.0, dh.d_m[0]])
        in_plane = abs(dh.a_m[1]) + abs(dh.a_m[2]) + abs(dh.d_m[4])  # of upper arm, forearm and wrist 2; wrist 1 beside
        self.span_m = float(np.hypot(in_plane, dh.d_m[3])) + abs(dh.d_m[5])
        links = robot.links
        self.radii_m: FloatArray = np.array(
            [links.elbow_m, max(links.forearm_m, links.wrist_m), links.wrist_m, links.wrist_m]
        )
        self.most_manipulability = max_manipulability(dh)

    def in_own_base(self, vectors: FloatArray) -> FloatArray:
        """See `Arm`."""
        return in_dh_base(self._base, vectors)

    def paths(self, waypoints: FloatArray, axes: FloatArray) -> FloatArray:
        """See `Arm`: the eight branches in their order."""
        w, n, _ = waypoints.shape
        joints = inverse(self._dh, waypoints.reshape(-1, 3), np.broadcast_to(axes, (w, n, 3, 3)).reshape(-1, 3, 3))
        return np.asarray(joints.transpose(2, 1, 0).reshape(6, 8, w, n))

    def manipulability(self, angles: FloatArray) -> FloatArray:
        """See `Arm`."""
        return manipulability(self._dh, np.moveaxis(angles, 0, -1))

    def heights(self, angles: FloatArray, normal: FloatArray) -> FloatArray:
        """See `Arm`: of elbow and wrists."""
        return heights(self._dh, angles, normal)

    def links(self, angles: FloatArray) -> FloatArray:
        """See `Arm`."""
        return self.in_own_base(np.vstack([np.zeros(3), forward(self._dh, angles)[:, :3, 3]]))


class ChainArm:
    """Any other arm: solved in closed form at the first waypoint, followed from there by Newton's method.

    Raises
    ------
    UsageError
        If EAIK is not installed, or the arm has no closed form.
    """

    def __init__(self, robot: Robot, chain: Chain) -> None:
        self._joints = Joints.of(chain)
        self._lower, self._upper = (np.radians(each) for each in (robot.joints.lower_deg, robot.joints.upper_deg))
        self._solver = ClosedForm(robot.name, self._joints, robot.lock, (self._lower, self._upper))
        self.shoulder = self._joints.points[1]
        links = np.diff([*self._joints.points[1:], self._joints.position], axis=0)
        aside = float(np.linalg.norm(np.cross(self._joints.axes[0], self.shoulder - self._joints.points[0])))
        self.span_m = float(np.linalg.norm(links, axis=1).sum()) + 2 * aside  # the shoulder itself goes round the base
        before_wrist = robot.count - 5  # joints from the third to the one before the wrist's three
        radii, self._reference = robot.links, np.radians(robot.reach.reference_deg)
        self.radii_m: FloatArray = np.array([radii.elbow_m] * before_wrist + [radii.wrist_m] * 3)
        drawn = np.random.default_rng(0).uniform(self._lower, self._upper, (STANCES, robot.count))
        self.most_manipulability = float(self.manipulability(drawn.T).max())
        z, arm = self._joints.turn[:, 2], self._joints.position - self._joints.points[-1]
        self.turns_the_flange = bool(
            np.linalg.norm(np.cross(self._joints.axes[-1], z)) < ALONG and np.linalg.norm(np.cross(arm, z)) < ALONG
        )

    def in_own_base(self, vectors: FloatArray) -> FloatArray:
        """See `Arm`: the same frame."""
        return vectors

    def paths(self, waypoints: FloatArray, axes: FloatArray) -> FloatArray:
        """See `Arm`; solutions that pass a limit at once stay where they are, and the others go on."""
        rows, angles = self._solver.solve(waypoints[0], axes)
        chosen = self._chosen(rows, angles)
        rows, angles = rows[chosen], angles[chosen]
        within = self._within(angles)
        before, steps = angles, [angles]
        for positions in waypoints[1:]:
            ahead = 2 * angles - before  # a waypoint goes on as the last one did, but for where the way bends
            before, angles = angles, angles.copy()
            angles[within] = self._joints.settled(
                ahead[within], positions[rows[within]], axes[rows[within]], self._solver.free
            )
            steps.append(angles)
        return _by_grasp(rows, np.stack(steps, axis=1), len(axes))

    def _within(self, angles: FloatArray) -> BoolArray:
        """Whether some number of whole turns brings joint angles (k, j) within the limits."""
        least, most = (np.array(limit) - angles for limit in (self._lower, self._upper))
        turn = 2 * np.pi
        return np.asarray((np.ceil(least / turn - 1e-9) <= np.floor(most / turn + 1e-9)).all(axis=1))

    def _chosen(self, rows: IntArray, angles: FloatArray) -> IntArray:
        """Which solutions to follow: `FOLLOWED` of each pose within limits, and one beyond where there is none.

        The latter is what says which limit is in the way.
        """
        apart = np.remainder(angles - self._reference + np.pi, 2 * np.pi) - np.pi
        order = np.lexsort((np.square(apart).sum(axis=1), ~self._within(angles), rows))
        place = np.arange(len(rows)) - np.searchsorted(rows[order], rows[order])
        within = self._within(angles)[order]
        return np.asarray(order[(place == 0) | (within & (place < FOLLOWED))])

    def manipulability(self, angles: FloatArray) -> FloatArray:
        """See `Arm`: √det(J·Jᵀ)."""
        stance, there = self._stances(angles)
        jacobian = stance.jacobian()
        found = np.full(angles.shape[1:], np.nan)
        squared = np.linalg.det(jacobian @ jacobian.transpose(0, 2, 1))
        found[there] = np.sqrt(np.maximum(squared, 0.0))
        return found

    def heights(self, angles: FloatArray, normal: FloatArray) -> FloatArray:
        """See `Arm`: of the joints from the third on and of the wrist's, up to the last."""
        stance, there = self._stances(angles)
        found = np.full((len(self.radii_m), *angles.shape[1:]), np.nan)
        found[:, there] = (stance.points[:, 2:] @ normal).T
        return found

    def _stances(self, angles: FloatArray) -> tuple[Stance, BoolArray]:
        """The stances at joint angles (j, …), and where there are any: most branches do not exist."""
        there = np.asarray(~np.isnan(angles).any(axis=0))
        return self._joints.stance(angles[:, there].T), there

    def links(self, angles: FloatArray) -> FloatArray:
        """See `Arm`."""
        stance = self._joints.stance(angles[None])
        return np.vstack([np.zeros(3), stance.points[0], stance.position])


def _by_grasp(rows: IntArray, paths: FloatArray, count: int) -> FloatArray:
    """Paths (k, w, j) of grasps `rows` (k,), in order, as (j, b, w, n), filled up with NaN."""
    order = np.arange(len(rows)) - np.searchsorted(rows, rows)
    shape = (paths.shape[2], max(int(order.max(initial=0)) + 1, 1), paths.shape[1], count)
    found = np.full(shape, np.nan)
    found[:, order, :, rows] = paths.transpose(0, 2, 1)
    return found


@lru_cache(maxsize=8)
def arm_of(robot: Robot) -> Arm:
    """The kinematics of a robot.

    Raises
    ------
    UsageError
        If it is not of the UR family, and EAIK is not installed or knows no closed form for it.
    """
    if robot.chain is not None:
        return ChainArm(robot, robot.chain)
    return UrArm(robot, ur_rows(robot, "its kinematics"))


def ur_rows(robot: Robot, what: str) -> DenavitHartenberg:
    """The rows of an arm of the UR family, for `what` goes with no other.

    Raises
    ------
    UsageError
        If it is another arm.
    """
    if robot.dh is None:
        raise UsageError(f"robot {robot.name}: {what} knows arms of the UR family alone; use one of those, or none")
    return robot.dh
