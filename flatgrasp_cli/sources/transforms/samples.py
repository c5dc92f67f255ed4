"""Transforms as messages give them: checked, and interpolated between two of one link."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.recordings.messages.decoded import frame_name, reading, stamp_ns, unit_quaternion

NEARLY_PARALLEL = 0.9995
"""Cosine of half the angle between two rotations above which their arc is as good as straight."""
LARGEST_M = 1e9
"""No two frames on Earth, or near it, are so far apart."""
ROUNDING = 1e-6
"""Metres or radians between two poses that are the same: what 32 bits are short of at 10 m."""
UNIT_TOLERANCE = 1e-3
"""A quaternion whose length is 1 within this is only rounded."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A child's pose in its parent, and when it holds and was logged.

    `translation` is (3,), the unit `quaternion` [x, y, z, w].
    """

    stamp_ns: int
    parent: str
    translation: FloatArray
    quaternion: FloatArray
    logged_ns: int = 0

    @property
    def lateness_ns(self) -> int:
        """How long after its time it was logged."""
        return self.logged_ns - self.stamp_ns

    def logged(self, logged_ns: int) -> Sample:
        """The same, with when it was logged."""
        return replace(self, logged_ns=logged_ns)

    def sent(self, stamp_ns: int) -> Sample:
        """The same, stamped with when it was sent."""
        return replace(self, stamp_ns=stamp_ns)

    def same_as(self, other: Sample) -> bool:
        """Whether it is the same pose in the same parent but for rounding, at whatever time."""
        return self.parent == other.parent and self.apart(other) <= ROUNDING

    def apart(self, other: Sample) -> float:
        """How far two poses in one parent are apart: metres and radians, summed."""
        return float(apart(self.translation, self.quaternion, other.translation, other.quaternion))


@dataclass(frozen=True, slots=True)
class Read:
    """One transform of a message. `sample` is None if it is no rigid motion; `fault` says what is wrong with it."""

    parent: str
    child: str
    sample: Sample | None
    fault: str = ""


def read_transforms(message: Any) -> Iterator[Read]:
    """The transforms in a TFMessage, a foxglove.FrameTransform or a foxglove.FrameTransforms.

    Raises
    ------
    MessageError
        If the message is none of these.
    """
    with reading("transform"):
        yield from [_read(transform) for transform in getattr(message, "transforms", None) or _alone(message)]


def _alone(message: Any) -> Iterable[Any]:
    """A foxglove.FrameTransform is one transform, not a list; an empty list has none."""
    return () if hasattr(message, "transforms") else (message,)


def _read(transform: Any) -> Read:
    if hasattr(transform, "parent_frame_id"):
        parent, stamp, motion = transform.parent_frame_id, transform.timestamp, transform
    else:
        parent, stamp, motion = transform.header.frame_id, transform.header.stamp, transform.transform
    parent, child = frame_name(parent), frame_name(transform.child_frame_id)
    translation = np.array([getattr(motion.translation, axis) for axis in "xyz"], dtype=np.float64)
    quaternion = np.array([getattr(motion.rotation, axis) for axis in "xyzw"], dtype=np.float64)
    unit = unit_quaternion(quaternion)
    if parent == child:
        return Read(parent, child, None, "it is one of a frame in itself")
    if unit is None:
        zero = not quaternion.any()
        return Read(parent, child, None, "its quaternion is 0 0 0 0" if zero else "its quaternion is not finite")
    if not (np.abs(translation) <= LARGEST_M).all():  # false for NaN, too
        finite = np.isfinite(translation).all()
        return Read(parent, child, None, f"its translation is {'beyond all places' if finite else 'not finite'}")
    length = float(np.abs(quaternion @ unit))
    fault = "its quaternion is not of length 1" if abs(length - 1.0) > UNIT_TOLERANCE else ""
    return Read(parent, child, Sample(stamp_ns(stamp) or 0, parent, translation, unit), fault)


def apart(
    translation: FloatArray, quaternion: FloatArray, other_translation: FloatArray, other_quaternion: FloatArray
) -> FloatArray:
    """How far poses are apart, (…): metres and radians, summed, from translations (…, 3) and quaternions (…, 4)."""
    # q and −q are the same rotation; of small angles the length between unit quaternions is the half
    turned = np.minimum(_length(quaternion - other_quaternion), _length(quaternion + other_quaternion))
    return _length(translation - other_translation) + 2.0 * turned


def _length(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=-1)))


def between(before: Sample, after: Sample, stamp_ns: int) -> Sample:
    """The pose at a time between two of the same parent: the translation on a line, the rotation on the shorter arc."""
    share = (stamp_ns - before.stamp_ns) / (after.stamp_ns - before.stamp_ns)
    translation = before.translation + share * (after.translation - before.translation)
    return Sample(stamp_ns, before.parent, translation, _slerp(before.quaternion, after.quaternion, share))


def _slerp(q: FloatArray, r: FloatArray, share: float) -> FloatArray:
    """Unit quaternion `share` of the way from `q` to `r` (Shoemake, SIGGRAPH 1985), along the shorter arc."""
    cosine = float(q @ r)
    if cosine < 0.0:  # r and −r are the same rotation
        r, cosine = -r, -cosine
    if cosine > NEARLY_PARALLEL:
        mixed = q + share * (r - q)
    else:
        angle = np.arccos(cosine)
        mixed = (np.sin((1 - share) * angle) * q + np.sin(share * angle) * r) / np.sin(angle)
    return np.asarray(mixed / np.linalg.norm(mixed))
