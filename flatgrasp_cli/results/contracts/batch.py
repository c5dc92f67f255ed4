"""What a batch writes beside its plans: its summary, what it remembers of each frame, and what it was made with."""

from __future__ import annotations

from typing import Literal, NotRequired

from flatgrasp_cli.profiles import CameraPose, Gripper, PlannerSettings, Robot
from flatgrasp_cli.results.contracts.base import Number, Part, Status
from flatgrasp_cli.results.contracts.grasps import MetricsPart, PosePart, SuccessPart
from flatgrasp_cli.results.contracts.plan import TimingPart

SCHEMA_ID: Literal["flatgrasp.batch/1"] = "flatgrasp.batch/1"


class InputPart(Part):
    """One input of a batch."""

    source: str
    """The file or URL."""
    results: str | None
    """The file in the batch's folder that holds the documents of its frames; null without frames."""
    frames: int
    """The number of its frames."""
    grasped: int
    """The number of those with a grasp."""
    no_grasp_by_stage: dict[str, int]
    """The numbers of the others, by the stage that kept nothing."""
    median_total_ms: Number | None
    """What a frame took, milliseconds, the median of all; null without frames."""
    median_ms: dict[str, Number]
    """The same in steps (read, scene, plan, total), milliseconds, of frames that did not wait for libraries to load."""
    first_frames_ms: list[Number]
    """What each frame took that did, milliseconds."""
    error: str | None
    """Why it could not be read to its end; null if it was."""
    warnings: list[str]
    """What had to be assumed or left out, a sentence each."""


class BatchDocument(Part):
    """A whole batch in numbers."""

    schema: Literal["flatgrasp.batch/1"]
    """Which contract this is."""
    inputs: int
    """The number of inputs."""
    failed: int
    """The number of those that could not be read to their end."""
    frames: int
    """The number of frames."""
    grasped: int
    """The number of those with a grasp."""
    no_grasp_by_stage: dict[str, int]
    """The numbers of the others, by the stage that kept nothing."""
    by_input: list[InputPart]
    """The inputs, failures first, then those with the fewest grasps."""


class RecordTimingPart(TimingPart):
    """Wall time."""

    first: bool
    """Whether this was the first frame of its process, which waits for libraries to load."""


class RecordObjectPart(Part):
    """One object of a frame; without a grasp it has no pose, widths or metrics."""

    id: int
    """Its number in the scene, from 0."""
    points: int
    """The number of its points."""
    status: Status
    """Whether it has a grasp."""
    reason: str | None
    """Why it has none."""
    stage: str | None
    """The stage that kept nothing; null when it has a grasp."""
    pose: NotRequired[PosePart]
    """The fingertips' frame at its best grasp."""
    width_m: NotRequired[Number]
    """How wide it is between the pads then, metres."""
    opening_m: NotRequired[Number]
    """How far to open the hand before, between the pads, metres."""
    success: NotRequired[SuccessPart | None]
    """How probably that grasp holds; null for a method that knows no hand (`allen`)."""
    metrics: NotRequired[MetricsPart]
    """What the method measured of that grasp."""


class SketchPart(Part):
    """An object as a report draws it: places in a picture whose y axis points up."""

    id: int
    """Its number in the scene, from 0."""
    loops: list[list[tuple[int, int]]]
    """The vertices of its outline: x, y in whole millimetres."""
    contacts: list[tuple[int, int]]
    """Where the best grasp's pads meet it: x, y in whole millimetres; empty without a grasp."""


class RecordDocument(Part):
    """What a batch remembers of one frame, for its table and its report."""

    topic: str | None
    """The recording's topic; null for a file with one cloud."""
    stamp_ns: int | None
    """When it was recorded, nanoseconds since 1970; null where that is not known."""
    frame_id: str
    """The frame of all places and poses, `cloud` if the source names none."""
    points: int
    """The number of its points."""
    status: Status
    """Whether there is a grasp."""
    reason: str | None
    """Why there is none."""
    stage: str | None
    """The stage that kept nothing; null when there is a grasp, or no object."""
    timing_ms: RecordTimingPart
    """What took how long, milliseconds."""
    objects: list[RecordObjectPart]
    """The objects, the one with the best grasp first."""
    sketch: list[SketchPart]
    """The objects as a report draws them."""
    pictures: list[str]
    """Its pictures, as paths in the batch's folder."""


class ManifestDocument(Part):
    """What the results in a folder were made with; a batch goes on only with the same."""

    schema: Literal["flatgrasp.batch/1"]
    """The contract of the batch's summary."""
    version: str
    """Of flatgrasp."""
    gripper: Gripper
    """The hand, all its values."""
    settings: PlannerSettings
    """The planner's settings, all their values."""
    robot: Robot | None
    """The arm; null if none was named."""
    camera: CameraPose | None
    """Where the camera stands in the base frame; null where that was not stated."""
    base_frame: str | None
    """The frame of all answers; null for each cloud's own."""
    selection: str
    """Which frames were wanted, in Python's words."""
    sensor: str | None
    """Where the sensor was stated to be, in Python's words; null where it was not."""
    scale: Number
    """Metres in one unit of the sources."""
    top: int
    """The number of grasps that are kept of each object."""
    plots: bool
    """Whether pictures are drawn."""
