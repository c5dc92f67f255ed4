"""Hands with adaptive fingers: two phalanges each, and one motor whose tendon pulls all of them.

Seen along x, a finger is a proximal phalanx on a pin inside the palm, as long as the profile's finger, and a distal
one. A spring and a stop keep the distal phalanx upright while nothing touches the finger, so that it comes in like a
parallel jaw; the fingertips never reach farther than the profile says, and are short of it by a·(1 − cos q) at most.
With q the turn of the proximal phalanx and t that of the distal one, both from upright and inward, the tendon of a
finger is pulled in by a·q + c·t. So, by virtual work, a jaw that touches something at a distance d below its distal
pins presses with the tendon's force F while F·c < F·d: the stop holds the distal phalanx and the finger pinches. Nearer
to the pin, or where the proximal phalanx is stopped, the distal one turns in and the finger wraps. The tendon runs over
pulleys, so that each jaw has the same force whatever the others do; the fingers of a jaw share it.
"""

from __future__ import annotations

import math
from typing import Any

from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.jaws import CLOSING_M_S, FINGER_KG, SERVO_M, add_palm
from flatgrasp_cli.simulation.parts import Kind, Pads, Servo, add_box, add_servo

DISTAL_SHARE = 0.6
"""The distal phalanx as a share of the finger: the Lacquey's is 58.7 mm of 90 to 100 mm."""
PINCH_SHARE = 0.3
"""Contacts below this share of the distal phalanx pinch, above it they wrap."""
MOST_WRAP_RAD = math.radians(60)
"""The Lacquey's distal joint turns by 60°."""
SPRING_SHARE, FRICTION_SHARE = 0.1, 0.1
"""What springs and the tendon's friction take of the motor's force."""
DAMPING_S = 0.01
"""A joint at a radian a second is slowed by this share of the motor's torque."""
PRELOAD_SHARE = 0.3
"""Of the motor's force, with which springs keep the distal phalanges upright: more than closing freely takes."""
FINGER_KG_M2 = 1e-3
"""A finger's inertia with its share of motor and gears, as in a parallel jaw: 0.2 kg a few centimetres from the pin."""


class AdaptiveFingers:
    """The fingers of a hand as MuJoCo has them."""

    actuator = "tendon"

    def __init__(self, gripper: Gripper, pads: Pads) -> None:
        self._gripper, self._pads = gripper, pads
        self._proximal = gripper.finger_length_m + gripper.tip_advance_m
        self._distal = DISTAL_SHARE * self._proximal
        self._middle = 0.25 * (gripper.max_opening_m + gripper.min_opening_m)
        self.seconds = 0.5 * gripper.max_opening_m / CLOSING_M_S
        """How long closing takes from fully open."""

    def add(self, spec: Any, hand: Any) -> None:
        """Add palm, fingers, springs, tendon and motor to the body of the hand."""
        mujoco = load_mujoco()
        add_palm(hand, self._gripper)
        tendon = spec.add_tendon(name=self.actuator)
        arm = PINCH_SHARE * self._distal
        for name, jaw, x in self._fingers():
            share = 1 / len(self._gripper.jaws[jaw])
            self._add_finger(hand, name, (x, -1.0 if jaw == 0 else 1.0), share)
            upright = spec.add_tendon(
                name=f"{name}.upright",
                range=[0.0, MOST_WRAP_RAD],
                limited=True,
                stiffness=share * SPRING_SHARE * self._pads.force_n * arm / MOST_WRAP_RAD,
                springlength=[-MOST_WRAP_RAD * PRELOAD_SHARE / SPRING_SHARE] * 2,
            )
            for joint in ("proximal", "distal"):
                upright.wrap_joint(f"{name}.{joint}", 1.0)
            tendon.wrap_joint(f"{name}.proximal", share * (self._proximal + arm))
            tendon.wrap_joint(f"{name}.distal", share * arm)
        inertia = 0.5 * FINGER_KG_M2 / self._proximal**2
        motor = add_servo(spec, self.actuator, mujoco.mjtTrn.mjTRN_TENDON, Servo(self._pads.force_n, SERVO_M, inertia))
        motor.forcerange = [0.0, self._pads.force_n]  # a tendon does not push: springs open the hand

    def control(self, opening_m: float) -> float:
        """How far the motor pulls the tendon in to close to an opening."""
        return 2 * self._proximal * self._turn(opening_m)

    @property
    def closed(self) -> float:
        """The control that pulls with the whole force, whatever is between the fingers."""
        return self.control(self._gripper.min_opening_m) + 2 * PINCH_SHARE * self._distal * MOST_WRAP_RAD + SERVO_M

    def positions(self, opening_m: float) -> dict[str, float]:
        """The joints' positions at an opening."""
        turn = self._turn(opening_m)
        at = {"proximal": turn, "distal": -turn}
        return {f"{name}.{joint}": angle for name, _, _ in self._fingers() for joint, angle in at.items()}

    def reach_m(self, model: Any, data: Any) -> float:
        """How far the thumb's tip is beyond the palm now; that of the first finger, where there is no thumb."""
        name = min(self._fingers(), key=lambda finger: len(self._gripper.jaws[finger[1]]))[0]
        q, d = (float(data.qpos[model.joint(f"{name}.{joint}").qposadr[0]]) for joint in ("proximal", "distal"))
        return self._proximal * math.cos(q) + self._distal * (math.cos(q + d) - 1)

    def _fingers(self) -> list[tuple[str, int, float]]:
        """Name, jaw and place along x of each finger."""
        return [(f"finger{jaw}{k}", jaw, x) for jaw in (0, 1) for k, x in enumerate(self._gripper.jaws[jaw])]

    def _turn(self, opening_m: float) -> float:
        """The proximal phalanges' turn inward at an opening, all distal ones upright."""
        return math.asin((self._middle - 0.5 * opening_m) / self._proximal)

    def _add_finger(self, hand: Any, name: str, place: tuple[float, float], share: float) -> None:
        """Add a finger that is `place` along x and on the side −1 or 1, and has a share of its jaw's force."""
        gripper, (x, side) = self._gripper, place
        torque = share * self._pads.force_n * self._proximal
        reach, back = self._turn(gripper.min_opening_m), self._turn(gripper.max_opening_m)
        half = 0.5 * gripper.finger_width_m, 0.5 * gripper.finger_thickness_m
        spring = {
            "stiffness": SPRING_SHARE * torque / (reach - back),
            "springref": math.degrees(2 * back),
            "frictionloss": FRICTION_SHARE * torque,
        }
        # the pins are in the middle of a pad's face, so that turning does not move it
        proximal = hand.add_body(name=f"{name}.proximal", pos=[x, side * self._middle, -self._distal], gravcomp=1)
        distal = proximal.add_body(name=f"{name}.distal", pos=[0, 0, self._proximal], gravcomp=1)
        for body, length, limits in (
            (proximal, self._proximal, (back, reach)),
            (distal, self._distal, (-reach, MOST_WRAP_RAD - back)),
        ):
            box = (*half, 0.5 * length)
            add_box(
                body, box, (0, side * half[1], box[2]), Kind.FINGER, friction=self._pads.friction, mass_kg=FINGER_KG
            )
            body.add_joint(
                name=body.name,
                axis=[side, 0, 0],
                range=[math.degrees(limit) for limit in limits],  # as specifications have it
                limited=True,
                armature=share * FINGER_KG_M2,
                damping=DAMPING_S * torque,
                **(spring if body is proximal else {}),
            )
