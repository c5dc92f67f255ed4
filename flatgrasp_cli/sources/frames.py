"""A recording → its clouds: the frames of one topic that are wanted, one in memory at a time."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from flatgrasp_cli.errors import NoFramesError
from flatgrasp_cli.model import Cloud, Source
from flatgrasp_cli.sources.containers import open_recording
from flatgrasp_cli.sources.containers.recording import Message, Recording, Topic
from flatgrasp_cli.sources.messages import (
    CLOUD_TYPES,
    INFO_TYPE,
    Decoded,
    DepthCameras,
    MessageError,
    info_topics_for,
)
from flatgrasp_cli.sources.placement import Placement
from flatgrasp_cli.sources.selection import NS, Every, Selection
from flatgrasp_cli.sources.topics import choose_topic
from flatgrasp_cli.sources.transforms import MissingTransform

_log = logging.getLogger(__name__)

Decode = Callable[[Any], Decoded]


def recorded_clouds(path: Path, name: str, scale: float, selection: Selection) -> Iterator[Cloud]:
    """Yield the wanted clouds of the recording at `path`, whose name for people is `name`.

    What cannot be read is skipped, counted, and warned of at the end.

    Raises
    ------
    SourceError
        If nothing can be read, the topic is not there, or none of its frames can be used; with `strict` at the first
        problem.
    """
    with ExitStack() as stack:
        recording = stack.enter_context(open_recording(path, name, strict=selection.strict))
        try:
            topic = choose_topic(recording, selection.topic, name)
            placement = None
            if selection.base_frame is not None:  # opened once more, for transforms are read ahead of the clouds
                again = stack.enter_context(open_recording(path, name))
                placement = Placement(again, selection.base_frame, _window(recording, selection)[0])
            yield from _usable(recording, topic, (name, scale, placement), selection)
        finally:
            for what, count in recording.problems.counts.items():
                _log.warning("%s: %s%s", name, what, f" ({count} times)" if count > 1 else "")


def _usable(
    recording: Recording, topic: Topic, to: tuple[str, float, Placement | None], selection: Selection
) -> Iterator[Cloud]:
    """The wanted frames that can be decoded and placed."""
    name, scale, placement = to
    messages, decode = _opened(recording, topic, selection)
    most = 1 if selection.at else selection.count
    yielded = seen = 0
    reason = ""
    for message in _thinned(messages, selection.every):
        seen += 1
        try:
            cloud = _cloud(decode(message.value), message, name, yielded).scaled(scale)
            placed = placement.place(cloud, message.stamp_ns) if placement else cloud
        except (MessageError, MissingTransform) as error:
            reason = str(error)
            recording.problems.add(f"frame on {topic.name} left out: {reason}")
            continue
        yield placed
        yielded += 1
        if yielded == most:
            return
    if yielded == 0 and seen:
        recording.problems.counts.pop(f"frame on {topic.name} left out: {reason}", None)  # the error says it
        raise NoFramesError(f"{name}: none of {seen} frames on {topic.name} can be used: {reason}")
    if yielded == 0:
        raise NoFramesError(f"{name}: no message on {topic.name} {_in_time(recording, selection)}")


def _opened(recording: Recording, topic: Topic, selection: Selection) -> tuple[Iterator[Message], Decode]:
    """The topic's messages, and how to decode one."""
    window = _window(recording, selection)
    if topic.type in CLOUD_TYPES:
        decoder = CLOUD_TYPES[topic.type]
        messages = recording.messages([topic.name], *window)
        return (message for message in messages if message.topic.type == topic.type), partial(
            decoder, colors=selection.colors
        )
    cameras = DepthCameras()
    return _images(recording, topic, window, cameras), partial(cameras.decode, topic.name)


def _images(
    recording: Recording, topic: Topic, window: tuple[int | None, int | None], cameras: DepthCameras
) -> Iterator[Message]:
    """The topic's images; on the way `cameras` learn of the CameraInfos."""

    def learn(message: Message) -> None:
        try:
            cameras.add_info(message.topic.name, message.value)
        except MessageError as error:
            recording.problems.add(f"message on {message.topic.name} left out: {error}")

    infos = info_topics_for(topic.name, [item.name for item in recording.topics if item.type == INFO_TYPE])
    for info in infos:  # the first one may come a moment after the first image
        for first in islice(recording.messages([info]), 1):
            learn(first)
    for message in recording.messages([topic.name, *infos], *window):
        if message.topic.type == INFO_TYPE:
            learn(message)
        else:
            yield message


def _cloud(decoded: Decoded, message: Message, name: str, index: int) -> Cloud:
    stamp_ns = message.stamp_ns if decoded.stamp_ns is None else decoded.stamp_ns
    source = Source(name, message.topic.name, stamp_ns, index)
    return Cloud(decoded.points, decoded.viewpoint, source, decoded.frame_id, decoded.dropped, decoded.colors)


def _thinned(messages: Iterator[Message], every: Every) -> Iterator[Message]:
    """Every n-th message, or the first in each period after the first message."""
    if every.period_ns is None:
        yield from islice(messages, 0, None, every.frames)
        return
    period: int | None = None
    first_ns = 0
    for message in messages:
        first_ns = message.stamp_ns if period is None else first_ns
        current = (message.stamp_ns - first_ns) // every.period_ns
        if period is None or current > period:
            yield message
            period = current


def _window(recording: Recording, selection: Selection) -> tuple[int | None, int | None]:
    """The times in nanoseconds between which frames are wanted; None for no limit."""
    first_ns = recording.start_ns or 0
    start = selection.at or selection.start
    return (
        start.after(first_ns) if start else None,
        selection.end.after(first_ns) if selection.end else None,
    )


def _in_time(recording: Recording, selection: Selection) -> str:
    if recording.start_ns is None or recording.end_ns is None:
        return "could be read"
    start, end = _window(recording, selection)
    words = [f"from {_seconds(start, recording)} s on"] if start else []
    words += [f"before {_seconds(end, recording)} s"] if end else []
    return f"{' and '.join(words)}; the recording lasts {_seconds(recording.end_ns, recording)} s".strip("; ")


def _seconds(stamp_ns: int, recording: Recording) -> str:
    return f"{(stamp_ns - (recording.start_ns or 0)) / NS:.3f}"
