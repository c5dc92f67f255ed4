"""What one frame hangs on, over time, in bounded memory: its parents, and its pose in each."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field

from flatgrasp_cli.sources.transforms.runs import Run, When, add_to, forget, poses_at, stamp_of
from flatgrasp_cli.sources.transforms.samples import Sample

RIVAL_NS = 1_000_000_000
"""A parent that was last heard of so long before a time, or is next so long after it, is not one at that time."""


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A frame's pose in a parent at a time."""

    sample: Sample
    static: bool
    back_ns: int = 0
    """By how much stamps jump back, where there is another pose for the same time from before or after that."""


@dataclass(slots=True, eq=False)
class Links:
    """The samples of one frame, by parent and in order of time: of the static ones that is when they were sent."""

    static: dict[str, list[Sample]] = field(default_factory=dict)
    moving: dict[str, list[Run]] = field(default_factory=dict)
    changed: bool = False
    """Whether a static transform was sent again with another pose."""

    @property
    def parents(self) -> set[str]:
        """All parents that are remembered."""
        return {*self.static, *self.moving}

    def add_static(self, sample: Sample) -> None:
        """Take a static transform, stamped with when it was sent; the same again says nothing new."""
        samples = self.static.setdefault(sample.parent, [])
        place = bisect_right(samples, sample.stamp_ns, key=stamp_of)
        if place and samples[place - 1].same_as(sample):
            return
        self.changed |= place > 0
        if place and samples[place - 1].stamp_ns == sample.stamp_ns:
            samples[place - 1] = sample
        else:
            samples.insert(place, sample)

    def add_moving(self, sample: Sample) -> None:
        """Take a transform that holds at its stamp."""
        add_to(self.moving.setdefault(sample.parent, []), sample)

    def forget_before(self, when: When) -> None:
        """Drop what no question about that time or a later one needs: of each parent all but the last before it."""
        for runs in self.moving.values():
            forget(runs, when)
        for samples in self.static.values():
            del samples[: max(0, bisect_right(samples, when.logged_ns, key=stamp_of) - 1)]

    def at(self, when: When, tolerance_ns: int) -> list[Link]:
        """The links that hold then, the newest first; more than one contradict each other."""
        return self._moving_at(when, tolerance_ns) + [
            Link(sample, static=True) for sample in self._static_at(when.logged_ns)
        ]

    def nearest(self, stamp_ns: int) -> Sample | None:
        """The sample of a moving transform that is nearest in time."""
        samples = [run.nearest(stamp_ns) for runs in self.moving.values() for run in runs]
        return min(samples, key=lambda sample: abs(sample.stamp_ns - stamp_ns), default=None)

    def latest_parent(self) -> str:
        """The parent that was heard of last."""
        newest = [run.samples[-1] for runs in self.moving.values() for run in runs]
        return max(newest, key=stamp_of).parent if newest else next(reversed(self.static))

    def _static_at(self, logged_ns: int) -> list[Sample]:
        """Of each parent the pose that was sent last; if none was sent yet, the one that will be first."""
        sent = [samples[bisect_right(samples, logged_ns, key=stamp_of) - 1] for samples in self.static.values()]
        past = [sample for sample in sent if sample.stamp_ns <= logged_ns]
        if past or not self.static:
            return sorted(past, key=stamp_of, reverse=True)
        return [min((samples[0] for samples in self.static.values()), key=stamp_of)]

    def _moving_at(self, when: When, tolerance_ns: int) -> list[Link]:
        """Of each parent the poses at that time, for parents that take turns; of one after the other, only one's."""
        found = [here for runs in self.moving.values() if (here := poses_at(runs, when, tolerance_ns)) is not None]
        # heard of last before the time, or else next after it
        found.sort(key=lambda here: _heard(here[0].samples, when.stamp_ns), reverse=True)
        rivals = [here for here in found[1:] if _take_turns(here[0], found[0][0], when.stamp_ns)]
        return [
            Link(pose, static=False, back_ns=back_ns) for _, poses, back_ns in [*found[:1], *rivals] for pose in poses
        ]


def _take_turns(run: Run, latest: Run, stamp_ns: int) -> bool:
    """Whether one parent's samples go on while the latest one's do, and are not far from a time."""
    return (
        run.samples[0].stamp_ns <= latest.samples[-1].stamp_ns
        and latest.samples[0].stamp_ns <= run.samples[-1].stamp_ns
        and abs(run.nearest(stamp_ns).stamp_ns - stamp_ns) <= RIVAL_NS
    )


def _heard(samples: list[Sample], stamp_ns: int) -> tuple[bool, int]:
    """In the order of what counts more: the last sample until then, the later the better, or the first after it."""
    place = bisect_right(samples, stamp_ns, key=stamp_of)
    return (True, samples[place - 1].stamp_ns) if place else (False, -samples[0].stamp_ns)
