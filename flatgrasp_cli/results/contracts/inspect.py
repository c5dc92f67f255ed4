"""The document of schema `flatgrasp.inspect/1`: what one source holds."""

from __future__ import annotations

from typing import Literal

from flatgrasp_cli.results.contracts.base import Number, Part, Vector3
from flatgrasp_cli.results.contracts.plan import SensorPart


class TopicPart(Part):
    """A topic of a recording."""

    name: str
    """Its name."""
    type: str
    """The type of its messages, as ROS 2 writes it or as their schema is named."""
    encoding: str
    """How they are encoded: cdr, ros1, json, protobuf."""
    count: int | None
    """The number of its messages; null where only reading them all would tell."""
    rate_hz: Number | None
    """The mean number of them a second, over the whole recording; null where that is not known."""


class FirstCloudPart(Part):
    """The first cloud of a topic, or that of a file."""

    topic: str | None
    """Its topic; null for a file."""
    stamp_ns: int | None
    """When it was recorded, nanoseconds since 1970; null where that is not known."""
    frame_id: str
    """The frame that its points are in, `cloud` if the source names none."""
    points: int
    """The number of points that it declares."""
    shape: list[int]
    """The numbers of its rows and columns for an organised cloud, else the number of its points."""
    fields: list[str]
    """The names of its points' fields, or an image's encoding; empty where the format has no choice."""
    dropped: int
    """The number of points that were not measured: NaN, infinite, exactly 0 0 0, or farther away than 10 km."""
    nan_share: Number
    """Their share of all."""
    low_m: Vector3 | None
    """The lowest corner of its axis-aligned box: x, y, z in metres; null for a cloud without points."""
    high_m: Vector3 | None
    """The highest corner of it: x, y, z in metres; null for a cloud without points."""
    sensor: SensorPart
    """Where its sensor was, in its own frame."""
    warnings: list[str]
    """What had to be assumed, a sentence each."""


class InspectDocument(Part):
    """What one source holds; times are null where it has none."""

    schema: Literal["flatgrasp.inspect/1"]
    """Which contract this is."""
    path: str
    """The file, folder or URL; `stdin` for standard input."""
    container: str
    """What it is, in words."""
    start_ns: int | None
    """The time of its first message, nanoseconds since 1970."""
    end_ns: int | None
    """The time of its last message, nanoseconds since 1970."""
    topics: list[TopicPart]
    """A recording's topics."""
    frames: list[str]
    """The frames that are named in it."""
    clouds: list[FirstCloudPart]
    """The first cloud of each topic that holds clouds, or that of a file."""
    problems: dict[str, int]
    """What could not be read, in words, and the number of times."""
    duration_s: Number | None
    """From the first message to the last, seconds."""
