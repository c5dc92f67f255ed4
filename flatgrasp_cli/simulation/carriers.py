"""What carries a hand: nothing but a wish (a floating hand), or an arm of the UR family.

A carrier adds the body that the hand is mounted on, and turns poses of the hand's palm into what drives it there.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Pose
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.parts import Servo, add_servo

FORCE_N, TORQUE_NM = 150.0, 15.0
"""What stops a floating hand: a UR arm's own force limit, as it is delivered, and that at a tenth of a metre."""
SERVO_M, SERVO_RAD = 0.002, 0.02
"""How far off a floating hand pushes with all of it."""
HAND_KG, HAND_KG_M2 = 1.0, 0.005
"""What moves with a hand of a kilogram that is a tenth of a metre long: the arm's end behind it."""


class Carrier(Protocol):
    """Carries the hand."""

    def add(self, spec: Any) -> Any:
        """Add the carrier to a specification; returns the body that the hand's parts belong to."""

    def controls(self, palms: list[Pose], near: FloatArray | None = None) -> FloatArray:
        """What drives the palm along these poses: (n, k), the first near a control; NaN where it cannot get."""

    def place(self, model: Any, data: Any, control: FloatArray) -> None:
        """Put the hand where a control (k,) leads to, at rest."""

    def drive(self, data: Any, control: FloatArray) -> None:
        """Let the carrier go on toward a control (k,)."""

    def seconds(self, controls: FloatArray) -> float:
        """The least time that the way along controls (n, k) takes."""


class Floating:
    """A hand that floats: six servos bring it to where it should be, with no more force than a careful arm's.

    They go from a stand that is where the hand was put: friction knows only what moves, not what is put elsewhere.
    """

    def add(self, spec: Any) -> Any:
        """Add a stand, and the hand on it."""
        mujoco = load_mujoco()
        stand = spec.worldbody.add_body(name="stand", mocap=True)
        hand = stand.add_body(name="hand", gravcomp=1)
        slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
        for k, axis in enumerate(np.vstack([np.eye(3), np.eye(3)])):
            straight = k < 3
            name, inertia = f"off{k}", HAND_KG if straight else HAND_KG_M2
            hand.add_joint(name=name, type=slide if straight else hinge, axis=axis, armature=inertia)
            most, off_by = (FORCE_N, SERVO_M) if straight else (TORQUE_NM, SERVO_RAD)
            add_servo(spec, name, mujoco.mjtTrn.mjTRN_JOINT, Servo(most, off_by, inertia))
        return hand

    def controls(self, palms: list[Pose], near: FloatArray | None = None) -> FloatArray:  # noqa: ARG002 (as above)
        """The palms' positions and orientations [w, x, y, z]."""
        return np.array([[*palm.position, *np.roll(palm.orientation, 1)] for palm in palms])

    def place(self, model: Any, data: Any, control: FloatArray) -> None:
        """Put the stand where the hand is to be, and the hand on it."""
        data.mocap_pos[0], data.mocap_quat[0] = control[:3], control[3:]
        for k in range(6):
            joint = model.joint(f"off{k}")
            data.qpos[joint.qposadr[0]] = data.qvel[joint.dofadr[0]] = 0.0
        data.ctrl[:6] = 0.0

    def drive(self, data: Any, control: FloatArray) -> None:
        """Tell the servos where to go; the hand keeps the turn that it was put with.

        MuJoCo turns the way: a `Rotation` for every step would take twice the time of the physics.
        """
        mujoco, back = load_mujoco(), np.empty(4)
        mujoco.mju_negQuat(back, data.mocap_quat[0])
        mujoco.mju_rotVecQuat(data.ctrl[:3], control[:3] - data.mocap_pos[0], back)

    def seconds(self, controls: FloatArray) -> float:  # noqa: ARG002 (as above)
        """No least time: nothing limits it."""
        return 0.0


def palm_at(tips: Pose, finger_length_m: float) -> Pose:
    """The palm's pose where fingers of this length end at a pose."""
    return Pose(tips.position - finger_length_m * axes_from_quaternion(tips.orientation)[2], tips.orientation)


def missed(tips: Pose, shift_m: FloatArray, yaw_rad: float) -> Pose:
    """A pose shifted by (2,) along its own x and y, and turned about its approach."""
    axes = axes_from_quaternion(tips.orientation)
    turned = Rotation.from_quat(tips.orientation) * Rotation.from_euler("z", yaw_rad)
    return Pose(tips.position + shift_m @ axes[:2], turned.as_quat())
