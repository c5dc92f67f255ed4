"""The document of schema `flatgrasp.compare/1`: our best grasp of one object, and those of two point fingers."""

from __future__ import annotations

from typing import Literal

from flatgrasp_cli.results.contracts.base import Number, Part

SCHEMA_ID: Literal["flatgrasp.compare/1"] = "flatgrasp.compare/1"


class OursPart(Part):
    """Our best grasp."""

    width_m: Number
    """How wide the object is between the pads, metres."""
    caged: bool
    """Whether it cages the object."""


class PointFingersPart(Part):
    """A grasp of two point fingers, which stand for the gripper's two."""

    width_m: Number
    """How far its two contacts are apart, metres."""
    executable: bool
    """Whether the gripper can carry it out."""
    reason: str | None
    """Why it cannot."""


class CompareDocument(Part):
    """Both methods' grasps of one object."""

    schema: Literal["flatgrasp.compare/1"]
    """Which contract this is."""
    source: str
    """The file or URL, and for a recording the frame's time."""
    object: int
    """The object's number in its cloud, from 0."""
    ours: OursPart | None
    """Our best grasp; null where there is none."""
    point_fingers: list[PointFingersPart]
    """The grasps of two point fingers."""
