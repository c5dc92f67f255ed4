"""What every recording offers, whichever container it is: its topics, and their decoded messages in order of time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, Self

from flatgrasp_cli.errors import SourceError

MAX_KINDS = 200
"""Kinds of problems told apart; a file of nothing but damage must not fill the memory with words about it."""


def printable(text: str) -> str:
    """Text of a file with what a terminal would obey, or a line would break at, written as an escape."""
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)


@dataclass(frozen=True, slots=True)
class Topic:
    """One topic: `type` as ROS 2 writes it ("sensor_msgs/msg/PointCloud2") or as the schema is named.

    `encoding` is cdr, ros1, json, protobuf, …; `count` the number of messages, None when only reading all would tell.
    """

    name: str
    type: str
    encoding: str
    count: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Message:
    """One decoded message: `value` has the message definition's fields as attributes; `stamp_ns` is the log time."""

    topic: Topic
    stamp_ns: int
    value: Any


@dataclass(slots=True)
class Problems:
    """What could not be read, counted by kind, while the rest was: each kind in words, for a warning at the end.

    `strict` makes the first problem a SourceError that begins with `name`.
    """

    counts: Counter[str] = field(default_factory=Counter)
    name: str = ""
    strict: bool = False
    place: str = ""
    """Stands before each problem: the file of the recording, where it has several."""
    seen: set[tuple[str, int]] = field(default_factory=set)

    def add(self, what: str, at: int | None = None) -> None:
        """Count one more of `what`, e.g. "message on /points that could not be decoded (too short)".

        With `at`, the place of the fault in the file, the same fault met again is not counted again.
        """
        what = printable(self.place + what)
        if self.strict:
            raise SourceError(f"{self.name}: {what}")
        if len(self.counts) >= MAX_KINDS and what not in self.counts:
            what = "further problem"
        if at is not None:
            if (what, at) in self.seen:
                return
            self.seen.add((what, at))
        self.counts[what] += 1

    def taken(self) -> str:
        """The last kind that was met, as it is the nearest to a cause, or ""; an error says it, so no warning need."""
        last = next(reversed(self.counts), "")
        self.counts.pop(last, None)
        return last

    def reset(self, earlier: Problems) -> None:
        """Forget what was met since `earlier`, a copy: it is read once more, and must not be counted twice."""
        self.counts.clear()
        self.counts.update(earlier.counts)
        self.seen.clear()
        self.seen.update(earlier.seen)

    def copy(self) -> Problems:
        """The account as it is now."""
        return replace(self, counts=self.counts.copy(), seen=self.seen.copy())

    def within(self, place: str) -> Problems:
        """The same account, for one file of the recording."""
        return replace(self, place=f"{place}: ")


class Recording(Protocol):
    """An open recording; a context manager that closes its files."""

    topics: tuple[Topic, ...]
    start_ns: int | None
    end_ns: int | None
    """Stamps of the first and the last message, as far as the container tells; None without messages."""
    container: str
    """In words for people, e.g. "MCAP, zstd chunks" or "ROS 1 bag"."""
    problems: Problems

    def messages(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[Message]:
        """Decoded messages on the named topics with start_ns ≤ stamp < end_ns, in order of log time.

        One at a time: memory holds the chunks that overlap in time and a message, however long the recording is.
        """
        ...

    def close(self) -> None:
        """Close the files."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(self, *exc: object) -> None: ...
