"""An arm of the UR family as MuJoCo has it: capsules along its Denavit–Hartenberg rows, a servo in each joint.

No meshes are needed: forward kinematics is that of the rows. Gravity is compensated, as the arm's controller does, for
the arm and for the hand; what the hand holds is borne by the servos, with no more than the profile's torques.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion, turned_about_z
from flatgrasp_cli.model import Pose
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.robot import in_dh_base, inverse, ur_rows
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.parts import Kind, Servo, add_capsule, add_servo

LINK_KG = (3.7, 8.4, 2.3, 1.2, 1.2, 0.2)
"""About a UR5's links; of the others the servos make up for the difference, for gravity is compensated."""
SERVO_RAD = 0.002
"""How far a servo is from where it should be when it gives all its torque: a millimetre at half a metre."""
ARMATURE = (1.0, 1.0, 1.0, 0.2, 0.2, 0.2)
"""Inertia of the motors behind their gears, kg m²."""


class Arm:
    """An arm whose base frame is the world's, with a hand mounted on its flange as the gripper's profile says."""

    def __init__(self, robot: Robot, gripper: Gripper) -> None:
        self.robot, self._gripper, self._dh = robot, gripper, ur_rows(robot, "simulate")
        self.palm_offset_m = gripper.palm_offset_m
        self._at: FloatArray = np.radians(robot.reach.reference_deg)

    def add(self, spec: Any) -> Any:
        """Add links, joints and servos; returns the hand's body."""
        mujoco, dh, joints = load_mujoco(), self._dh, self.robot.joints
        half_turn = 0.0 if self.robot.base_frame == "base" else np.pi
        body, place, turn = spec.worldbody, np.zeros(3), Rotation.from_euler("z", half_turn)
        for k, radius in enumerate(self._radii()):
            body = body.add_body(name=f"link{k}", pos=place, quat=np.roll(turn.as_quat(), 1), gravcomp=1)
            joint = body.add_joint(name=f"joint{k}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
            joint.range, joint.limited = [joints.lower_deg[k], joints.upper_deg[k]], True  # degrees in a specification
            joint.armature = ARMATURE[k]
            servo = Servo(joints.max_effort_nm[k], SERVO_RAD, ARMATURE[k])
            add_servo(spec, f"joint{k}", mujoco.mjtTrn.mjTRN_JOINT, servo)
            end = np.array([dh.a_m[k], 0.0, dh.d_m[k]])
            if k > 0:  # the shoulder stands on the table
                add_capsule(body, (np.zeros(3), end), radius, Kind.ARM, LINK_KG[k])
            else:
                body.mass, body.inertia, body.explicitinertial = LINK_KG[0], [0.01] * 3, True
            place, turn = end, Rotation.from_euler("x", dh.alpha_deg[k], degrees=True)
        mounted = Rotation.from_euler("z", self._gripper.mounted_deg, degrees=True)
        place = place + turn.apply([0.0, 0.0, self.palm_offset_m])
        return body.add_body(name="hand", pos=place, quat=np.roll((turn * mounted).as_quat(), 1), gravcomp=1)

    def controls(self, palms: list[Pose], near: FloatArray | None = None) -> FloatArray:
        """Joint angles (n, 6) along the palms' poses, each near the one before; NaN from where it does not reach on.

        The first are those near to `near`, or to where the arm is driven now.
        """
        flanges = [self.flange(palm) for palm in palms]
        axes = np.array([axes_from_quaternion(flange.orientation) for flange in flanges])
        positions = np.array([flange.position for flange in flanges])
        base, before = self.robot.base_frame, self._at if near is None else near
        branches = inverse(self._dh, in_dh_base(base, positions), in_dh_base(base, axes), float(before[5]))
        angles = np.full((len(palms), 6), np.nan)
        for k, options in enumerate(branches):
            turned = options - 2 * np.pi * np.round((options - before) / (2 * np.pi))
            distance = np.abs(turned - before).max(axis=1)
            if np.isnan(distance).all():
                break
            angles[k] = before = turned[np.nanargmin(distance)]
        return angles

    def flange(self, palm: Pose) -> Pose:
        """The flange's pose for one of the palm."""
        back = self.palm_offset_m * axes_from_quaternion(palm.orientation)[2]
        return Pose(palm.position - back, turned_about_z(palm.orientation, -self._gripper.mounted_deg))

    def place(self, model: Any, data: Any, control: FloatArray) -> None:
        """Put the joints at angles (6,), at rest."""
        first = model.joint("joint0")
        data.qpos[first.qposadr[0] : first.qposadr[0] + 6] = control
        data.qvel[first.dofadr[0] : first.dofadr[0] + 6] = 0.0
        self.drive(data, control)

    def drive(self, data: Any, control: FloatArray) -> None:
        """Tell the servos where to go."""
        data.ctrl[:6] = control
        self._at = control

    def seconds(self, controls: FloatArray) -> float:
        """The least time along controls (n, 6) that no joint's limit of speed is passed in, easing included."""
        speeds = np.radians(self.robot.joints.max_speed_deg_s)
        turned = np.abs(np.diff(controls, axis=0)).sum(axis=0)
        return float((1.5 * turned / speeds).max()) if len(controls) > 1 else 0.0

    def _radii(self) -> tuple[float, ...]:
        links = self.robot.links
        return links.shoulder_m, links.upper_arm_m, links.forearm_m, links.wrist_m, links.wrist_m, links.wrist_m
