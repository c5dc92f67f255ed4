"""What a source holds: container, topics, duration, frames, and the first cloud of each topic with clouds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import UNNAMED_FRAME, Cloud, Sensor
from flatgrasp_cli.recordings.containers import Recording, Topic, is_recording, open_recording
from flatgrasp_cli.recordings.messages import CLOUD_TYPES, MessageError
from flatgrasp_cli.sensor import located
from flatgrasp_cli.source_names import in_utf8, name_of
from flatgrasp_cli.sources.files import kind_of_file, read_kind
from flatgrasp_cli.sources.folders import folder_images, kind_of_folder
from flatgrasp_cli.sources.frames import usable_frames
from flatgrasp_cli.sources.open import on_disk
from flatgrasp_cli.sources.pcd_header import read_pcd_header
from flatgrasp_cli.sources.selection import EVERYTHING, NS, Selection
from flatgrasp_cli.sources.topics import depth_topics
from flatgrasp_cli.sources.transforms import TRANSFORM_TYPES, TransformBuffer

DECIMALS = 9
TRANSFORMS_READ = 1000
"""Transform messages of each topic that are read for the names of frames."""


@dataclass(frozen=True, slots=True)
class TopicSummary:
    """A topic; `rate_hz` is its mean over the whole recording."""

    name: str
    type: str
    encoding: str
    count: int | None
    rate_hz: float | None


@dataclass(frozen=True, slots=True)
class CloudSummary:
    """The first cloud of a topic, or that of a file; `low_m` and `high_m` are the corners of its axis-aligned box."""

    topic: str | None
    stamp_ns: int | None
    frame_id: str
    points: int
    shape: tuple[int, ...]
    fields: tuple[str, ...]
    dropped: int
    """Points that were not measured: NaN, infinite, exactly 0 0 0, or out of all bounds."""
    nan_share: float
    """Their share."""
    low_m: tuple[float, ...] | None
    high_m: tuple[float, ...] | None
    sensor: dict[str, Any]
    """`position` and `direction` (3,) or None, and how that is `known_from`."""
    warnings: tuple[str, ...]
    """What had to be assumed to say so."""


@dataclass(frozen=True, slots=True)
class Summary:
    """What a source holds; times are None where there are none."""

    path: str
    container: str
    start_ns: int | None = None
    end_ns: int | None = None
    topics: tuple[TopicSummary, ...] = ()
    frames: tuple[str, ...] = ()
    clouds: tuple[CloudSummary, ...] = ()
    problems: dict[str, int] = field(default_factory=dict)

    @property
    def duration_s(self) -> float | None:
        """Seconds from the first message to the last."""
        return None if self.start_ns is None or self.end_ns is None else (self.end_ns - self.start_ns) / NS


def summarize(source: str, selection: Selection = EVERYTHING) -> Summary:
    """What the file, folder or standard input ("-") `source` holds; `selection` says of what camera depth images are.

    Raises
    ------
    SourceError
        If it cannot be read at all.
    """
    name = name_of(source)
    with on_disk(source) as path:
        if path.is_dir() and kind_of_folder(path, name) == "images":
            first = next(folder_images(path, name, 1.0, selection))
            return Summary(name, "depth images", clouds=(_of_cloud(first, _image_shape(first), ()),))
        if not is_recording(path):
            return _of_file(path, name, selection)
        with open_recording(path, name) as recording:
            topics = tuple(_of_topic(topic, recording) for topic in recording.topics)
            clouds = tuple(_of_clouds(name, recording, selection))
            frames = {*_frames(recording), *(cloud.frame_id for cloud in clouds)} - {UNNAMED_FRAME}
            return Summary(
                path=name,
                container=recording.container,
                start_ns=recording.start_ns,
                end_ns=recording.end_ns,
                topics=topics,
                frames=tuple(sorted(map(in_utf8, frames))),
                clouds=clouds,
                problems=dict(recording.problems.counts),
            )


def _of_file(path: Path, name: str, selection: Selection) -> Summary:
    kind = kind_of_file(path, name)
    cloud = read_kind(kind, path, name, 1.0, selection)
    if kind != "PCD":
        return Summary(name, kind, clouds=(_of_cloud(cloud, _image_shape(cloud), ()),))
    with path.open("rb") as file:
        header = read_pcd_header(file, name)
    return Summary(name, kind, clouds=(_of_cloud(cloud, (header.height, header.width), header.fields),))


def _image_shape(cloud: Cloud) -> tuple[int, ...]:
    """Height and width of a cloud that is an image, or its number of points."""
    return cloud.pixels.shape if cloud.pixels else (len(cloud.points) + cloud.dropped,)


def _of_topic(topic: Topic, recording: Recording) -> TopicSummary:
    rate = None
    if topic.count is not None and topic.count > 1 and recording.start_ns is not None and recording.end_ns is not None:
        duration_ns = recording.end_ns - recording.start_ns
        rate = (topic.count - 1) * NS / duration_ns if duration_ns > 0 else None
    return TopicSummary(name=topic.name, type=topic.type, encoding=topic.encoding, count=topic.count, rate_hz=rate)


def _of_clouds(name: str, recording: Recording, selection: Selection) -> Iterator[CloudSummary]:
    topics = [topic for topic in recording.topics if topic.type in CLOUD_TYPES and topic.count != 0]
    for topic in (*topics, *depth_topics(recording)):
        try:
            message, cloud = next(usable_frames(recording, topic, (name, 1.0, None), selection))
        except SourceError as error:
            recording.problems.add(str(error).removeprefix(f"{name}: "))
            continue
        yield _of_cloud(cloud, _shape(message.value, cloud), _fields(message.value))


def _of_cloud(cloud: Cloud, shape: tuple[int, ...], fields: tuple[str, ...]) -> CloudSummary:
    declared = len(cloud.points) + cloud.dropped
    cloud = located(cloud, None, 0)
    empty = len(cloud.points) == 0
    return CloudSummary(
        topic=cloud.source.topic,
        stamp_ns=cloud.source.stamp_ns,
        frame_id=cloud.frame_name,
        points=declared,
        shape=shape,
        fields=fields,
        dropped=cloud.dropped,
        nan_share=cloud.dropped / declared if declared else 0.0,
        low_m=None if empty else tuple(cloud.points.min(axis=0).tolist()),
        high_m=None if empty else tuple(cloud.points.max(axis=0).tolist()),
        sensor=_sensor(cloud.sensor),
        warnings=tuple(warning.text for warning in cloud.warnings),
    )


def _sensor(sensor: Sensor | None) -> dict[str, Any]:
    position, direction = (None, None) if sensor is None else (sensor.position, sensor.direction)
    return {
        "position": None if position is None else position.round(DECIMALS).tolist(),
        "direction": None if direction is None else direction.round(DECIMALS).tolist(),
        "known_from": None if sensor is None else sensor.known_from,
    }


def _shape(message: Any, cloud: Cloud) -> tuple[int, ...]:
    """Height and width of an organised cloud, or the number of points."""
    height, width = int(getattr(message, "height", 0)), int(getattr(message, "width", 0))
    declared = len(cloud.points) + cloud.dropped
    return (height, width) if height * width == declared else (declared,)


def _fields(message: Any) -> tuple[str, ...]:
    """Names of the fields of a cloud's points; an image's encoding."""
    if hasattr(message, "encoding") or hasattr(message, "format"):
        return (str(getattr(message, "encoding", "") or getattr(message, "format", "")),)
    if hasattr(message, "channels"):
        return ("x", "y", "z", *(str(channel.name) for channel in message.channels))
    return tuple(str(item.name) for item in message.fields)


def _frames(recording: Recording) -> tuple[str, ...]:
    """Frames that the first transforms name."""
    buffer = TransformBuffer()
    for name in sorted({topic.name for topic in recording.topics if topic.type in TRANSFORM_TYPES}):
        for message in islice(recording.messages([name]), TRANSFORMS_READ):
            try:
                buffer.add(message.value)
            except MessageError as error:
                recording.problems.add(f"message on {name} left out: {error}")
    return buffer.frames()
