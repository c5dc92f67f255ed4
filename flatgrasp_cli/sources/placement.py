"""Clouds of a recording in the frame asked for, by the recording's own transforms."""

from __future__ import annotations

from collections.abc import Iterator

from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources.containers.recording import Message, Recording
from flatgrasp_cli.sources.messages import MessageError
from flatgrasp_cli.sources.transforms import TransformBuffer

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


class Placement:
    """Follows the transforms of `recording`, a little ahead of the clouds, and forgets them behind.

    No cloud is logged before `start_ns`, if that is given.
    """

    def __init__(self, recording: Recording, base_frame: str, start_ns: int | None = None) -> None:
        self._base_frame, self._recording = base_frame, recording
        self._buffer = TransformBuffer()
        topics = {topic.name for topic in recording.topics if topic.type in TRANSFORM_TYPES}
        static = {name for name in topics if name.endswith(STATIC)}
        for message in recording.messages(static):
            self._add(message, static=True)
        self._moving: Iterator[Message] = recording.messages(
            topics - static, None if start_ns is None else start_ns - KEPT_NS
        )
        self._read_to_ns = -1

    def place(self, cloud: Cloud, logged_ns: int) -> Cloud:
        """The cloud, logged at `logged_ns`, in the base frame.

        Raises
        ------
        MissingTransform
            If no chain of transforms leads there at the cloud's time.
        """
        self._read_until(logged_ns + AHEAD_NS)
        stamp_ns = cloud.source.stamp_ns or logged_ns
        frame = self._buffer.lookup(self._base_frame, cloud.frame_id, stamp_ns)
        self._buffer.forget_before(stamp_ns - KEPT_NS)
        return cloud.in_frame(frame, self._base_frame)

    def _read_until(self, logged_ns: int) -> None:
        while self._read_to_ns < logged_ns:
            message = next(self._moving, None)
            if message is None:
                return
            self._add(message, static=False)
            self._read_to_ns = message.stamp_ns

    def _add(self, message: Message, *, static: bool) -> None:
        try:
            self._buffer.add(message.value, static=static)
        except MessageError as error:
            self._recording.problems.add(f"message on {message.topic.name} left out: {error}")
