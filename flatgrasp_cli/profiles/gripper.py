"""Two-finger grippers."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flatgrasp_cli.profiles.base import Length, Place, Profile, Size, Turn
from flatgrasp_cli.profiles.uncertainty import HandUncertainty

Offsets = Annotated[tuple[Place, ...], Field(min_length=1, max_length=10)]
MOTIONS = {"parallel": "two parallel fingers", "arc": "two fingers on an arc", "underactuated": "two adaptive fingers"}
JAWS = {1: "thumb", 2: "finger pair"}
Axis = Literal["x", "y", "z", "-x", "-y", "-z"]
JointRow = Annotated[tuple[Annotated[float, Field(ge=-100, le=100)], ...], Field(min_length=2)]
"""An opening in metres and the position of each joint at it, radians or metres."""
LEAST_STROKE_M = 1e-3
"""Fingers that move less between open and closed grasp nothing: recorded points scatter as much."""


class Gripper(Profile):
    """A two-finger gripper: the paper's w_f, w_h and w_o, and what a real hand adds to them."""

    profile: Literal["gripper"] = "gripper"
    """What kind of profile this is."""
    name: Annotated[str, Field(min_length=1)]
    """The gripper's name."""
    kind: Literal["parallel", "arc", "underactuated"]
    """How the fingers move: straight, on a linkage's arc, or with joints that adapt to the object."""
    min_opening_m: Length = 0.0
    """Between the pads, closed as far as they go, metres."""
    max_opening_m: Size
    """w_o: between the pads, fully open, metres."""
    finger_width_m: Size
    """w_f: a finger's size along its pad, across the closing axis, metres."""
    finger_thickness_m: Size
    """A fingertip's size along the closing axis, metres: the room that it needs behind its pad."""
    finger_root_m: Size | None = None
    """A finger's size along the closing axis where it leaves the palm, metres, if it is thicker there than at its
    tip."""
    finger_length_m: Size
    """From the palm to the fingertips' ends, fully open, metres."""
    tip_advance_m: Length = 0.0
    """How far the fingertips move away from the palm from fully open to closed (arc linkages), metres."""
    palm_offset_m: Length = 0.0
    """From the robot's flange to the palm, any adapter included, metres."""
    adapter_m: Length = 0.0
    """The part of `palm_offset_m` that is the adapter, metres: from the flange to the frame that the hand is mounted
    by."""
    mounted_deg: Turn = 0.0
    """How far the hand is turned about z against the flange, degrees: 90 or −90 where the fingers close along the
    flange's x axis, 0 where they close along its y axis."""
    hand_width_m: Size
    """w_h: the palm's size across the closing axis, metres."""
    palm_m: Size
    """The palm's size along the closing axis, metres."""
    jaws: tuple[Offsets, Offsets] = ((0.0,), (0.0,))
    """The fingers of the jaw on the −y and of the jaw on the +y side: their places along x, metres."""
    pad_friction: Annotated[float, Field(ge=0.01, le=5)] = 0.5
    """Coulomb coefficient of the pads on a common object; ice on ice has 0.02."""
    paper_finger_width_m: Size | None = None
    """w_f of the paper's own method, whose two fingers are equal, metres; None: the mean of both jaws' widths."""
    paper_hand_width_m: Size | None = None
    """w_h of the paper's eq. (2), metres: of the fingers, not of wrist and palm (Fig. 16). None: its w_f."""
    max_force_n: Annotated[float, Field(ge=0.01, le=1e5)] | None = None
    """The force with which the fingers can press, newtons; None: not known."""
    uncertainty: HandUncertainty | None = None
    """How well the hand's place and its pads' friction are known, where that is better or worse than usual."""
    joint_names: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """The joints that are driven, as the hand's URDF names them, without those that mimic them; None: not known."""
    joints_at_opening: Annotated[tuple[JointRow, ...], Field(min_length=2)] | None = None
    """Rows of an opening in metres and the position of each of `joint_names` at it, radians or metres, openings rising.
    Positions between two rows are interpolated, those beyond the last are the last. None: not known."""
    base_link: Annotated[str, Field(min_length=1)] | None = None
    """The link of the hand's URDF that stands where the hand is mounted; None: not known."""
    base_link_closes: Axis = "y"
    """The axis of `base_link` along which the fingers close."""
    base_link_approaches: Axis = "z"
    """The axis of `base_link` along which the fingers point."""

    @model_validator(mode="after")
    def _adapter_ends_before_the_palm(self) -> Self:
        if self.adapter_m > self.palm_offset_m:
            raise ValueError(f"adapter_m is a part of palm_offset_m {self.palm_offset_m}, not {self.adapter_m}")
        return self

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

    @model_validator(mode="after")
    def _joints_are_a_table(self) -> Self:
        names, rows = self.joint_names, self.joints_at_opening
        if (names is None) != (rows is None):
            raise ValueError("joint_names and joints_at_opening belong together: give both, or leave out both")
        if names is not None and rows is not None:
            if any(len(row) != 1 + len(names) for row in rows):
                raise ValueError(f"joints_at_opening has rows of an opening and {len(names)} positions, in m and rad")
            if any(high[0] <= low[0] for low, high in pairwise(rows)):
                raise ValueError("joints_at_opening has its openings in rising order, none twice")
        return self

    @model_validator(mode="after")
    def _base_link_has_two_axes(self) -> Self:
        if self.base_link_closes[-1] == self.base_link_approaches[-1]:
            raise ValueError("base_link_closes and base_link_approaches are two different axes")
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

    def in_the_papers_symbols(self) -> Self:
        """What the paper knows of the hand: two equal fingers of width w_f, and a hand width w_h that belongs to them.

        A thumb against a pair has two widths, the palm another one; with those eq. (2) leaves nothing of what the paper
        grasps.
        """
        width = self.paper_finger_width_m or 0.5 * (self.jaw_width_m(0) + self.jaw_width_m(1))
        symbols = {
            "jaws": ((0.0,), (0.0,)),
            "finger_width_m": width,
            "hand_width_m": self.paper_hand_width_m or width,
        }
        return self.model_copy(update=symbols)

    def finger_length_at_m(self, opening_m: float) -> float:
        """From the palm to the fingertips' ends at an opening: arc linkages push them out as they close."""
        return self.finger_length_m + self.tip_advance_m * (1 - min(opening_m / self.max_opening_m, 1.0))

    @property
    def root_m(self) -> float:
        """A finger's size along the closing axis where it leaves the palm, metres."""
        return self.finger_thickness_m if self.finger_root_m is None else self.finger_root_m

    def tool_length_m(self, width_m: float) -> float:
        """From the flange to the fingertips' ends when they have closed to a width."""
        return self.palm_offset_m + self.finger_length_at_m(width_m)

    @property
    def symmetric(self) -> bool:
        """Whether the hand turned by 180° about its approach is the same hand."""
        return sorted(self.jaws[0]) == sorted(-x for x in self.jaws[1])
