"""Two-finger grippers."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flatgrasp_cli.profiles.base import Length, Place, Profile, Size

Offsets = Annotated[tuple[Place, ...], Field(min_length=1, max_length=10)]
MOTIONS = {"parallel": "two parallel fingers", "arc": "two fingers on an arc", "underactuated": "two adaptive fingers"}
JAWS = {1: "thumb", 2: "finger pair"}
LEAST_STROKE_M = 1e-3
"""Fingers that move less between open and closed grasp nothing: recorded points scatter as much."""


class Gripper(Profile):
    """A two-finger gripper: the paper's w_f, w_h and w_o, and what a real hand adds to them."""

    profile: Literal["gripper"] = "gripper"
    name: Annotated[str, Field(min_length=1)]
    kind: Literal["parallel", "arc", "underactuated"]
    """How the fingers move: straight, on a linkage's arc, or with joints that adapt to the object."""
    min_opening_m: Length = 0.0
    max_opening_m: Size
    """w_o: between the pads, fully open."""
    finger_width_m: Size
    """w_f: a finger's size along its pad, across the closing axis."""
    finger_thickness_m: Size
    """A fingertip's size along the closing axis: the room that it needs behind its pad."""
    finger_length_m: Size
    """From the palm to the fingertips' ends, fully open."""
    tip_advance_m: Length = 0.0
    """How far the fingertips move away from the palm from fully open to closed (arc linkages)."""
    palm_offset_m: Length = 0.0
    """From the robot's flange to the palm, any adapter included."""
    hand_width_m: Size
    """w_h: the palm's size across the closing axis."""
    palm_m: Size
    """The palm's size along the closing axis."""
    jaws: tuple[Offsets, Offsets] = ((0.0,), (0.0,))
    """The fingers of the jaw on the −y and of the jaw on the +y side: their places along x, metres."""
    pad_friction: Annotated[float, Field(ge=0.01, le=5)] = 0.5
    """Coulomb coefficient of the pads on a common object; ice on ice has 0.02."""
    max_force_n: Annotated[float, Field(ge=0.01, le=1e5)] | None = None

    @model_validator(mode="after")
    def _opens(self) -> Self:
        if self.min_opening_m >= self.max_opening_m:
            raise ValueError(f"min_opening_m {self.min_opening_m} must be below max_opening_m {self.max_opening_m}")
        if self.max_opening_m - self.min_opening_m < LEAST_STROKE_M:
            raise ValueError(
                f"max_opening_m {self.max_opening_m} must be {LEAST_STROKE_M} m more than min_opening_m "
                f"{self.min_opening_m} at least"
            )
        return self

    @property
    def description(self) -> str:
        """The name and the jaws in words, for people: "lacquey: thumb and finger pair"."""
        counts = sorted(len(jaw) for jaw in self.jaws)
        if counts == [1, 1]:
            return f"{self.name}: {MOTIONS[self.kind]}"
        few, many = (JAWS.get(count, f"{count} fingers") for count in counts)
        return f"{self.name}: {few} and {many}"

    def jaw_width_m(self, jaw: int) -> float:
        """Width of a jaw from the outer edge of its first finger to that of its last."""
        return self.finger_width_m + max(self.jaws[jaw]) - min(self.jaws[jaw])

    def finger_length_at_m(self, opening_m: float) -> float:
        """From the palm to the fingertips' ends at an opening: arc linkages push them out as they close."""
        return self.finger_length_m + self.tip_advance_m * (1 - min(opening_m / self.max_opening_m, 1.0))

    @property
    def symmetric(self) -> bool:
        """Whether the hand turned by 180° about its approach is the same hand."""
        return sorted(self.jaws[0]) == sorted(-x for x in self.jaws[1])
