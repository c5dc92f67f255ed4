"""One object in a document: what was found of it, how far the method came, and its grasps."""

from __future__ import annotations

from typing import Literal

from flatgrasp_cli.results.contracts.base import Number, Part, Status, Vector2, Vector3
from flatgrasp_cli.results.contracts.grasps import GraspPart


class BoxPart(Part):
    """The oriented bounding box."""

    center: Vector3
    """Its middle: x, y, z in metres."""
    axes: tuple[Vector3, Vector3, Vector3]
    """Its x, y and z axes, unit vectors: the longest in the main plane, the other one, and the plane's normal."""
    size_m: Vector3
    """Its lengths along these, metres."""


class AabbPart(Part):
    """The axis-aligned bounding box, for comparison."""

    min: Vector3
    """Its lowest corner: x, y, z in metres."""
    max: Vector3
    """Its highest corner: x, y, z in metres."""


class SilhouettePart(Part):
    """The concave hull that the fingers close on: loops in a plane."""

    origin: Vector3
    """The plane's origin: x, y, z in metres."""
    axes: tuple[Vector3, Vector3]
    """The plane's u and v axes, unit vectors."""
    loops: list[list[Vector2]]
    """Vertices [u, v] in metres: of the outer loop, counter-clockwise, then of the holes, clockwise."""
    level_m: Number | None
    """What lies higher than this is outlined, metres: over the support plane, or as `tip_height_m` has it for a hand
    that does not come straight down. Null for an object seen alone."""
    alpha_m: Number
    """Radius α of the hull's empty discs, metres."""
    coverage: Number
    """Which share of the hull's area the loops hold, the rest being fragments."""


class FingersPart(Part):
    """How the outline was sampled for finger places."""

    step_m: Number | None
    """The step r from one step point to the next, metres; null where the method did not come so far."""
    doubted_directions: int
    """The number of finger candidates whose direction failed the inside test."""


class GravityPart(Part):
    """Where the centre of gravity is taken to be, and where else it may be."""

    area: Vector3
    """Centre of the outline's area: x, y, z in metres."""
    points: Vector3
    """Mean of the visible points: x, y, z in metres."""
    distance_m: Number
    """How far the two are apart, metres."""
    used: Literal["area", "points"]
    """Which of the two was used."""


class StagePart(Part):
    """How many candidates a stage of the method kept."""

    stage: str
    """The stage's name."""
    kept: int
    """The number of what it kept."""


class MissPart(Part):
    """The stage that kept nothing, and how near the nearest candidate came."""

    stage: str
    """The stage's name."""
    value: Number | None
    """The value that came nearest, in the unit that `reason` names: metres, degrees or a ratio."""
    limit: Number | None
    """The limit that it missed, in the same unit: metres, degrees or a ratio."""


class ObjectPart(Part):
    """One object: what was found of it, and its grasps."""

    id: int
    """Its number in the scene, from 0."""
    points: int
    """The number of its points."""
    cut_off: bool
    """Whether the edge of the picture cuts it off, so that it may go on where the sensor did not look."""
    at_edge: bool
    """Whether it lies at the edge of what was seen of the support plane: such objects are picked after the others."""
    touches_others: bool
    """Whether it was told apart from others that it touches."""
    supports: list[int]
    """The numbers of the objects that lie on it, as seen from above: to be grasped before it."""
    status: Status
    """Whether it has a grasp."""
    reason: str | None
    """Why it has none."""
    remedy: str | None
    """What would help, where that is known."""
    why_not_top: str | None
    """Why the hand of its grasps comes from elsewhere than straight above, where it looked there first."""
    nearest_miss: MissPart | None
    """By how much it has none; null when it has one."""
    obb: BoxPart | None
    """Its oriented bounding box; null for points that have none."""
    aabb: AabbPart | None
    """Its axis-aligned bounding box; null for points that have none."""
    silhouette: SilhouettePart | None
    """Its outline, of the slice that was grasped; null where the method did not come so far."""
    gravity_center: GravityPart | None
    """Its centre of gravity; null without an outline."""
    fingers: FingersPart
    """How its outline was sampled."""
    funnel: list[StagePart]
    """How many candidates each stage kept, in the method's order."""
    grasps: list[GraspPart]
    """Its grasps, best first."""
    refused: list[GraspPart]
    """With a robot, the best of the grasps that it cannot carry out."""
