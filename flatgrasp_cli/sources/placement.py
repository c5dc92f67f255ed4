"""Clouds of a recording in the frame asked for, and where their sensor was, by the recording's own transforms."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from flatgrasp_cli.model import SENSOR_FROM_TF, Cloud, CloudWarning, Sensor
from flatgrasp_cli.recordings.containers.recording import Message, Recording
from flatgrasp_cli.recordings.messages import MessageError
from flatgrasp_cli.sensor.frame_names import has_z_up, is_optical
from flatgrasp_cli.sources.depth_axes import AXES_ASSUMED, axes_by_transforms, axes_matter, in_body_axes
from flatgrasp_cli.sources.selection import Selection
from flatgrasp_cli.sources.transforms import REMEDY, MissingTransform, Route, TransformBuffer

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


class Placement:
    """Brings clouds into the base frame of `selection`, if it has one, and says where their sensor was.

    `opened` opens the recording once more, for transforms are read ahead of the clouds; that is done only when one is
    needed. `has_transforms` says whether there are any.
    """

    def __init__(self, opened: Callable[[], RecordedTransforms], selection: Selection, *, has_transforms: bool) -> None:
        self._open, self._selection, self._has_transforms = opened, selection, has_transforms
        self._opened: RecordedTransforms | None = None

    @property
    def _transforms(self) -> RecordedTransforms:
        if self._opened is None:
            self._opened = self._open()
        return self._opened

    def place(self, cloud: Cloud, logged_ns: int, *, depth: bool) -> Cloud:
        """The cloud, logged at `logged_ns`, from a `depth` image or not, where it is wanted, with its sensor.

        Raises
        ------
        MissingTransform
            If no transforms lead to the base frame or to the sensor's at the cloud's time.
        """
        if depth:
            cloud = self._with_axes(cloud, logged_ns)
        if self._selection.sensor_frame is not None:
            cloud = self._with_stated_sensor(cloud, self._selection.sensor_frame, logged_ns)
        elif self._has_transforms and cloud.sensor is None and cloud.viewpoint is None and has_z_up(cloud.frame_id):
            cloud = self._with_likely_sensor(cloud, logged_ns)
        base = self._selection.base_frame
        if base is None:
            return cloud
        route = self._transforms.route(base, cloud.frame_id, cloud, logged_ns)
        return cloud.in_frame(route.frame, base).warned(*route.warnings)

    def _with_axes(self, cloud: Cloud, logged_ns: int) -> Cloud:
        """A depth image's cloud, which is in optical axes, in those of the frame it is stamped with."""
        axes = self._selection.depth_axes or ("optical" if is_optical(cloud.frame_id) else None)
        based = self._selection.base_frame is not None or self._selection.sensor_frame is not None
        if axes is None and based:
            stamp_ns = self._transforms.read_until(cloud, logged_ns)
            axes = axes_by_transforms(self._transforms.buffer, cloud.frame_id, stamp_ns, logged_ns)
        if axes is None and axes_matter(cloud.frame_id, based=based):
            return cloud.warned(AXES_ASSUMED)
        return in_body_axes(cloud) if axes == "body" else cloud

    def _with_stated_sensor(self, cloud: Cloud, frame: str, logged_ns: int) -> Cloud:
        try:
            route = self._transforms.route(cloud.frame_id, frame, cloud, logged_ns)
        except MissingTransform as error:
            raise MissingTransform(f"--sensor {frame}: {error}") from error
        return replace(cloud, sensor=Sensor("option", route.frame.origin)).warned(*route.warnings)

    def _with_likely_sensor(self, cloud: Cloud, logged_ns: int) -> Cloud:
        """A robot's camera is the likely sensor of a cloud in the robot's base, if there is only one."""
        self._transforms.read_until(cloud, logged_ns)
        frames = [frame for frame in self._transforms.buffer.frames() if is_optical(frame)]
        depth = [frame for frame in frames if "depth" in frame.lower()]  # of one camera's frames, the one that measures
        likely = frames if len(frames) == 1 else depth
        if len(likely) != 1:
            return cloud
        try:
            route = self._transforms.route(cloud.frame_id, likely[0], cloud, logged_ns)
        except MissingTransform:
            return cloud
        taken = CloudWarning(
            SENSOR_FROM_TF,
            f"the sensor was taken to be at {likely[0]}, as the transforms place it; --sensor states another place",
        )
        return replace(cloud, sensor=Sensor("transforms", route.frame.origin)).warned(taken, *route.warnings)
