"""The document of schema `flatgrasp.cage/1`: the grasps of two point fingers on one outline."""

from __future__ import annotations

from typing import Literal

from flatgrasp_cli.results.contracts.base import Number, Part, Vector2
from flatgrasp_cli.results.contracts.grasps import CagePart

SCHEMA_ID: Literal["flatgrasp.cage/1"] = "flatgrasp.cage/1"


class PointGraspPart(Part):
    """One grasp of two points."""

    rank: int
    """Its number among the grasps; 1 forgives the largest miss."""
    contacts: tuple[Vector2, Vector2]
    """Where the points touch the outline: x, y in metres, for a polygon in its own unit."""
    width_m: Number
    """How far they are apart, metres, for a polygon in its own unit."""
    cage: CagePart
    """Within which openings it cages; lengths are metres, for a polygon in its own unit."""


class CageDocument(Part):
    """One outline, and all grasps of two point fingers on it."""

    schema: Literal["flatgrasp.cage/1"]
    """Which contract this is."""
    source: str
    """The file or URL, and for a recording the frame's time."""
    object: int | None
    """The object's number in its cloud, from 0; null for a polygon."""
    closing: Literal["inward", "outward"]
    """Which way the fingers close."""
    loops: list[list[Vector2]]
    """The outline's vertices: x, y in metres, for a polygon in its own unit; the outer loop, then the holes."""
    reason: str | None
    """Why there is no grasp."""
    grasps: list[PointGraspPart]
    """The grasps, the one that forgives the largest miss first."""
