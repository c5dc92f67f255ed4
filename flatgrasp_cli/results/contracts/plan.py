"""The whole document of schema `flatgrasp.plan/1`: the answer for one frame."""

from __future__ import annotations

from typing import Literal

from flatgrasp_cli.model import KnownFrom
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot
from flatgrasp_cli.results.contracts.base import Number, Part, Status, Vector3
from flatgrasp_cli.results.contracts.objects import ObjectPart

SCHEMA_ID: Literal["flatgrasp.plan/1"] = "flatgrasp.plan/1"


class SourcePart(Part):
    """The frame that was planned on."""

    path: str
    """The file or URL, bytes of its name that are no UTF-8 as `\\xNN`; `stdin` for standard input."""
    topic: str | None
    """The recording's topic; null for a file with one cloud."""
    stamp_ns: int | None
    """When it was recorded, nanoseconds since 1970; null where that is not known."""
    frame_id: str
    """The frame that its points are in, `cloud` if the source names none."""
    points: int
    """The number of its points."""
    dropped: int
    """The number of points that were not measured: NaN, infinite, exactly 0 0 0, or farther away than 10 km."""
    index: int
    """Its number among the frames that were read, from 0."""


class SensorPart(Part):
    """Where the sensor was, in the document's `frame_id`."""

    position: Vector3 | None
    """Its place: x, y, z in metres; null where that is not known, or several saw the cloud."""
    direction: Vector3 | None
    """Where only that is known, the unit vector that points to it."""
    known_from: KnownFrom
    """How it is known."""


class WarningPart(Part):
    """Something that had to be assumed and can change the answer."""

    code: str
    """What it is about, in a word that stays the same."""
    text: str
    """A sentence, with the option that settles it."""


class ContainerPart(Part):
    """A bin, tray or box: walls around what lies deeper."""

    points: int
    """The number of points that were seen of it."""
    height_m: Number
    """How high the highest of them lies over the support plane, metres."""


class SupportPlanePart(Part):
    """The plane that objects stand on: normal · p = offset_m."""

    normal: Vector3
    """Its normal, a unit vector, toward free space."""
    offset_m: Number
    """Its offset along the normal, metres."""
    noise_m: Number
    """Standard deviation of its own points about it, metres."""


class TimingPart(Part):
    """Wall time."""

    read: Number
    """To read the cloud, milliseconds."""
    scene: Number
    """To find the objects, milliseconds."""
    plan: Number
    """To plan their grasps, milliseconds."""
    total: Number
    """From opening the source to the plan, milliseconds."""


class Document(Part):
    """The answer for one frame."""

    schema: Literal["flatgrasp.plan/1"]
    """Which contract this is."""
    status: Status
    """Whether there is a grasp."""
    reason: str | None
    """Why there is none."""
    remedy: str | None
    """What would help, where that is known."""
    source: SourcePart
    """The frame that was planned on."""
    sensor: SensorPart
    """Where the sensor was."""
    warnings: list[WarningPart]
    """What had to be assumed and can change the answer."""
    frame_id: str
    """The frame of all places, directions and poses of this document; `cloud` if the source names none."""
    gripper: Gripper
    """The hand, all its values."""
    robot: Robot | None
    """The arm; null if none was named."""
    settings: PlannerSettings
    """The planner's settings, all their values."""
    support_plane: SupportPlanePart | None
    """The plane that the objects stand on; null for an object seen alone."""
    container: ContainerPart | None
    """The bin that the objects lie in, an obstacle as a whole; null where there is none."""
    objects: list[ObjectPart]
    """The objects, the one with the best grasp first."""
    timing_ms: TimingPart
    """What took how long, milliseconds."""
