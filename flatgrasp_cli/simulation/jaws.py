"""Hands whose jaws slide: parallel ones, and those on an arc, whose tips come out as they close.

A hand's body is at the palm's end: z the approach, y the closing axis. Profiles have the tips come out in proportion to
the closing, so that a jaw on an arc slides along a straight line that is tilted by that proportion.
"""

from __future__ import annotations

import math
from typing import Any

from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.parts import Kind, Pads, Servo, add_box, add_servo

PALM_DEPTH_M = 0.06
"""Of a hand whose profile says nothing of what is behind its palm."""
PALM_KG, FINGER_KG = 0.8, 0.1
"""Hands weigh about a kilogram. The arm bears them, so nothing but their inertia counts."""
JAW_KG = 0.2
"""Inertia of a jaw with its share of the motor and the gears."""
SERVO_M = 0.002
"""How far from where it should be a jaw presses with all its force."""
CLOSING_M_S = 0.1
"""Speed of each jaw as it closes: the grippers' data sheets have 0.05 to 0.2."""


class Jaws:
    """The jaws of a hand as MuJoCo has them: one motor, both as far from the middle."""

    actuator = "jaws"

    def __init__(self, gripper: Gripper, pads: Pads) -> None:
        self._gripper, self._pads = gripper, pads
        self.seconds = 0.5 * gripper.max_opening_m / CLOSING_M_S
        """How long closing takes from fully open."""

    def add(self, spec: Any, hand: Any) -> None:
        """Add palm, jaws and motor to the body of the hand."""
        add_palm(hand, self._gripper)
        for jaw, side in enumerate((-1.0, 1.0)):
            self._add_jaw(hand, jaw, side)
        mujoco = load_mujoco()
        tendon = spec.add_tendon(name=self.actuator)
        for jaw in (0, 1):
            tendon.wrap_joint(f"jaw{jaw}", math.cos(self._tilt))
        equality = spec.add_equality(
            type=mujoco.mjtEq.mjEQ_JOINT, name1="jaw0", name2="jaw1", objtype=mujoco.mjtObj.mjOBJ_JOINT
        )
        equality.data[:2] = 0.0, 1.0
        equality.solref = [0.004, 1.0]
        add_servo(spec, self.actuator, mujoco.mjtTrn.mjTRN_TENDON, Servo(self._pads.force_n, SERVO_M, 0.5 * JAW_KG))

    def control(self, opening_m: float) -> float:
        """What the motor is told to open so far; less than nothing presses on whatever is between the jaws."""
        return opening_m

    def positions(self, opening_m: float) -> dict[str, float]:
        """The joints' positions at an opening."""
        half = 0.5 * opening_m / math.cos(self._tilt)
        return {"jaw0": half, "jaw1": half}

    def reach_m(self, model: Any, data: Any) -> float:
        """How far the fingertips are beyond the palm now."""
        slid = float(data.qpos[model.joint("jaw0").qposadr[0]]) * math.cos(self._tilt)
        return self._gripper.finger_length_at_m(2 * slid)

    @property
    def closed(self) -> float:
        """The control that presses with the whole force, whatever is between the jaws."""
        return self.control(-2 * SERVO_M)

    @property
    def _tilt(self) -> float:
        """The angle between a jaw's way and the closing axis."""
        return math.atan2(2 * self._gripper.tip_advance_m, self._gripper.max_opening_m)

    def _add_jaw(self, hand: Any, jaw: int, side: float) -> None:
        gripper = self._gripper
        body = hand.add_body(name=f"jaw{jaw}", gravcomp=1)
        half_stroke = 0.5 * gripper.max_opening_m / math.cos(self._tilt)
        body.add_joint(
            name=f"jaw{jaw}",
            type=load_mujoco().mjtJoint.mjJNT_SLIDE,
            axis=[0.0, side * math.cos(self._tilt), -math.sin(self._tilt)],
            range=[0.5 * gripper.min_opening_m / math.cos(self._tilt), half_stroke],
            limited=True,
            armature=JAW_KG,
            damping=10.0,
        )
        half = 0.5 * gripper.finger_width_m, 0.5 * gripper.finger_thickness_m, 0.5 * gripper.finger_length_m
        middle = gripper.finger_length_m + gripper.tip_advance_m - half[2]
        for x in gripper.jaws[jaw]:
            place = (x, side * half[1], middle)
            add_box(body, half, place, Kind.FINGER, friction=self._pads.friction, mass_kg=FINGER_KG)


def add_palm(hand: Any, gripper: Gripper) -> None:
    """Add the palm, as deep as it is from the flange to its end."""
    depth = gripper.palm_offset_m or PALM_DEPTH_M
    half = 0.5 * gripper.hand_width_m, 0.5 * gripper.palm_m, 0.5 * depth
    add_box(hand, half, (0.0, 0.0, -half[2]), Kind.PALM, mass_kg=PALM_KG)
