"""Kinematics of any chain of turning joints, for many joint angles at once, by products of exponentials.

Everything is in the base frame. With all joints at 0, joint i turns about the line through `points[i]` along `axes[i]`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.profiles.chain import Chain

CONVERGED = 1e-9
"""Metres and radians by which a solution may miss."""
ITERATIONS = 12
"""Newton's method doubles the digits each time; four do from two centimetres off, the rest is for odd places."""
DAMPING = 1e-12
"""Keeps the system solvable where the arm is singular; too little to be felt elsewhere (J·Jᵀ is about 0.01 to 1)."""
LARGEST_STEP = 0.5
"""Radians a joint may turn in one iteration: farther away the linear model says nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Stance:
    """Where m arms have their joints: `points` and `axes` (m, J, 3), and the flange's `position` and `axes_of_flange`.

    The latter (m, 3, 3) has the flange's x, y, z axes as its rows.
    """

    points: FloatArray
    axes: FloatArray
    position: FloatArray
    axes_of_flange: FloatArray

    def jacobian(self) -> FloatArray:
        """How the flange moves, then turns, with each joint: (m, 6, J)."""
        arms = self.position[:, None] - self.points
        return np.concatenate([_cross(self.axes, arms), self.axes], axis=2).transpose(0, 2, 1)


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """A chain's J joints at 0: `points` and `axes` (J, 3), the flange's `position` (3,) and `turn` (3, 3), a matrix."""

    points: FloatArray
    axes: FloatArray
    position: FloatArray
    turn: FloatArray

    @classmethod
    def of(cls, chain: Chain) -> Joints:
        """Those of a profile."""
        from scipy.spatial.transform import Rotation  # which takes longer to load than all of this package

        turn, place, points, axes = np.eye(3), np.zeros(3), [], []
        for each in (*chain.joints, chain.flange):
            place = place + turn @ np.array(each.xyz_m)
            turn = turn @ Rotation.from_euler("xyz", each.rpy_deg, degrees=True).as_matrix()
            if each is not chain.flange:
                points.append(place)
                axes.append(turn @ np.array(getattr(each, "axis")))  # noqa: B009 (a flange has none)
        return cls(np.array(points), np.array(axes), place, turn)

    def stance(self, angles: FloatArray) -> Stance:
        """The stance at joint angles (m, J)."""
        m = len(angles)
        turn, shift = np.tile(np.eye(3), (m, 1, 1)), np.zeros((m, 3))
        points, axes = np.empty((m, len(self.axes), 3)), np.empty((m, len(self.axes), 3))
        sine, versine = np.sin(angles)[..., None, None], (1 - np.cos(angles))[..., None, None]
        for k, (point, axis) in enumerate(zip(self.points, self.axes, strict=True)):
            points[:, k], axes[:, k] = turn @ point + shift, turn @ axis
            cross = np.cross(axis, np.eye(3)).T
            # times constants: one large product, many times faster than many small ones
            both = (turn.reshape(-1, 3) @ np.hstack([cross, cross @ cross])).reshape(m, 3, 6)
            turn = turn + sine[:, k] * both[:, :, :3] + versine[:, k] * both[:, :, 3:]
            shift = points[:, k] - turn @ point
        flange = (turn.reshape(-1, 3) @ self.turn).reshape(m, 3, 3)
        return Stance(points, axes, turn @ self.position + shift, flange.transpose(0, 2, 1))

    def settled(self, angles: FloatArray, positions: FloatArray, axes: FloatArray, free: BoolArray) -> FloatArray:
        """Joint angles (m, J) near those given that bring the flange to m poses exactly; NaN where none are found.

        The poses are `positions` (m, 3) and `axes` (m, 3, 3), rows as those of a stance; only `free` joints (J,) turn.
        """
        angles = angles.copy()
        open_ = np.flatnonzero(~np.isnan(angles).any(axis=1))
        for _ in range(ITERATIONS):
            stance = self.stance(angles[open_])
            off = np.concatenate(
                [
                    positions[open_] - stance.position,
                    0.5 * _cross(stance.axes_of_flange, axes[open_]).sum(axis=1),
                ],
                axis=1,
            )
            wrong = ~_facing(stance.axes_of_flange, axes[open_]) | (np.abs(off).max(axis=1) > CONVERGED)
            open_, off = open_[wrong], off[wrong]
            if len(open_) == 0:
                return angles
            columns = stance.jacobian()[wrong][:, :, free]
            square = columns @ columns.transpose(0, 2, 1) + DAMPING * np.eye(6)
            step = (columns.transpose(0, 2, 1) @ np.linalg.solve(square, off[:, :, None]))[:, :, 0]
            angles[np.ix_(open_, free)] += np.clip(step, -LARGEST_STEP, LARGEST_STEP)
        angles[open_] = np.nan
        return angles


def _cross(first: FloatArray, second: FloatArray) -> FloatArray:
    """Cross products (…, 3), in a third of the time of NumPy's."""
    ahead, behind = [1, 2, 0], [2, 0, 1]
    return np.asarray(first[..., ahead] * second[..., behind] - first[..., behind] * second[..., ahead])


def _facing(first: FloatArray, second: FloatArray) -> BoolArray:
    """Whether m pairs of frames (m, 3, 3) are less than a quarter turn apart: at half a turn their cross is 0, too."""
    return np.asarray(np.einsum("mij,mij->m", first, second) > 1.0)
