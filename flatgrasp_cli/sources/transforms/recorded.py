"""The transforms of an open recording, read along with its clouds."""

from __future__ import annotations

from collections.abc import Iterator

from flatgrasp_cli.model import Cloud
from flatgrasp_cli.placing import Route
from flatgrasp_cli.recordings.containers.recording import Message, Recording
from flatgrasp_cli.recordings.messages import MessageError
from flatgrasp_cli.sources.transforms.buffer import TransformBuffer
from flatgrasp_cli.sources.transforms.routes import REMEDY, MissingTransform

TRANSFORM_TYPES = frozenset(
    {
        "tf2_msgs/msg/TFMessage",
        "tf/msg/tfMessage",
        "foxglove.FrameTransform",
        "foxglove.FrameTransforms",
        "foxglove_msgs/msg/FrameTransform",
        "foxglove_msgs/msg/FrameTransforms",
    }
)
STATIC = "tf_static"
AHEAD_NS = 1_000_000_000
"""Transforms are logged at most this much later than the clouds that they place."""
KEPT_NS = 5_000_000_000
"""Clouds are stamped at most this much earlier than those before them."""


class RecordedTransforms:
    """Follows the transforms of `recording`, a little ahead of the clouds, and forgets them behind.

    No cloud is logged before `start_ns`, if that is given.
    """

    def __init__(self, recording: Recording, start_ns: int | None = None) -> None:
        self._recording = recording
        self.buffer = TransformBuffer()
        topics = {topic.name for topic in recording.topics if topic.type in TRANSFORM_TYPES}
        self._static = {name for name in topics if name.endswith(STATIC)}
        before = recording.problems.copy()
        first_ns = recording.start_ns if start_ns is None else start_ns
        for message in recording.messages(self._static):  # the first of a link holds for all clouds before it, too
            later = first_ns is not None and message.stamp_ns > first_ns
            self._add(message, only_new=later)
            if not later:
                self.buffer.forget_before(message.stamp_ns)
        if start_ns is None:
            recording.problems.reset(before)  # they are read once more
        self._ahead: Iterator[Message] = recording.messages(topics, None if start_ns is None else start_ns - KEPT_NS)
        self._read_to_ns = -1

    def route(self, target: str, source: str, cloud: Cloud, logged_ns: int) -> Route:
        """The frame `source` in `target` at the time of a cloud, logged at `logged_ns`.

        Raises
        ------
        MissingTransform
            If there is none, or two that contradict each other.
        """
        stamp_ns = self.read_until(cloud, logged_ns)
        try:
            route = self.buffer.route(target, source, stamp_ns, logged_ns)
        except MissingTransform as error:
            if cloud.frame_id in self.buffer.frames():
                raise
            raise MissingTransform(  # the frame itself is there, for the cloud is in it
                f"no transform from {source} to {target}: none names {cloud.frame_id!r}, the frame of the clouds; "
                f"{self.buffer.listed()}; {REMEDY}"
            ) from error
        self.buffer.forget_before(stamp_ns - KEPT_NS, logged_ns - KEPT_NS)
        return route

    def read_until(self, cloud: Cloud, logged_ns: int) -> int:
        """Read on to a little after a cloud; returns the cloud's time."""
        while self._read_to_ns < logged_ns + AHEAD_NS:
            message = next(self._ahead, None)
            if message is None:
                break
            self._add(message)
            self._read_to_ns = message.stamp_ns
        return cloud.source.stamp_ns or logged_ns

    def _add(self, message: Message, *, only_new: bool = False) -> None:
        static = message.topic.name in self._static
        try:
            self.buffer.add(message.value, static=static, logged_ns=message.stamp_ns, only_new=only_new)
        except MessageError as error:
            self._recording.problems.add(f"message on {message.topic.name} left out: {error}")
