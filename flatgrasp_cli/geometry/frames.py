"""Rigid frames and rotations."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A right-handed frame: `origin` (3,) in metres and `axes` (3, 3), whose rows are its unit x, y and z axes."""

    origin: FloatArray
    axes: FloatArray

    def to_local(self, points: FloatArray) -> FloatArray:
        """World points (…, 3) in this frame."""
        if points.ndim != 2:
            return np.asarray((points - self.origin) @ self.axes.T)
        columns = np.subtract(points.T, self.origin[:, None], order="C")  # numpy and BLAS run fast along long rows
        return np.asarray((self.axes @ columns).T)

    def to_world(self, points: FloatArray) -> FloatArray:
        """Points (n, 3) of this frame, or (n, 2) in its x-y plane, in the world."""
        world: FloatArray = self.origin + points @ self.axes[: points.shape[-1]]
        return world


def frame_on_plane(normal: FloatArray, offset: float) -> Frame:
    """A frame whose z axis is a plane's unit `normal` (3,) and whose origin lies in the plane, `offset` along it."""
    return Frame(offset * normal, axes_about(normal))


def axes_about(z: FloatArray) -> FloatArray:
    """Right-handed axes (3, 3), its rows, of which the last is the unit vector `z` (3,)."""
    x = cross_product(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x /= np.linalg.norm(x)
    return np.array([x, cross_product(z, x), z])


def cross_product(a: FloatArray, b: FloatArray) -> FloatArray:
    """The cross product (3,) of two vectors (3,): numpy's takes thirty times as long for so few numbers."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def axes_from_quaternion(quaternion: FloatArray) -> FloatArray:
    """Rows (3, 3): the x, y, z axes in the world of the frame with unit `quaternion` [x, y, z, w]."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
            [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
            [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def turned_about_z(quaternion: FloatArray, angle_deg: float) -> FloatArray:
    """Unit quaternion [x, y, z, w], w ≥ 0, of the frame with unit `quaternion` turned about its own z axis."""
    x, y, z, w = quaternion.tolist()
    c, s = math.cos(math.radians(angle_deg) / 2), math.sin(math.radians(angle_deg) / 2)
    turned = np.array([c * x + s * y, c * y - s * x, c * z + s * w, c * w - s * z])
    return turned if turned[3] >= 0 else -turned


def quaternion_from_axes(axes: FloatArray) -> FloatArray:
    """Unit quaternion [x, y, z, w], w ≥ 0, of the frame whose rows `axes` (3, 3) are its x, y, z axes in the world.

    Shepperd's method (Journal of Guidance and Control 1(3), 1978): divide by the largest of the four components. Plain
    numbers: numpy takes ten times as long for so few.
    """
    r = axes.T.tolist()
    diagonal = [r[0][0], r[1][1], r[2][2], r[0][0] + r[1][1] + r[2][2]]
    i = diagonal.index(max(diagonal))
    q = [0.0] * 4
    if i == 3:
        q = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], 1.0 + diagonal[3]]
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        q[i], q[j] = 1.0 + 2 * r[i][i] - diagonal[3], r[j][i] + r[i][j]
        q[k], q[3] = r[k][i] + r[i][k], r[k][j] - r[j][k]
    length = math.copysign(math.hypot(*q), q[3])
    return np.array(q) / length
