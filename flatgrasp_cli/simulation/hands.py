"""Every gripper profile as a hand of the simulation, by how its fingers move."""

from __future__ import annotations

from typing import Any, Protocol

from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.simulation.adaptive import AdaptiveFingers
from flatgrasp_cli.simulation.jaws import Jaws
from flatgrasp_cli.simulation.parts import Pads


class Hand(Protocol):
    """Palm and fingers on a body at the palm's end: z the approach, y the closing axis. One motor moves the fingers."""

    actuator: str
    """The motor's name."""
    seconds: float
    """How long closing takes from fully open."""

    def add(self, spec: Any, hand: Any) -> None:
        """Add palm, fingers and motor to the body of the hand."""

    def control(self, opening_m: float) -> float:
        """What the motor is told for the fingers to be so far open."""

    @property
    def closed(self) -> float:
        """The control that presses with the whole force, whatever is between the fingers."""

    def positions(self, opening_m: float) -> dict[str, float]:
        """The joints' positions at an opening."""

    def reach_m(self, model: Any, data: Any) -> float:
        """How far the fingertips are beyond the palm now."""


def hand_of(gripper: Gripper, pads: Pads) -> Hand:
    """The hand of a profile: jaws that slide, or fingers of two phalanges."""
    return AdaptiveFingers(gripper, pads) if gripper.kind == "underactuated" else Jaws(gripper, pads)
