"""Kinematics of arms of the UR family in closed form, for many poses at once.

Frames are those of standard Denavit–Hartenberg rows; frame 6 is the flange (ROS's `tool0`). The shoulder lift, elbow
and wrist 1 axes are parallel, all along z₁, and that splits the problem: the shoulder pan follows from where the origin
of frame 5 lies along z₁, the last two joints from the flange's angles with z₁, and what remains is an arm of two links
in the plane of z₀ and r, the horizontal direction square to z₁.
"""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.profiles.robot import DenavitHartenberg

SINGULAR_SINE = 1e-7
"""Below this |sin q5| the last joint counts as free; it then turns the hand off its pose by no more than that."""
EDGE = 1e-10
"""How far rounding may lift a cosine over 1: a stretched arm is still an arm, off by less than 0.1 nm."""
FREE_TRIALS = 8
SIGNS = np.array([[1.0], [-1.0]])


def inverse(dh: DenavitHartenberg, positions: FloatArray, axes: FloatArray, seed_rad: float = 0.0) -> FloatArray:
    """All joint angles (n, 8, 6), from −π to π, that bring the flange to n poses; NaN where a branch does not exist.

    The poses are `positions` (n, 3), in metres, and `axes` (n, 3, 3), whose rows are the flange's x, y, z axes, in the
    arm's Denavit–Hartenberg base. Branch 4·s + 2·w + e has shoulder s, wrist w (sin q5 > 0, then < 0) and elbow e
    (q3 > 0, then < 0), so a path that meets no singularity stays on its branch. Where sin q5 = 0 any q6 will do:
    the first wrist takes `seed_rad` or, if the links cannot follow, other values; the second has the opposite of it.
    """
    x6, y6, z6 = (np.ascontiguousarray(axes[:, row].T) for row in range(3))  # (3, n): sums run fast over rows
    shoulder = np.array([[0.0], [0.0], [dh.d_m[0]]])
    to_wrist = positions.T - dh.d_m[5] * z6 - shoulder  # origin of frame 5
    joints = np.empty((6, 2, 2, 2, len(positions)))
    with np.errstate(invalid="ignore", divide="ignore"):  # NaN is how a branch says that it does not exist
        c1, s1 = _shoulder_pan(to_wrist, dh.d_m[3])
        x, y, z, wrist = (_in_arm_plane(c1, s1, vector) for vector in (x6, y6, z6, to_wrist))
        sine5 = np.hypot(x[2], y[2])
        c6, s6 = x[2] / sine5, -y[2] / sine5
        singular = sine5 < SINGULAR_SINE
        if singular.any():
            free = _free_wrist(dh, wrist[:2, singular], x[:2, singular], y[:2, singular], seed_rad)
            c6[singular], s6[singular] = np.cos(free), np.sin(free)
        z4 = -(s6 * x[:2] + c6 * y[:2])
        joints[0] = np.arctan2(s1, c1)[:, None, None]
        joints[4] = (SIGNS * np.arctan2(sine5, z[2])[:, None])[:, :, None]
        joints[5] = _with_opposite(np.arctan2(s6, c6))[:, :, None]
        sum234 = _with_opposite(np.arctan2(z4[0], -z4[1]))  # z₄ = sin q234·r − cos q234·z₀
        u, v = wrist[:2, :, None] - dh.d_m[4] * SIGNS * z4[:, :, None]  # origin of frame 4, for both wrists
        joints[1], joints[2] = _two_links(dh.a_m[1], dh.a_m[2], u, v)
        joints[3] = sum234[:, :, None] - joints[1] - joints[2]
        joints[1:4:2] -= 2 * np.pi * np.round(joints[1:4:2] / (2 * np.pi))
    joints[:, np.isnan(joints[3])] = np.nan
    return joints.reshape(6, 8, -1).transpose(2, 1, 0)


def _shoulder_pan(to_wrist: FloatArray, d4: float) -> tuple[FloatArray, FloatArray]:
    """Cosine and sine (2, n) of q1, for the wrist before and behind the shoulder.

    The origin of frame 5 lies d4 along z₁ = (sin q1, −cos q1, 0) and so ±√(x² + y² − d4²) along r = (cos q1, sin q1).
    """
    px, py = to_wrist[:2]
    squared = px * px + py * py
    sine = _up_to_one(d4 / np.sqrt(squared))
    ahead = SIGNS * np.sqrt((1 - sine * sine) * squared)
    return (px * ahead - py * d4) / squared, (py * ahead + px * d4) / squared


def _in_arm_plane(c1: FloatArray, s1: FloatArray, vectors: FloatArray) -> FloatArray:
    """Parts (3, 2, n) of `vectors` (3, n) along r, z₀ and z₁, for both shoulders."""
    vx, vy, vz = vectors
    return np.stack([c1 * vx + s1 * vy, np.broadcast_to(vz, c1.shape), s1 * vx - c1 * vy])


def _two_links(a2: float, a3: float, u: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """q2 and q3 (…, 2, n), for both elbows, that put the links' end at u, v (…, n) before and above the shoulder."""
    c3 = _up_to_one((u * u + v * v - a2 * a2 - a3 * a3) / (2 * a2 * a3))
    s3 = np.sqrt(1 - c3 * c3)
    lead = np.arctan2(a3 * s3, a2 + a3 * c3)
    q2 = np.arctan2(v, u)[..., None, :] - SIGNS * lead[..., None, :]
    return q2, SIGNS * np.arctan2(s3, c3)[..., None, :]


def _up_to_one(cosine: FloatArray) -> FloatArray:
    """The values, those beyond ±1 by no more than rounding at ±1, others beyond it NaN."""
    cosine[np.abs(cosine) > 1 + EDGE] = np.nan
    return np.clip(cosine, -1.0, 1.0)


def _with_opposite(angle: FloatArray) -> FloatArray:
    """Angles (2, 2, n) for both wrists: those given (2, n), and half a turn on."""
    return np.stack([angle, np.where(angle > 0, angle - np.pi, angle + np.pi)], axis=1)


def _free_wrist(dh: DenavitHartenberg, wrist: FloatArray, x: FloatArray, y: FloatArray, seed_rad: float) -> FloatArray:
    """A q6 (k,) at which two links reach the origin of frame 4; parts (2, k) of k singular poses in the arm's plane.

    The seed and its fellows go first. The last one tried brings frame 4 nearest to the shoulder: if even that is too
    far away, none reaches, and the branch does not exist.
    """
    nearest = np.arctan2(-(x * wrist).sum(axis=0), -(y * wrist).sum(axis=0))
    evenly = seed_rad + 2 * np.pi / FREE_TRIALS * np.arange(FREE_TRIALS)
    trials = np.vstack([np.broadcast_to(evenly[:, None], (FREE_TRIALS, len(nearest))), nearest])
    z4 = -(np.sin(trials)[:, None] * x + np.cos(trials)[:, None] * y)
    reached = _links_close(dh, np.linalg.norm(wrist - dh.d_m[4] * z4, axis=1))
    return np.asarray(np.take_along_axis(trials, np.argmax(reached, axis=0)[None], axis=0)[0])


def _links_close(dh: DenavitHartenberg, distance: FloatArray) -> BoolArray:
    """Whether upper arm and forearm span a distance."""
    upper, fore = abs(dh.a_m[1]), abs(dh.a_m[2])
    return np.asarray((distance >= abs(upper - fore)) & (distance <= upper + fore))


def forward(dh: DenavitHartenberg, joints: FloatArray) -> FloatArray:
    """Poses (…, 6, 4, 4) of the frames 1 to 6 in the Denavit–Hartenberg base, at joint angles (…, 6)."""
    frames = np.empty((*joints.shape, 4, 4))
    pose = np.eye(4)
    alphas = np.radians(dh.alpha_deg)
    for k, (d, a, alpha) in enumerate(zip(dh.d_m, dh.a_m, alphas, strict=True)):
        pose = pose @ _link(joints[..., k], d, a, alpha)
        frames[..., k, :, :] = pose
    return frames


def _link(theta: FloatArray, d: float, a: float, alpha: float) -> FloatArray:
    """Pose (…, 4, 4) of a frame in the one before it: turn θ about z, go d along z and a along x, turn α about x."""
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    pose = np.zeros((*theta.shape, 4, 4))
    pose[..., 0, 0], pose[..., 0, 1], pose[..., 0, 2], pose[..., 0, 3] = c, -s * ca, s * sa, a * c
    pose[..., 1, 0], pose[..., 1, 1], pose[..., 1, 2], pose[..., 1, 3] = s, c * ca, -c * sa, a * s
    pose[..., 2, 1], pose[..., 2, 2], pose[..., 2, 3], pose[..., 3, 3] = sa, ca, d, 1.0
    return pose


def heights(dh: DenavitHartenberg, joints: FloatArray, normal: FloatArray) -> FloatArray:
    """Positions (4, …) along `normal` (3,) of the origins of frames 2 (elbow) to 5 (wrists), at joint angles (6, …).

    The same as from `forward`, without its matrices.
    """
    q1, q2, q3, q4 = joints[:4]
    c1, s1 = np.cos(q1), np.sin(q1)
    along_r, along_z1 = normal[0] * c1 + normal[1] * s1, normal[0] * s1 - normal[1] * c1
    elbow = normal[2] * (dh.d_m[0] + dh.a_m[1] * np.sin(q2)) + along_r * (dh.a_m[1] * np.cos(q2))
    q23 = q2 + q3
    end = elbow + dh.a_m[2] * (normal[2] * np.sin(q23) + along_r * np.cos(q23))
    wrist1 = end + dh.d_m[3] * along_z1
    wrist2 = wrist1 + dh.d_m[4] * (along_r * np.sin(q23 + q4) - normal[2] * np.cos(q23 + q4))
    return np.stack([elbow, end, wrist1, wrist2])


def manipulability(dh: DenavitHartenberg, joints: FloatArray) -> FloatArray:
    """Yoshikawa's measure |det J| (…) in m³ at joint angles (…, 6): zero where the arm cannot move in some direction.

    |a2·a3·sin q3·sin q5·(a2·cos q2 + a3·cos q23 + d5·sin q234)|: the factors are the elbow's, the wrist's and the
    shoulder's singularity. Yoshikawa, International Journal of Robotics Research 4(2), 1985.
    """
    a2, a3, d5 = dh.a_m[1], dh.a_m[2], dh.d_m[4]
    q23 = joints[..., 1] + joints[..., 2]
    ahead = a2 * np.cos(joints[..., 1]) + a3 * np.cos(q23) + d5 * np.sin(q23 + joints[..., 3])
    return np.asarray(np.abs(a2 * a3 * np.sin(joints[..., 2]) * np.sin(joints[..., 4]) * ahead))


def max_manipulability(dh: DenavitHartenberg) -> float:
    """The largest manipulability, in m³, of any joint angles, to seven digits.

    q2, q4 and q5 can each make the most of their term whatever the elbow does, which leaves
    |a2·a3|·sin q3·(√(a2² + a3² + 2·a2·a3·cos q3) + d5) to be searched for q3.
    """
    a2, a3, d5 = dh.a_m[1], dh.a_m[2], dh.d_m[4]
    q3 = np.linspace(0.0, np.pi, 10_001)
    ahead = np.sqrt(a2 * a2 + a3 * a3 + 2 * a2 * a3 * np.cos(q3)) + abs(d5)
    return float((abs(a2 * a3) * np.sin(q3) * ahead).max())
