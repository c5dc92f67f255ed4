"""A recording → its clouds: the frames of one topic that are wanted, one in memory at a time."""

from __future__ import annotations

import logging
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from flatgrasp_cli.errors import NoFramesError
from flatgrasp_cli.model import Cloud, CloudWarning, ImageGrid, Sensor, Source
from flatgrasp_cli.recordings.containers import open_recording
from flatgrasp_cli.recordings.containers.recording import Message, Problems, Recording, Topic, printable
from flatgrasp_cli.recordings.messages import (
    CLOUD_TYPES,
    INFO_TYPE,
    UNIT_TYPE,
    Decoded,
    DepthCameras,
    MessageError,
    info_topics_for,
    unit_topic_for,
)
from flatgrasp_cli.sensor.frame_names import has_z_up, is_optical
from flatgrasp_cli.source_names import in_utf8
from flatgrasp_cli.sources.depth_unit import unit_warning
from flatgrasp_cli.sources.idle_options import idle_options
from flatgrasp_cli.sources.placement import Placement
from flatgrasp_cli.sources.selection import NS, Every, Selection
from flatgrasp_cli.sources.topics import choose_topic
from flatgrasp_cli.sources.transforms import TRANSFORM_TYPES, MissingTransform, RecordedTransforms

_log = logging.getLogger(__name__)

Decode = Callable[[Any], Decoded]
WARNED = 10
"""Kinds of problems that are told one by one; damage that is never twice the same must not flood a terminal."""


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
        problems = [recording.problems]
        try:
            topic = choose_topic(recording, selection.topic, name)

            def transforms() -> RecordedTransforms:
                again = stack.enter_context(open_recording(path, name, strict=selection.strict))
                problems.append(again.problems)
                return RecordedTransforms(again, _window(recording, selection)[0])

            there = any(item.type in TRANSFORM_TYPES for item in recording.topics)
            placement = Placement(transforms, selection, has_transforms=there)
            idle = idle_options(selection, recorded=True, images=topic.type not in CLOUD_TYPES)
            for _, cloud in usable_frames(recording, topic, (name, scale, placement), selection):
                yield cloud.warned(*idle)
        finally:
            _warn(name, problems)


def _warn(name: str, problems: Iterable[Problems]) -> None:
    """Tell what was left out; what was met at each of two readings of one file is counted once."""
    counts: Counter[str] = Counter()
    for each in problems:
        counts |= each.counts
    told = list(counts.items())[:WARNED]
    for what, count in told:
        _log.warning("%s: %s%s", name, what, f" ({count} times)" if count > 1 else "")
    if rest := counts.total() - sum(count for _, count in told):
        _log.warning("%s: and %d more problems like these", name, rest)


def usable_frames(
    recording: Recording, topic: Topic, to: tuple[str, float, Placement | None], selection: Selection
) -> Iterator[tuple[Message, Cloud]]:
    """The wanted frames that can be decoded, scaled and placed; `to` is the name for errors, scale and placement.

    Raises
    ------
    NoFramesError
        If there are none.
    """
    name, scale, placement = to
    called = printable(topic.name)
    messages, decode = _opened(recording, topic, selection)
    most = 1 if selection.at else selection.count
    yielded = seen = 0
    reason = ""
    for message in _thinned(messages, selection.every):
        seen += 1
        try:
            cloud = _cloud(decode(message.value), message, Source(name, index=yielded), scale)
            depth = topic.type not in CLOUD_TYPES
            placed = placement.place(cloud, message.stamp_ns, depth=depth) if placement else cloud
        except (MessageError, MissingTransform) as error:
            reason = printable(str(error))
            recording.problems.add(f"frame on {called} left out: {reason}")
            continue
        yield message, placed
        yielded += 1
        if yielded == most:
            return
    if yielded == 0 and seen:
        recording.problems.counts.pop(f"frame on {called} left out: {reason}", None)  # the error says it
        which = "the only frame" if seen == 1 else f"all {seen} frames"
        raise NoFramesError(f"{name}: {which} on {called} left out: {reason}")
    if yielded == 0:
        raise NoFramesError(f"{name}: no message on {called} {_why_none(recording, selection)}")


def _opened(recording: Recording, topic: Topic, selection: Selection) -> tuple[Iterator[Message], Decode]:
    """The topic's messages, and how to decode one."""
    window = _window(recording, selection)
    if topic.type in CLOUD_TYPES:
        decoder = CLOUD_TYPES[topic.type]
        messages = recording.messages([topic.name], *window)
        return (message for message in messages if message.topic.type == topic.type), partial(
            decoder, colors=selection.colors
        )
    cameras = DepthCameras(selection.intrinsics, selection.depth_unit_m)
    return _images(recording, topic, window, cameras), partial(cameras.decode, topic.name)


def _images(
    recording: Recording, topic: Topic, window: tuple[int | None, int | None], cameras: DepthCameras
) -> Iterator[Message]:
    """The topic's images; on the way `cameras` learn of the CameraInfos, and of the depth's unit if it is recorded."""

    def learn(message: Message) -> None:
        try:
            if message.topic.type == INFO_TYPE:
                cameras.add_info(message.topic.name, message.value)
            elif message.topic.type == UNIT_TYPE:
                cameras.add_unit(message.value)
        except MessageError as error:
            recording.problems.add(f"message on {message.topic.name} left out: {error}")

    units = {item.name for item in recording.topics if item.type == UNIT_TYPE} & {unit_topic_for(topic.name)}
    infos = info_topics_for(topic.name, [item.name for item in recording.topics if item.type == INFO_TYPE])
    beside = (*infos, *(name for name in units if name))
    before = recording.problems.copy()
    for each in beside:  # the first one may come a moment after the first image
        for first in islice(recording.messages([each]), 1):
            learn(first)
    recording.problems.reset(before)
    for message in recording.messages([topic.name, *beside], *window):
        if message.topic.type == topic.type:
            yield message
        else:
            learn(message)


def _cloud(decoded: Decoded, message: Message, source: Source, scale: float) -> Cloud:
    stamp_ns = message.stamp_ns if decoded.stamp_ns is None else decoded.stamp_ns
    viewpoint = decoded.viewpoint
    if (frame_id := in_utf8(decoded.frame_id)) != decoded.frame_id:  # JSON has escapes for what no text can hold
        raise MessageError(f"its frame {frame_id} is no text in UTF-8")
    if viewpoint is None and not has_z_up(decoded.frame_id):
        viewpoint = np.zeros(3)  # a sensor publishes what it sees in a frame of its own
    if viewpoint is not None and not math.isfinite(scale * float(np.abs(viewpoint).max())):
        raise MessageError(f"its pose is not finite in units of {scale:g} m")
    return Cloud(
        points=decoded.points if scale == 1.0 else scale * decoded.points,
        viewpoint=None if viewpoint is None else scale * viewpoint,
        source=replace(source, topic=message.topic.name, stamp_ns=stamp_ns, logged_ns=message.stamp_ns),
        frame_id=decoded.frame_id,
        dropped=decoded.dropped,
        colors=decoded.colors,
        sensor=Sensor("frame", np.zeros(3)) if decoded.from_camera or is_optical(decoded.frame_id) else None,
        pixels=None if decoded.filled is None else ImageGrid(decoded.shape, decoded.filled),
        warnings=tuple(_warnings(decoded, scale)),
    )


def _warnings(decoded: Decoded, scale: float) -> Iterator[CloudWarning]:
    """What had to be assumed of a message."""
    for item in decoded.assumptions:
        yield CloudWarning(item.code, item.text)
    unit_m = decoded.assumed_unit_m
    if unit_m is not None and scale == 1.0:  # whoever gives a scale has settled what a count is
        doubt = unit_warning(decoded.points[:, 2], unit_m)
        if doubt is not None:
            yield doubt


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


def _why_none(recording: Recording, selection: Selection) -> str:
    start, end = _window(recording, selection)
    if recording.start_ns is None or recording.end_ns is None or (start is None and end is None):
        problem = recording.problems.taken()
        return f"could be read{problem and f': {problem}'}"
    words = [f"from {_seconds(start, recording)} s on"] if start else []
    words += [f"before {_seconds(end, recording)} s"] if end else []
    return f"{' and '.join(words)}; the recording lasts {_seconds(recording.end_ns, recording)} s"


def _seconds(stamp_ns: int, recording: Recording) -> str:
    return f"{(stamp_ns - (recording.start_ns or 0)) / NS:.3f}"
