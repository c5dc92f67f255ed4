"""Inverse kinematics of a chain of joints in closed form, by EAIK, made exact where the chain only nearly has one.

EAIK (Ostermeier, Külz & Althoff: Automatic geometric decomposition for analytical inverse kinematics, IEEE Robotics and
Automation Letters, 2025) decomposes six joints with a spherical wrist or three parallel axes. Two kinds of arms have
neither, but nearly: those whose last axis misses the point in which the two before it meet by less than a millimetre
(Kinova's Gen3), which are solved as if it did not; and those where it passes farther beside (UFACTORY's arms). Of
these, each of several angles of the last joint says where that point is, and what remains has a closed form. In both
cases Newton's method on the chain itself follows.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.profiles.chain import Lock
from flatgrasp_cli.robot.chain import Joints

EXTRA = "pip install 'flatgrasp[arms]'"
MISSES_M = 1e-3
"""A last axis that misses the wrist by less is taken to pass through it: Newton's method makes up for that much."""
LAST_ANGLES = 16
"""Angles of the last joint that are tried where its axis passes beside the wrist."""
NEAR_RAD = 0.5 * np.pi
"""How far from the angle tried the last joint may come out for Newton's method to begin there. With these two, 98 % of
an xArm 6's solutions are found, and as many poses that it reaches; were it a spacing, 93 % of the solutions."""
LOCKED_FIRST = (7, 3, 1, 5, 6, 2, 4)
"""Which of seven joints is locked, if nobody says: the last turns the hand, the third the elbow; the fourth folds it,
and an arm whose elbow is locked reaches little."""
SAME = 1e-4
"""Radians between solutions that are one."""


class ClosedForm:
    """Solves poses of a chain, with one joint locked to several angles if it has seven.

    Raises
    ------
    UsageError
        If EAIK is not installed, or knows no closed form.
    """

    def __init__(self, name: str, joints: Joints, lock: Lock | None, limits: tuple[FloatArray, FloatArray]) -> None:
        self._joints = joints
        for number in (None,) if lock is None else (lock.joint,) if lock.joint else LOCKED_FIRST:
            self.free = np.ones(len(joints.axes), dtype=bool)
            values = [] if number is None or lock is None else _values(number - 1, lock.values, limits)
            self.free[[k for k, _ in values[:1]]] = False
            if self._decomposed([[each] for each in values] or [[]]):
                return
        raise UsageError(
            f"robot {name}: its joints have no closed form, which a spherical wrist or three parallel axes give; "
            + ("lock another joint" if lock else "it cannot be asked what it reaches")
        )

    def _decomposed(self, locked: list[list[tuple[int, float]]]) -> bool:
        """Whether there are solvers, for the chain as it is or with its last axis moved into the wrist."""
        self._offset = np.zeros(3)
        self._solvers = [_solver(self._joints, each) for each in locked]
        if all(each.hasKnownDecomposition() for each in self._solvers):
            return True
        joints, self._offset = self._joints, _beside_the_wrist(self._joints)
        points = np.vstack([joints.points[:-1], joints.points[-1] - self._offset])
        simple = replace(joints, points=points, position=joints.position - self._offset)
        self._solvers = [_solver(simple, each) for each in locked]
        return all(each.hasKnownDecomposition() for each in self._solvers)

    def solve(self, positions: FloatArray, axes: FloatArray) -> tuple[IntArray, FloatArray]:
        """All solutions for n poses of the flange: which pose each is of (k,), and its joint angles (k, J).

        The poses are `positions` (n, 3), in metres, and `axes` (n, 3, 3), whose rows are the flange's x, y, z axes.
        """
        beside = np.linalg.norm(self._offset) > MISSES_M
        last = 2 * np.pi * np.arange(LAST_ANGLES) / LAST_ANGLES if beside else [None]
        found = [self._nearly(solver, positions, axes, angle) for solver in self._solvers for angle in last]
        rows = np.concatenate([row for row, _ in found])
        angles = np.concatenate([angle for _, angle in found])
        angles = self._joints.settled(angles, positions[rows], axes[rows], self.free)
        there = ~np.isnan(angles).any(axis=1)
        return _distinct(rows[there], angles[there])

    def _nearly(
        self, solver: Any, positions: FloatArray, axes: FloatArray, last: float | None
    ) -> tuple[IntArray, FloatArray]:
        """What the simplified chain says, with the last joint near `last` if that is given."""
        poses = np.broadcast_to(np.eye(4), (len(positions), 4, 4)).copy()
        poses[:, :3, :3], poses[:, :3, 3] = axes.transpose(0, 2, 1), positions
        if last is not None:
            turned = _about(self._joints.axes[-1], last) @ self._joints.turn
            poses[:, :3, 3] -= poses[:, :3, :3] @ turned.T @ self._offset
        answers = solver.IK_batched(poses, 1)
        exact = [~np.array(answer.is_LS, dtype=bool) for answer in answers]
        rows = np.repeat(np.arange(len(poses)), [each.sum() for each in exact])
        empty = np.empty((0, len(self.free)))
        kept = (np.asarray(answer.Q)[each] for answer, each in zip(answers, exact, strict=True) if each.any())
        angles = np.concatenate([empty, *kept])
        if last is None:
            return rows, angles
        near = np.abs(_wrapped(angles[:, -1] - last)) <= NEAR_RAD
        return rows[near], angles[near]


def _values(k: int, count: int, limits: tuple[FloatArray, FloatArray]) -> list[tuple[int, float]]:
    """Joint `k` with each of so many values, evenly spaced within its limits, or over a turn if they are wider."""
    middle, width = 0.5 * (limits[0][k] + limits[1][k]), min(limits[1][k] - limits[0][k], 2 * np.pi)
    shares = (np.arange(count) + 0.5) / count - 0.5
    return [(k, float(middle + share * width)) for share in shares]


def _solver(joints: Joints, locked: list[tuple[int, float]]) -> Any:
    """EAIK's own robot: joint axes, and what lies between them."""
    try:
        from eaik.IK_Homogeneous import HomogeneousRobot
    except ImportError as error:
        raise UsageError(f"arms other than UR's need {error.name or 'eaik'}: {EXTRA}") from error
    frames = np.broadcast_to(np.eye(4), (len(joints.axes) + 1, 4, 4)).copy()
    for frame, point, axis in zip(frames, joints.points, joints.axes, strict=False):
        side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        side /= np.linalg.norm(side)
        frame[:3, :3], frame[:3, 3] = np.column_stack([side, np.cross(axis, side), axis]), point
    frames[-1, :3, :3], frames[-1, :3, 3] = joints.turn, joints.position
    return HomogeneousRobot(frames, locked)


def _beside_the_wrist(joints: Joints) -> FloatArray:
    """From the point in which the third and the second last axis meet, square to the last axis, onto that (3,)."""
    (p, q), (a, b) = joints.points[-3:-1], joints.axes[-3:-1]
    normal = np.cross(a, b)
    if np.linalg.norm(normal) < 0.5:
        return np.zeros(3)
    along = np.linalg.lstsq(np.column_stack([a, -b]), q - p, rcond=None)[0]
    beside = joints.points[-1] - (p + along[0] * a)
    return np.asarray(beside - (beside @ joints.axes[-1]) * joints.axes[-1])


def _about(axis: FloatArray, angle: float) -> FloatArray:
    """The rotation (3, 3) by an angle about a unit vector: Rodrigues' formula."""
    cross = np.cross(axis, np.eye(3)).T
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross))


def _wrapped(angles: Any) -> Any:
    return angles - 2 * np.pi * np.round(angles / (2 * np.pi))


def _distinct(rows: IntArray, angles: FloatArray) -> tuple[IntArray, FloatArray]:
    """Solutions, each once, those of a pose together; angles from −π to π."""
    angles = _wrapped(angles)
    keys = np.column_stack([rows, np.round(np.cos(angles) / SAME), np.round(np.sin(angles) / SAME)])
    _, first = np.unique(keys, axis=0, return_index=True)
    return rows[first], angles[first]
