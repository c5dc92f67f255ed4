"""The tree of frames over time, from tf messages, in bounded memory."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.sources.messages.decoded import frame_name, reading, stamp_ns, unit_quaternion

TOLERANCE_NS = 100_000_000
"""A transform counts as still (or already) true for so long after (before) its only neighbour in time."""
LISTED_FRAMES = 20
NEARLY_PARALLEL = 0.9995
"""Cosine of half the angle between two rotations above which their arc is as good as straight."""


class MissingTransform(LookupError):  # noqa: N818 - says what is missing, as the standard library's do
    """Two frames are not connected, or not at that time; the text says where the chain ends."""


@dataclass(frozen=True, slots=True, eq=False)
class _Sample:
    """A child's pose in its parent: `translation` (3,), unit `quaternion` [x, y, z, w]."""

    stamp_ns: int
    parent: str
    translation: FloatArray
    quaternion: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Chain:
    """Frames from one upwards, with the first one's pose in each; `stale` says why it ends, if not at a root."""

    poses: dict[str, Frame]
    stale: str | None

    @property
    def root(self) -> str:
        return next(reversed(self.poses))


@dataclass(slots=True, eq=False)
class TransformBuffer:
    """Transforms as they come in, and the pose of any frame in any other at a time between them."""

    ignored: int = 0
    """Transforms that were no rigid motion: NaN, infinite, a quaternion of norm 0, or a frame within itself."""
    tolerance_ns: int = TOLERANCE_NS
    _static: dict[str, _Sample] = field(default_factory=dict)
    _moving: dict[str, list[_Sample]] = field(default_factory=dict)

    def add(self, message: Any, *, static: bool = False) -> None:
        """Take a TFMessage, a foxglove.FrameTransform or a foxglove.FrameTransforms; `static` ones hold at all times.

        Raises
        ------
        MessageError
            If the message is none of these.
        """
        with reading("transform"):
            for transform in getattr(message, "transforms", None) or _alone(message):
                child, sample = _read(transform)
                if sample is None:
                    self.ignored += 1
                elif static:
                    self._static[child] = sample
                else:
                    _insert(self._moving.setdefault(child, []), sample)

    def forget_before(self, stamp_ns: int) -> None:
        """Drop what no lookup at or after `stamp_ns` needs: of each frame all but the last sample before that."""
        for samples in self._moving.values():
            del samples[: max(0, bisect_right(samples, stamp_ns, key=_stamp) - 1)]

    def frames(self) -> tuple[str, ...]:
        """All frames that were named, sorted."""
        children = {*self._static, *self._moving}
        moving = (sample.parent for samples in self._moving.values() for sample in samples)
        return tuple(sorted(children.union(moving, (sample.parent for sample in self._static.values()))))

    def lookup(self, target: str, source: str, stamp_ns: int) -> Frame:
        """The frame `source` in `target` at a time: its `to_world` turns points in source into points in target.

        Between two samples the translation is linear and the rotation the shorter arc. Outside them nothing is
        extrapolated: the nearest sample holds for `tolerance_ns`.

        Raises
        ------
        MissingTransform
            If a frame is unknown, the frames are not connected, or a link has no sample near that time.
        """
        target, source = frame_name(target), frame_name(source)
        if target == source:
            return _IDENTITY
        up, down = self._chain(source, stamp_ns), self._chain(target, stamp_ns)
        common = next((name for name in up.poses if name in down.poses), None)
        if common is None:
            raise self._missing(target, source, up, down)
        return _relative(up.poses[common], down.poses[common])

    def _chain(self, name: str, stamp_ns: int) -> _Chain:
        poses, stale = {name: _IDENTITY}, None
        while True:
            sample, stale = self._at(name, stamp_ns)
            if sample is None or sample.parent in poses:  # the latter would go round in a circle
                return _Chain(poses, stale)
            link = Frame(sample.translation, axes_from_quaternion(sample.quaternion))
            pose = poses[name]
            name = sample.parent
            poses[name] = Frame(link.to_world(pose.origin), pose.axes @ link.axes)

    def _at(self, child: str, stamp_ns: int) -> tuple[_Sample | None, str | None]:
        """The child's pose at a time; or None, and why if there are samples at other times."""
        samples = self._moving.get(child)
        if not samples:
            return self._static.get(child), None
        after = bisect_left(samples, stamp_ns, key=_stamp)
        if after < len(samples) and (after == 0 or samples[after].stamp_ns == stamp_ns):
            held = samples[after]
        else:
            held = samples[after - 1]
            if after < len(samples) and samples[after].parent == held.parent:
                return _between(held, samples[after], stamp_ns), None
        if abs(held.stamp_ns - stamp_ns) <= self.tolerance_ns:
            return held, None
        # the sample's time, not the distance to it: the same words for all frames that miss it, which are counted
        return None, (
            f"{child} ← {held.parent} is not known at that time, the nearest sample is "
            f"{'earlier' if held.stamp_ns < stamp_ns else 'later'}, at {held.stamp_ns / 1e9:.3f} s"
        )

    def _missing(self, target: str, source: str, up: _Chain, down: _Chain) -> MissingTransform:
        frames = self.frames()
        for name in (target, source):
            if name not in frames:
                return MissingTransform(f"no frame {name!r} in this recording; {_listed(frames)}")
        head = f"no transform from {source} to {target}: "
        stale = up.stale or down.stale
        if stale:
            return MissingTransform(head + stale)
        path = " ← ".join(up.poses)
        known = f"{path} is known and ends there" if len(up.poses) > 1 else f"{source} has no parent"
        tree = [name for name in frames if self._root(name) == down.root]
        return MissingTransform(f"{head}{known}; {down.root} is the root of: {_short(tree)}; {_listed(frames)}")

    def _root(self, name: str) -> str:
        """The root above a frame, going by its latest parents."""
        seen: set[str] = set()
        while name not in seen:
            seen.add(name)
            samples = self._moving.get(name)
            sample = samples[-1] if samples else self._static.get(name)
            name = sample.parent if sample else name
        return name


_IDENTITY = Frame(np.zeros(3), np.eye(3))


def _alone(message: Any) -> Iterable[Any]:
    """A foxglove.FrameTransform is one transform, not a list; an empty list has none."""
    return () if hasattr(message, "transforms") else (message,)


def _read(transform: Any) -> tuple[str, _Sample | None]:
    """The child's name and its sample, None if that is no rigid motion."""
    if hasattr(transform, "parent_frame_id"):
        parent, stamp, motion = transform.parent_frame_id, transform.timestamp, transform
    else:
        parent, stamp, motion = transform.header.frame_id, transform.header.stamp, transform.transform
    parent, child = frame_name(parent), frame_name(transform.child_frame_id)
    translation = np.array([getattr(motion.translation, axis) for axis in "xyz"], dtype=np.float64)
    quaternion = np.array([getattr(motion.rotation, axis) for axis in "xyzw"], dtype=np.float64)
    unit = unit_quaternion(quaternion)
    if unit is None or not np.isfinite(translation).all() or parent == child:
        return child, None
    return child, _Sample(stamp_ns(stamp) or 0, parent, translation, unit)


def _stamp(sample: _Sample) -> int:
    return sample.stamp_ns


def _insert(samples: list[_Sample], sample: _Sample) -> None:
    """Keep the list sorted by time; a second sample of the same time replaces the first."""
    place = bisect_left(samples, sample.stamp_ns, key=_stamp)
    if place < len(samples) and samples[place].stamp_ns == sample.stamp_ns:
        samples[place] = sample
    else:
        samples.insert(place, sample)


def _between(before: _Sample, after: _Sample, stamp_ns: int) -> _Sample:
    share = (stamp_ns - before.stamp_ns) / (after.stamp_ns - before.stamp_ns)
    translation = before.translation + share * (after.translation - before.translation)
    return _Sample(stamp_ns, before.parent, translation, _slerp(before.quaternion, after.quaternion, share))


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


def _relative(source: Frame, target: Frame) -> Frame:
    """`source` in `target`, both given in a third frame."""
    return Frame(target.to_local(source.origin), source.axes @ target.axes.T)


def _listed(frames: Iterable[str]) -> str:
    return f"frames in this recording: {_short(frames)}"


def _short(names: Iterable[str]) -> str:
    names = list(names)
    rest = f", and {len(names) - LISTED_FRAMES} more" if len(names) > LISTED_FRAMES else ""
    return (", ".join(names[:LISTED_FRAMES]) or "none") + rest
