"""The tree of frames over time, from tf messages, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import CloudWarning
from flatgrasp_cli.placing import Route
from flatgrasp_cli.recordings.messages.decoded import frame_name
from flatgrasp_cli.sources.transforms.links import Link, Links
from flatgrasp_cli.sources.transforms.routes import IDENTITY, REMEDY, Attempt, Chain, MissingTransform, decided
from flatgrasp_cli.sources.transforms.runs import TOLERANCE_NS, When
from flatgrasp_cli.sources.transforms.samples import Read, read_transforms

LISTED_FRAMES = 20


@dataclass(slots=True, eq=False)
class TransformBuffer:
    """Transforms as they come in, and the pose of any frame in any other at a time between them.

    As in tf2 a frame has one parent, and the newest message says which. Where two messages contradict each other that
    hold at one time, though, the answer would depend on which came last: that is an error if both lead to the frame
    wanted, and a warning if one does. Where time jumps back, a frame gets what was logged nearest to it, and a warning.
    """

    tolerance_ns: int = TOLERANCE_NS
    _links: dict[str, Links] = field(default_factory=dict)
    _ignored: dict[str, Read] = field(default_factory=dict)
    _stretched: dict[str, Read] = field(default_factory=dict)

    def add(self, message: Any, *, static: bool = False, logged_ns: int = 0, only_new: bool = False) -> None:
        """Take a TFMessage, a foxglove.FrameTransform or a foxglove.FrameTransforms.

        Those that move hold at their stamps; `static` ones from `logged_ns` on, and before if there is no other. With
        `only_new`, a static one is taken only for a link of which none is known.

        Raises
        ------
        MessageError
            If the message is none of these.
        """
        for read in read_transforms(message):
            if read.sample is None:
                self._ignored[read.child] = read
                continue
            if read.fault:
                self._stretched[read.child] = read
            links = self._links.setdefault(read.child, Links())
            if not static:
                links.add_moving(read.sample.logged(logged_ns))
            elif not (only_new and read.parent in links.static):
                links.add_static(read.sample.sent(logged_ns))

    def forget_before(self, stamp_ns: int, logged_ns: int | None = None) -> None:
        """Drop what no lookup at or after these times needs."""
        for links in self._links.values():
            links.forget_before(When(stamp_ns, stamp_ns if logged_ns is None else logged_ns))

    def frames(self) -> tuple[str, ...]:
        """All frames that were named, sorted."""
        parents = (links.parents for links in self._links.values())
        ignored = ({read.parent, read.child} for read in self._ignored.values())
        return tuple(sorted(set().union(self._links, *parents, *ignored)))

    def listed(self) -> str:
        """The frames in words, the first ones if they are many."""
        return f"frames in this recording: {_short(self.frames())}"

    def lookup(self, target: str, source: str, stamp_ns: int, logged_ns: int | None = None) -> Frame:
        """The frame `source` in `target`: its `to_world` turns points in source into points in target; see `route`."""
        return self.route(target, source, stamp_ns, logged_ns).frame

    def route(self, target: str, source: str, stamp_ns: int, logged_ns: int | None = None) -> Route:
        """The frame `source` in `target` at a time, and what had to be assumed.

        Between two samples the translation is linear and the rotation the shorter arc. Outside them nothing is
        extrapolated: the nearest sample holds for `tolerance_ns`. Static transforms are those of `logged_ns`, the same
        as `stamp_ns` if not given.

        Raises
        ------
        MissingTransform
            If a frame is unknown, the frames are not connected, a link has no sample near that time, or two
            transforms contradict each other.
        """
        target, source = frame_name(target), frame_name(source)
        if target == source:
            return Route(IDENTITY)
        when = When(stamp_ns, stamp_ns if logged_ns is None else logged_ns)
        attempt = self._attempt(target, source, when, {})
        doubts: list[CloudWarning] = []
        for child, links in attempt.used.items():
            for link in links[1:]:
                other = self._attempt(target, source, when, {child: link})
                attempt, doubt = decided(attempt, other, child, (links[0], link), target)
                doubts += [doubt] if doubt else []
        frame = attempt.frame
        if frame is None:
            raise self._missing(target, source, attempt)
        return Route(frame, (*doubts, *self._notes(attempt.used)))

    def _attempt(self, target: str, source: str, when: When, chosen: Mapping[str, Link]) -> Attempt:
        """The way between two frames, by the newest links or those `chosen`."""
        up, down = self._chain(source, when, chosen), self._chain(target, when, chosen)
        return Attempt(up, down, next((name for name in up.poses if name in down.poses), None))

    def _chain(self, name: str, when: When, chosen: Mapping[str, Link]) -> Chain:
        poses, met, circle = {name: IDENTITY}, {}, None
        while name in self._links:
            met[name] = self._links[name].at(when, self.tolerance_ns)
            link = chosen.get(name) or next(iter(met[name]), None)
            if link is None:
                return Chain(poses, met, self._stale(name, when), None)
            if link.sample.parent in poses:
                circle = link.sample.parent
                break
            place = Frame(link.sample.translation, axes_from_quaternion(link.sample.quaternion))
            pose = poses[name]
            name = link.sample.parent
            poses[name] = Frame(place.to_world(pose.origin), pose.axes @ place.axes)
        return Chain(poses, met, None, circle)

    def _stale(self, child: str, when: When) -> str | None:
        """Why a frame has no parent at a time: all its transforms are of other times."""
        nearest = self._links[child].nearest(when.stamp_ns)
        if nearest is None:
            return None
        # the sample's time, not the distance to it: the same words for all frames that miss it, which are counted
        return (
            f"{child} ← {nearest.parent} is not known at that time, the nearest sample is "
            f"{'earlier' if nearest.stamp_ns < when.stamp_ns else 'later'}, at {nearest.stamp_ns / 1e9:.3f} s"
        )

    def _notes(self, used: Mapping[str, list[Link]]) -> list[CloudWarning]:
        """What was wrong with transforms of the frames that were used."""
        notes = []
        for child, links in used.items():
            for link in [link for link in links if link.back_ns][:1]:
                text = (
                    f"the time of the transform from {link.sample.parent} to {child} jumps back by "
                    f"{link.back_ns / 1e9:.3f} s, and each frame got the one logged nearest to it; {REMEDY}"
                )
                notes.append(CloudWarning("transform_time_jump", text))
            if child in self._ignored:
                notes.append(CloudWarning("transform_ignored", f"{_ignored(self._ignored[child])}; {REMEDY}"))
            if child in self._stretched:
                read = self._stretched[child]
                text = f"the transform from {read.parent} to {child} was used, though {read.fault}; {REMEDY}"
                notes.append(CloudWarning("transform_normalised", text))
            if child in self._links and self._links[child].changed:
                text = f"the static transform of {child} changes, and each frame got the one of its time; {REMEDY}"
                notes.append(CloudWarning("transform_changed", text))
        return notes

    def _missing(self, target: str, source: str, attempt: Attempt) -> MissingTransform:
        frames, up, down = self.frames(), attempt.up, attempt.down
        for name in (target, source):
            if name not in frames:
                return MissingTransform(f"no frame {name!r} in this recording; {self.listed()}")
        head = f"no transform from {source} to {target}: "
        circle = next((chain for chain in (up, down) if chain.circle is not None), None)
        if circle is not None and circle.circle is not None:
            names = list(circle.poses)
            path = " ← ".join([*names[names.index(circle.circle) :], circle.circle])
            return MissingTransform(f"{head}the transforms go round in a circle, {path}; {REMEDY}")
        ignored = next((self._ignored[name] for name in (up.root, down.root) if name in self._ignored), None)
        if ignored is not None:
            return MissingTransform(f"{head}{_ignored(ignored)}; {REMEDY}")
        stale = up.stale or down.stale
        if stale:
            return MissingTransform(head + stale)
        path = " ← ".join(up.poses)
        known = f"{path} is known and ends there" if len(up.poses) > 1 else f"{source} has no parent"
        tree = [name for name in frames if self._root(name) == down.root]
        return MissingTransform(f"{head}{known}; {down.root} is the root of: {_short(tree)}; {self.listed()}")

    def _root(self, name: str) -> str:
        """The root above a frame, going by its latest parents."""
        seen: set[str] = set()
        while name not in seen and name in self._links:
            seen.add(name)
            name = self._links[name].latest_parent()
        return name


def _ignored(read: Read) -> str:
    return f"the transform from {read.parent} to {read.child} was ignored, for {read.fault}"


def _short(names: Iterable[str]) -> str:
    names = list(names)
    rest = f", and {len(names) - LISTED_FRAMES} more" if len(names) > LISTED_FRAMES else ""
    return (", ".join(names[:LISTED_FRAMES]) or "none") + rest
