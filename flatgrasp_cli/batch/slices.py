"""Long recordings in ranges of time, so that one big bag uses every core, too."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from flatgrasp_cli.batch.inputs import Input
from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers import is_recording, open_recording
from flatgrasp_cli.sources.remote import is_url
from flatgrasp_cli.sources.selection import Every, Moment, Selection
from flatgrasp_cli.sources.topics import choose_topic

FRAMES = 10
"""Frames of a slice, on average: about a second of work, which is what an interruption costs at most."""


@dataclass(frozen=True, slots=True)
class Slice:
    """One of `count` ranges of time of an input; both ends None: all of it."""

    input: Input
    index: int = 0
    count: int = 1
    start_ns: int | None = None
    end_ns: int | None = None

    def selection(self, wanted: Selection) -> Selection:
        """What is wanted of this slice."""
        if self.start_ns is None or self.end_ns is None:
            return wanted
        start, end = Moment(self.start_ns, absolute=True), Moment(self.end_ns, absolute=True)
        return replace(wanted, start=start, end=end)


def slices_of(item: Input, wanted: Selection) -> list[Slice]:
    """The slices of an input, in order; only one where frames are counted, or where no index tells what lies where.

    An input that cannot be read is one slice: reading it will tell.
    """
    whole = [Slice(item)]
    counted = wanted.every != Every() or wanted.count is not None or wanted.at is not None
    if counted or is_url(item.source) or not is_recording(Path(item.source)):
        return whole
    try:
        with open_recording(Path(item.source), item.source) as recording:
            topic = choose_topic(recording, wanted.topic, item.source)
            first_ns, last_ns = recording.start_ns, recording.end_ns
    except SourceError:
        return whole
    if topic.count is None or first_ns is None or last_ns is None:
        return whole
    start_ns = wanted.start.after(first_ns) if wanted.start else first_ns
    end_ns = wanted.end.after(first_ns) if wanted.end else last_ns + 1
    start_ns, end_ns = max(start_ns, first_ns), min(end_ns, last_ns + 1)
    span_ns = end_ns - start_ns
    frames = topic.count * span_ns // (last_ns + 1 - first_ns)
    count = max(1, -(-frames // FRAMES))
    if span_ns < count or count == 1:
        return whole
    ends = [start_ns + span_ns * k // count for k in range(count + 1)]
    return [Slice(item, k, count, ends[k], ends[k + 1]) for k in range(count)]
