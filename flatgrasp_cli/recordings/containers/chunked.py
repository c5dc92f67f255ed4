"""What MCAP and ROS 1 bags share: messages lie in chunks, and a chunk's bounds in time are known before it is read."""

from __future__ import annotations

from abc import abstractmethod
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from flatgrasp_cli.recordings.containers.channels import ChannelRecording, Decoders, Raw
from flatgrasp_cli.recordings.containers.merge import in_order
from flatgrasp_cli.recordings.containers.recording import Problems

LOOSE_RUN_BYTES = 2**20
"""Messages outside of chunks are read in runs of about this size."""


@dataclass(slots=True)
class Chunk:
    """Where a chunk begins in the file; `counts` are its messages by channel, None where only reading it would tell.

    `end` is set for a run of messages that lie in the file without a chunk.
    """

    offset: int
    start_ns: int = 0
    end_ns: int = 0
    counts: Counter[int] | None = field(default_factory=Counter)
    end: int | None = None


class ChunkedRecording(ChannelRecording):
    """A file of chunks."""

    def __init__(self, path: Path, name: str, problems: Problems, decoders: Decoders) -> None:
        super().__init__(problems, decoders)
        self.chunks: list[Chunk] = []
        self.size = path.stat().st_size
        self.file = path.open("rb")
        try:
            self.take_stock(name)
        except BaseException:
            self.file.close()
            raise

    @abstractmethod
    def take_stock(self, name: str) -> None:
        """Find channels, chunks and topics; `name` is what errors call the file."""

    @abstractmethod
    def read_chunk(self, chunk: Chunk) -> Iterator[Raw]:
        """The messages of a chunk as they lie in it; channels that it declares become known; damage is a problem."""

    def close_file(self) -> None:
        """Close the file."""
        self.file.close()

    def note_loose(self, begin: int, end: int, channel: int, stamp_ns: int) -> None:
        """Take note of a message that lies outside of all chunks, as part of a run of such."""
        run = self.chunks[-1] if self.chunks else None
        if run is None or run.end != begin or begin - run.offset > LOOSE_RUN_BYTES:
            run = Chunk(begin, stamp_ns, stamp_ns)
            self.chunks.append(run)
        run.end = end
        run.start_ns, run.end_ns = min(run.start_ns, stamp_ns), max(run.end_ns, stamp_ns)
        if run.counts is not None:
            run.counts[channel] += 1

    def learn(self) -> None:
        """Read the chunks with channels that are not known yet, for only they can tell them."""
        for chunk in self.chunks:
            if chunk.counts is not None and chunk.counts.keys() <= self.channels.keys():
                continue
            chunk.counts = Counter()
            stamps = []
            for raw in self.read_chunk(chunk):
                chunk.counts[raw.channel] += 1
                stamps.append(raw.stamp_ns)
            if stamps:
                chunk.start_ns, chunk.end_ns = min(stamps), max(stamps)

    def find_bounds(self) -> None:
        """Set the time of the first and the last message from the chunks."""
        full = [chunk for chunk in self.chunks if chunk.counts is None or chunk.counts]
        if full:
            self.start_ns = min(chunk.start_ns for chunk in full)
            self.end_ns = max(chunk.end_ns for chunk in full)

    def raw_messages(self, wanted: frozenset[int], start_ns: int | None, end_ns: int | None) -> Iterator[Raw]:
        """Messages of the wanted channels in order of time; a chunk is read when its time comes."""
        sources = [
            (chunk.start_ns, partial(self._ordered, chunk, wanted))
            for chunk in self.chunks
            if (chunk.counts is None or not wanted.isdisjoint(chunk.counts))
            and (start_ns is None or chunk.end_ns >= start_ns)
            and (end_ns is None or chunk.start_ns < end_ns)
        ]
        return in_order(sources, lambda raw: raw.stamp_ns)

    def _ordered(self, chunk: Chunk, wanted: frozenset[int]) -> Iterator[Raw]:
        messages = [raw for raw in self.read_chunk(chunk) if raw.channel in wanted]
        return iter(sorted(messages, key=lambda raw: raw.stamp_ns))

    def read_at(self, offset: int, count: int) -> bytes:
        """Bytes of the file, fewer where it ends; none before its beginning, where the tail of a short one would be."""
        if not 0 <= offset < self.size:  # a damaged index may point anywhere, even where no file can seek to
            return b""
        self.file.seek(offset)
        return self.file.read(max(0, min(count, self.size - offset)))

    def truncated(self, offset: int) -> None:
        """Note that the record at `offset` is cut off by the end of the file."""
        self.problems.add(
            f"truncated at byte {offset}: the record there runs beyond the end of the file at byte {self.size}; "
            "what comes after is lost",
            at=offset,
        )
