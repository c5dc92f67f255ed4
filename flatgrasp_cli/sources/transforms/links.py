"""What one frame hangs on, over time, in bounded memory: its parents, and its pose in each."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field

from flatgrasp_cli.sources.transforms.samples import Sample, between

RIVAL_NS = 1_000_000_000
"""A parent that was last heard of so long before a time, or is next so long after it, is not one at that time."""


@dataclass(frozen=True, slots=True)
class When:
    """A time: `stamp_ns` as the sensors' messages are stamped, `logged_ns` as they were recorded.

    Transforms that move hold at their stamps; static ones from when they were sent on, whatever their stamps say.
    """

    stamp_ns: int
    logged_ns: int


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A frame's pose in a parent at a time."""

    sample: Sample
    static: bool


@dataclass(slots=True, eq=False)
class Links:
    """The samples of one frame, by parent and in order of time: of the static ones that is when they were sent."""

    static: dict[str, list[Sample]] = field(default_factory=dict)
    moving: dict[str, list[Sample]] = field(default_factory=dict)
    changed: bool = False
    """Whether a static transform was sent again with another pose."""

    @property
    def parents(self) -> set[str]:
        """All parents that are remembered."""
        return {*self.static, *self.moving}

    def add_static(self, sample: Sample) -> None:
        """Take a static transform, stamped with when it was sent; the same again says nothing new."""
        samples = self.static.setdefault(sample.parent, [])
        place = bisect_left(samples, sample.stamp_ns, key=_stamp)
        if place and samples[place - 1].same_as(sample):
            return
        self.changed |= place > 0
        _insert(samples, sample)

    def add_moving(self, sample: Sample) -> None:
        """Take a transform that holds at its stamp."""
        _insert(self.moving.setdefault(sample.parent, []), sample)

    def forget_before(self, when: When) -> None:
        """Drop what no question about that time or a later one needs: of each parent all but the last before it."""
        for samples in self.moving.values():
            del samples[: max(0, bisect_right(samples, when.stamp_ns, key=_stamp) - 1)]
        for samples in self.static.values():
            del samples[: max(0, bisect_right(samples, when.logged_ns, key=_stamp) - 1)]

    def at(self, when: When, tolerance_ns: int) -> list[Link]:
        """The links that hold then, the newest first; more than one contradict each other."""
        moving = [Link(sample, static=False) for sample in self._moving_at(when.stamp_ns, tolerance_ns)]
        return moving + [Link(sample, static=True) for sample in self._static_at(when.logged_ns)]

    def nearest(self, stamp_ns: int) -> Sample | None:
        """The sample of a moving transform that is nearest in time."""
        samples = [sample for each in self.moving.values() for sample in each]
        return min(samples, key=lambda sample: abs(sample.stamp_ns - stamp_ns), default=None)

    def latest_parent(self) -> str:
        """The parent that was heard of last."""
        newest = max(self.moving.values(), key=lambda samples: samples[-1].stamp_ns, default=None)
        return newest[-1].parent if newest else next(reversed(self.static))

    def _static_at(self, logged_ns: int) -> list[Sample]:
        """Of each parent the pose that was sent last; if none was sent yet, the one that will be first."""
        sent = [samples[bisect_right(samples, logged_ns, key=_stamp) - 1] for samples in self.static.values()]
        past = [sample for sample in sent if sample.stamp_ns <= logged_ns]
        if past or not self.static:
            return sorted(past, key=_stamp, reverse=True)
        return [min((samples[0] for samples in self.static.values()), key=_stamp)]

    def _moving_at(self, stamp_ns: int, tolerance_ns: int) -> list[Sample]:
        """Of each parent the pose at that time, for parents that take turns; of one after the other, only one."""
        spans = [
            (samples, sample)
            for samples in self.moving.values()
            if (sample := _at(samples, stamp_ns, tolerance_ns)) is not None
        ]
        # heard of last before the time, or else next after it
        spans.sort(key=lambda span: _heard(span[0], stamp_ns), reverse=True)
        rivals = [
            sample
            for samples, sample in spans[1:]
            if samples[0].stamp_ns <= spans[0][0][-1].stamp_ns
            and spans[0][0][0].stamp_ns <= samples[-1].stamp_ns
            and min(abs(each.stamp_ns - stamp_ns) for each in samples) <= RIVAL_NS
        ]
        return [*(sample for _, sample in spans[:1]), *rivals]


def _heard(samples: list[Sample], stamp_ns: int) -> tuple[bool, int]:
    """In the order of what counts more: the last sample until then, the later the better, or the first after it."""
    place = bisect_right(samples, stamp_ns, key=_stamp)
    return (True, samples[place - 1].stamp_ns) if place else (False, -samples[0].stamp_ns)


def _at(samples: list[Sample], stamp_ns: int, tolerance_ns: int) -> Sample | None:
    """The pose at a time, between two samples or within the tolerance of one."""
    after = bisect_left(samples, stamp_ns, key=_stamp)
    if 0 < after < len(samples) and samples[after].stamp_ns != stamp_ns:
        return between(samples[after - 1], samples[after], stamp_ns)
    held = samples[min(after, len(samples) - 1)]
    return held if abs(held.stamp_ns - stamp_ns) <= tolerance_ns else None


def _stamp(sample: Sample) -> int:
    return sample.stamp_ns


def _insert(samples: list[Sample], sample: Sample) -> None:
    """Keep the list sorted by time; a second sample of the same time replaces the first."""
    place = bisect_left(samples, sample.stamp_ns, key=_stamp)
    if place < len(samples) and samples[place].stamp_ns == sample.stamp_ns:
        samples[place] = sample
    else:
        samples.insert(place, sample)
