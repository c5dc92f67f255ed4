"""What only a recording's transforms tell of its clouds: which way their axes point, and where their sensor was."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from flatgrasp_cli.model import SENSOR_FROM_TF, Cloud, CloudWarning, Sensor
from flatgrasp_cli.placing import placed
from flatgrasp_cli.sensor.frame_names import has_z_up, is_optical
from flatgrasp_cli.sources.depth_axes import AXES_ASSUMED, axes_by_transforms, axes_matter, in_body_axes
from flatgrasp_cli.sources.selection import Selection
from flatgrasp_cli.sources.transforms import MissingTransform, RecordedTransforms


class Placement:
    """Says of clouds what transforms tell, and hands them on to where `selection` wants them.

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
        wanted = self._selection
        return placed(
            cloud,
            wanted.base_frame,
            wanted.camera_pose,
            lambda target, source: self._transforms.route(target, source, cloud, logged_ns),
        )

    def _with_axes(self, cloud: Cloud, logged_ns: int) -> Cloud:
        """A depth image's cloud, which is in optical axes, in those of the frame it is stamped with."""
        axes = self._selection.depth_axes or ("optical" if is_optical(cloud.frame_id) else None)
        based = self._selection.needs_transforms
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
