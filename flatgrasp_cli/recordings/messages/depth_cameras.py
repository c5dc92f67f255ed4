"""Depth images with the CameraInfo that belongs to each, from a stream of both."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.recordings.messages.camera_info import CameraInfo
from flatgrasp_cli.recordings.messages.decoded import Assumption, Decoded, MessageError, frame_name, reading, stamp_ns
from flatgrasp_cli.recordings.messages.depth_image import image_size, read_depth
from flatgrasp_cli.recordings.messages.principal_point import camera_doubt

TRANSPORTS = ("/compressedDepth", "/compressed")
INFO_NAME = "camera_info"
RECTIFIED_WORDS = frozenset({"rect", "rectified"})
RECTIFIED_NAMES = re.compile(r"(^|/)(aligned_depth_to_[^/]+/.*|depth_registered)$")
"""Topics that are rectified without saying so: realsense-ros's depth in another camera, and the last name of ZED's."""
REALSENSE_IMAGE = re.compile(r"(?P<sensor>.*/sensor_\d+)/(?P<stream>[^/]+)/image/data")
"""An image in a recording of RealSense's SDK."""
REALSENSE_UNIT = "option/Depth Units/value"
REMEMBERED = 2
"""CameraInfos of one topic that are kept: they hardly ever change."""
RAYS_KEPT = 4


class MissingCameraInfo(MessageError):  # noqa: N818 - says what is missing, as the standard library's do
    """A depth image came before any CameraInfo that fits it; a later one may."""


def info_topics_for(image_topic: str, all_topics: Iterable[str]) -> tuple[str, ...]:
    """Those of the topics with CameraInfos to read: the image's sibling camera_info if there is one, otherwise all."""
    topics = tuple(all_topics)
    siblings = tuple(topic for topic in _siblings(image_topic) if topic in topics)
    return siblings[:1] or topics


def unit_topic_for(image_topic: str) -> str | None:
    """Where a recording of RealSense's SDK says what a count of depth is; None for other topics."""
    parts = REALSENSE_IMAGE.fullmatch(image_topic)
    return f"{parts['sensor']}/{REALSENSE_UNIT}" if parts else None


def is_rectified(image_topic: str) -> bool:
    """Whether a topic holds rectified images, in which no distortion is left to undo, by its name.

    The name is all there is: one CameraInfo describes both the raw image (K and the distortion) and the rectified one
    (P). Where "rect" or "rectified" is a word of the topic, image_proc or a driver rectified it (image_rect,
    image_rect_raw, depth_rect). All other depth has the distortion that its CameraInfo states: an infrared camera's
    depth is as distorted as its picture.
    """
    base = _base(image_topic).lower()
    return bool(RECTIFIED_WORDS.intersection(re.split("[^a-z]+", base)) or RECTIFIED_NAMES.search(base))


@dataclass(frozen=True, slots=True)
class _Stamped:
    info: CameraInfo
    frame_id: str
    stamp_ns: int | None


@dataclass(slots=True, eq=False)
class DepthCameras:
    """The cameras of one recording: takes CameraInfos as they come, decodes depth images with those that fit.

    The rays of a camera's pixels are computed once, and again only if its calibration changes.
    """

    intrinsics: CameraInfo | None = None
    """Describes all images, whatever the recording says."""
    unit_m: float | None = None
    """Metres in one count, whatever the recording says."""
    recorded_unit_m: float | None = None
    """Metres in one count, as the recording says beside the images."""
    _infos: dict[str, deque[_Stamped]] = field(default_factory=dict)
    _rays: dict[tuple[CameraInfo, int, int, bool], FloatArray] = field(default_factory=dict)

    def add_info(self, topic: str, message: Any) -> None:
        """Remember a CameraInfo; raises `MessageError` if it is none."""
        info = CameraInfo.from_message(message)
        with reading("CameraInfo"):
            stamped = _Stamped(info, frame_name(message.header.frame_id), stamp_ns(message.header.stamp))
        self._infos.setdefault(topic, deque(maxlen=REMEMBERED)).append(stamped)

    def add_unit(self, message: Any) -> None:
        """Remember the metres in a count of depth, which `message.data` is; raises `MessageError` if it cannot be."""
        with reading("number"):
            metres = float(message.data)
        if not 0 < metres < np.inf:
            raise MessageError(f"says that a count of depth is {metres} m")
        self.recorded_unit_m = metres

    def decode(self, topic: str, message: Any) -> Decoded:
        """The points of a depth image in its optical frame: x right, y down, z forward.

        The CameraInfo is that of the topic's sibling camera_info, or else any with the image's frame and size; of those
        the one nearest in time.

        Raises
        ------
        MissingCameraInfo
            If none fits yet.
        MessageError
            If the image is broken or holds no depth, or its camera is not calibrated for it.
        """
        with reading("image"):
            frame, stamp = frame_name(message.header.frame_id), stamp_ns(message.header.stamp)
        width, height = image_size(message)
        info = self._info_for(topic, frame, (width, height), stamp)
        info.check_size(width, height)  # before anything of the image's size is allocated
        image = read_depth(message)
        unit_m = self._unit_m(message)
        depth, pixels = image.metres(unit_m)
        rays = self._rays_of(info, (width, height), rectified=is_rectified(topic))
        points = np.empty((len(depth), 3))
        points[:, :2] = rays[pixels]
        points[:, :2] *= depth[:, None]
        points[:, 2] = depth
        finite = np.isfinite(points[:, 0])
        if not finite.all():
            points = points[finite]
        return Decoded(
            points,
            None,
            dropped=width * height - len(points),
            shape=(height, width),
            frame_id=frame,
            stamp_ns=stamp,
            from_camera=True,
            assumed_unit_m=image.unit_m if unit_m is None else None,
            assumptions=(*image.assumptions, *self._doubts(width, height)),
        )

    def _doubts(self, width: int, height: int) -> Iterator[Assumption]:
        """Only of what somebody stated: a recorded CameraInfo is the camera's own, and says of which size it is."""
        doubt = None if self.intrinsics is None else camera_doubt(self.intrinsics, width, height)
        if doubt is not None:
            yield doubt

    def _unit_m(self, message: Any) -> float | None:
        """Metres in one count, as somebody, the message, or the recording says; None if nobody does."""
        if self.unit_m is not None:
            return self.unit_m
        with reading("image"):
            own = float(getattr(message, "depth_units", 0.0))
        return own if 0 < own < np.inf else self.recorded_unit_m

    def _info_for(self, topic: str, frame_id: str, size: tuple[int, int], stamp: int | None) -> CameraInfo:
        if self.intrinsics is not None:
            return self.intrinsics
        found = [stamped for sibling in _siblings(topic) for stamped in self._infos.get(sibling, ())]
        if not found:
            known = [stamped for infos in self._infos.values() for stamped in infos]
            found = [stamped for stamped in known if (stamped.frame_id, stamped.info.size) == (frame_id, size)]
        if not found:
            there = ", ".join(self._infos) or "none"
            raise MissingCameraInfo(
                f"no CameraInfo for {topic}: expected on {next(_siblings(topic))}, or one for frame {frame_id!r} and "
                f"{size[0]} × {size[1]} pixels; CameraInfos seen so far: {there}; "
                "or give --intrinsics fx,fy,cx,cy"
            )
        newest_first = found[::-1]
        if stamp is None:
            return newest_first[0].info
        return min(newest_first, key=lambda stamped: abs((stamped.stamp_ns or 0) - stamp)).info

    def _rays_of(self, info: CameraInfo, size: tuple[int, int], *, rectified: bool) -> FloatArray:
        key = (info, *size, rectified)
        if key not in self._rays:
            while len(self._rays) >= RAYS_KEPT:
                del self._rays[next(iter(self._rays))]
            self._rays[key] = info.rays(*size, rectified=rectified)
        return self._rays[key]


def _base(topic: str) -> str:
    """The image's topic without what image_transport appends."""
    for transport in TRANSPORTS:
        topic = topic.removesuffix(transport)
    return topic


def _siblings(topic: str) -> Iterator[str]:
    """Where the CameraInfo of an image topic is by convention: beside the image; a few simulators put it below.

    RealSense's SDK has it at …/Depth_0/info/camera_info for …/Depth_0/image/data.
    """
    base = _base(topic)
    if parts := REALSENSE_IMAGE.fullmatch(base):
        yield f"{parts['sensor']}/{parts['stream']}/info/{INFO_NAME}"
    yield f"{base.rpartition('/')[0]}/{INFO_NAME}"
    yield f"{base}/{INFO_NAME}"
