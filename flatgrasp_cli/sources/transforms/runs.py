"""The samples of one link that moves, in order of their stamps, for as long as these do not jump back.

After a simulator's reset a link has two runs, whose stamps say the same and whose poses do not; as tf2 forgets what was
before when time jumps back, a frame gets the pose of its own run. Publishers that are not equally late have runs side
by side.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product

from flatgrasp_cli.sources.transforms.samples import Sample, between
from flatgrasp_cli.sources.transforms.turns import two_by_turns

TOLERANCE_NS = 100_000_000
"""A transform counts as still (or already) true for so long after (before) its only neighbour in time; and stamps that
go back by less are out of order: no other run begins, and none goes on beside another."""

NEAR = 15
"""Samples before a time, and after it, in which two publishers are looked for; one may send ten times as often."""
STEADY_SHARE = 0.5
"""By what share of it the way between two publishers changes at most from one stamp to the next; noise makes it another
one each time."""
LONGEST_WAY = 1.5
"""A sample is on the way between two others, sensors' noise included, if that makes it longer by at most so much."""


@dataclass(frozen=True, slots=True)
class When:
    """A time: `stamp_ns` as the sensors' messages are stamped, `logged_ns` as they were recorded.

    Transforms that move hold at their stamps; static ones from when they were sent on, whatever their stamps say.
    """

    stamp_ns: int
    logged_ns: int


@dataclass(slots=True, eq=False)
class Run:
    """Samples in order of their stamps, of one parent, at least one.

    The first was stamped `back_ns` before the newest one of the run before; `begun_ns` and `ended_ns` are when the
    first and the last were logged.
    """

    samples: list[Sample]
    begun_ns: int
    ended_ns: int
    back_ns: int
    rivals: dict[int, Sample] = field(default_factory=dict)
    """By stamp: of further samples with the stamp of one of `samples` the one that is the least like that."""

    def add(self, sample: Sample) -> None:
        """Take a sample. As in tf2 the first of a stamp counts; of the others one is kept that contradicts it."""
        self.begun_ns = min(self.begun_ns, sample.logged_ns)
        self.ended_ns = max(self.ended_ns, sample.logged_ns)
        place = bisect_left(self.samples, sample.stamp_ns, key=stamp_of)
        if place == len(self.samples) or self.samples[place].stamp_ns != sample.stamp_ns:
            self.samples.insert(place, sample)
            return
        first, rival = self.samples[place], self.rivals.get(sample.stamp_ns)
        if not first.same_as(sample) and (rival is None or first.apart(rival) < first.apart(sample)):
            self.rivals[sample.stamp_ns] = sample

    def forget_before(self, when: When) -> None:
        """Drop what no question about that time or a later one needs: all but the last sample before it."""
        count = max(0, bisect_right(self.samples, when.stamp_ns, key=stamp_of) - 1)
        while count and self.samples[count - 1].logged_ns > when.logged_ns:  # read ahead, beyond a jump back
            count -= 1
        for sample in self.samples[:count]:
            self.rivals.pop(sample.stamp_ns, None)
        del self.samples[:count]

    def at(self, stamp_ns: int, tolerance_ns: int) -> list[Sample]:
        """The pose at a time, between two samples or within the tolerance of one; and those that contradict it."""
        samples = self.samples
        after = bisect_left(samples, stamp_ns, key=stamp_of)
        held = samples[min(after, len(samples) - 1)]
        near = range(max(0, after - NEAR), min(after + NEAR, len(samples)))
        rivals = self.rivals if self._has_two(near) else {}
        if 0 < after < len(samples) and held.stamp_ns != stamp_ns:
            # whichever publisher was the first at each of the two stamps
            pairs = product(_with_rival(samples[after - 1], rivals), _with_rival(held, rivals))
            poses = [between(first, second, stamp_ns) for first, second in pairs]
        elif abs(held.stamp_ns - stamp_ns) <= tolerance_ns:
            poses = _with_rival(held, rivals)
        else:
            return []
        return [*poses, *(two_by_turns(samples[near.start : near.stop]) or ())]

    def _has_two(self, near: range) -> bool:
        """Whether samples that share a stamp are of two publishers, going by most of those at some places.

        Where a simulator's clock ticks slowly, one publisher stamps several samples of its way with one time.
        """
        shared = [place for place in near if self.samples[place].stamp_ns in self.rivals]
        return 2 * sum(self._goes_back(place) for place in shared) > len(shared)

    def _goes_back(self, place: int) -> bool:
        """Whether the rival of a sample is not on the way to those of the next stamp."""
        sample, rival = _with_rival(self.samples[place], self.rivals)
        if place + 1 == len(self.samples):  # only those before it tell
            return place == 0 or self.samples[place - 1].stamp_ns not in self.rivals or self._goes_back(place - 1)
        following = _with_rival(self.samples[place + 1], self.rivals)
        if len(following) > 1 and not _as_far_apart((sample, rival), (following[0], following[1])):
            return False  # noise: two publishers stay as far from each other
        return any(sample.apart(rival) + rival.apart(after) > LONGEST_WAY * sample.apart(after) for after in following)

    def lateness_ns(self, stamp_ns: int) -> int:
        """How late the sample was that is the nearest to a time."""
        return self.nearest(stamp_ns).lateness_ns

    def nearest(self, stamp_ns: int) -> Sample:
        """The sample that is nearest in time."""
        after = bisect_left(self.samples, stamp_ns, key=stamp_of)
        return min(self.samples[max(0, after - 1) : after + 1], key=lambda sample: abs(sample.stamp_ns - stamp_ns))

    def is_beside(self, other: Run) -> bool:
        """Whether both went on at the same time, as those of two publishers do; not one within a gap of the other."""
        if min(self.ended_ns, other.ended_ns) - max(self.begun_ns, other.begun_ns) <= TOLERANCE_NS:
            return False
        return self._has_logged_within(other) and other._has_logged_within(self)

    def spans(self, stamp_ns: int) -> bool:
        """Whether a time lies between two samples: else a pose is only held on to."""
        return self.samples[0].stamp_ns <= stamp_ns <= self.samples[-1].stamp_ns

    def _has_logged_within(self, other: Run) -> bool:
        return any(other.begun_ns <= sample.logged_ns <= other.ended_ns for sample in self.samples)


def _as_far_apart(pair: tuple[Sample, Sample], later: tuple[Sample, Sample]) -> bool:
    """Whether two publishers, in whichever order, are about as far from each other, and the same way, as before."""
    was, now = (two.translation - one.translation for one, two in (pair, later))
    shift = min(abs(was - now).max(), abs(was + now).max())
    apart_before, apart_after = (one.apart(two) for one, two in (pair, later))
    return bool(
        shift <= STEADY_SHARE * abs(was).max() and abs(apart_before - apart_after) <= STEADY_SHARE * apart_before
    )


def _with_rival(sample: Sample, rivals: Mapping[int, Sample]) -> list[Sample]:
    rival = rivals.get(sample.stamp_ns)
    return [sample] if rival is None else [sample, rival]


def add_to(runs: list[Run], sample: Sample) -> None:
    """Take a sample into a new run if it would go back in all of them, else into the one whose last was as late."""
    back_ns = {run: run.samples[-1].stamp_ns - sample.stamp_ns for run in runs}
    fitting = [run for run in runs if back_ns[run] <= TOLERANCE_NS]
    if fitting:
        min(fitting, key=lambda run: abs(run.samples[-1].lateness_ns - sample.lateness_ns)).add(sample)
    else:
        runs.append(Run([sample], sample.logged_ns, sample.logged_ns, min(back_ns.values(), default=0)))


def poses_at(runs: list[Run], when: When, tolerance_ns: int) -> tuple[Run, list[Sample], int] | None:
    """The run that counts at a time, and its poses then; more than one contradict each other.

    It is the one whose samples were logged nearest to the time. The number is by how much stamps go back, if there is
    another pose from before or after that; else 0. None if there is no pose at all.
    """
    near = sorted(runs, key=lambda run: abs(run.lateness_ns(when.stamp_ns) - (when.logged_ns - when.stamp_ns)))
    found = [(run, poses) for run in near if (poses := run.at(when.stamp_ns, tolerance_ns))]
    if not found:
        return None
    (chosen, poses), *others = found
    back_ns = 0 if near[0] is chosen or near[0].is_beside(chosen) else _back_ns(near[0], chosen)
    for run, further in others:
        if chosen.spans(when.stamp_ns) and not run.spans(when.stamp_ns):
            continue  # what is only held on to is no witness against what lies between two samples
        if run.is_beside(chosen):
            poses = [*poses, *further]
        elif not further[0].same_as(poses[0]):
            back_ns = back_ns or _back_ns(run, chosen)
    return chosen, poses, back_ns


def _back_ns(one: Run, two: Run) -> int:
    """By how much stamps go back from the earlier of two runs to the later."""
    return max(one, two, key=lambda run: run.begun_ns).back_ns


def forget(runs: list[Run], when: When) -> None:
    """Drop what no question about that time or a later one needs; one run stays."""
    latest = max(runs, key=lambda run: run.ended_ns)
    runs[:] = [run for run in runs if run is latest or run.ended_ns >= when.logged_ns]
    for run in runs:
        run.forget_before(when)


def stamp_of(sample: Sample) -> int:
    """What samples are sorted by."""
    return sample.stamp_ns
