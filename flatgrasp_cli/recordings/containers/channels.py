"""The part that all containers share: channels become topics, raw messages become decoded ones."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any, NamedTuple, Self

from flatgrasp_cli.recordings.containers.bounded import UNREADABLE, reason
from flatgrasp_cli.recordings.containers.definition_checks import DefinitionError
from flatgrasp_cli.recordings.containers.definitions import Channel, decoder_of
from flatgrasp_cli.recordings.containers.recording import Message, Problems, Topic


class Raw(NamedTuple):
    """A message as it lies in the file."""

    stamp_ns: int
    channel: int
    data: memoryview


class Decoders:
    """Decoders by channel, each made when its first message comes; a definition in error costs its topic only."""

    def __init__(self) -> None:
        self._made: dict[Channel, Callable[[bytes], Any] | str] = {}

    def of(self, channel: Channel) -> Callable[[bytes], Any] | str:
        """The channel's decoder, or why there is none."""
        if channel not in self._made:
            try:
                self._made[channel] = decoder_of(channel)
            except DefinitionError as error:
                self._made[channel] = str(error)
        return self._made[channel]


class ChannelRecording(ABC):
    """A recording whose file numbers its channels; subclasses say which raw messages it has."""

    container: str
    start_ns: int | None = None
    end_ns: int | None = None

    def __init__(self, problems: Problems, decoders: Decoders) -> None:
        self.problems = problems
        self.channels: dict[int, Channel] = {}
        self.topics: tuple[Topic, ...] = ()
        self._decoders = decoders
        self.on_close: Callable[[], None] = lambda: None

    @abstractmethod
    def raw_messages(self, wanted: frozenset[int], start_ns: int | None, end_ns: int | None) -> Iterator[Raw]:
        """Messages of the wanted channels, in order of time; `start_ns` and `end_ns` may be taken as hints."""

    def close(self) -> None:
        """Close the file and remove what was made for reading it."""
        self.close_file()
        self.on_close()

    @abstractmethod
    def close_file(self) -> None:
        """Close the file."""

    def messages(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[Message]:
        """Decoded messages on the named topics with start_ns ≤ stamp < end_ns, in order of log time."""
        of_channel = {(topic.name, topic.type): topic for topic in self.topics}
        wanted = {
            number: (channel, of_channel[channel.topic, channel.type])
            for number, channel in self.channels.items()
            # a damaged file may declare one while it is read, after the topics were listed
            if channel.topic in topics and (channel.topic, channel.type) in of_channel
        }
        for raw in self.raw_messages(frozenset(wanted), start_ns, end_ns):
            if (start_ns is None or raw.stamp_ns >= start_ns) and (end_ns is None or raw.stamp_ns < end_ns):
                yield from self._decoded(raw, *wanted[raw.channel])

    def list_topics(self, counts: Mapping[int, int] | None) -> None:
        """Set `topics` from the channels, one for each name and type; `counts` by channel where they are known."""
        listed: dict[tuple[str, str], Topic] = {}
        for number, channel in self.channels.items():
            key = (channel.topic, channel.type)
            earlier = listed[key].count if key in listed else 0
            count = None if counts is None else (earlier or 0) + counts.get(number, 0)
            listed[key] = Topic(channel.topic, channel.type, channel.encoding, count)
        self.topics = tuple(listed[key] for key in sorted(listed))

    def _decoded(self, raw: Raw, channel: Channel, topic: Topic) -> Iterator[Message]:
        decode = self._decoders.of(channel)
        if isinstance(decode, str):
            self.problems.add(f"messages on {topic.name} cannot be decoded: {decode}", at=0)
            return
        try:
            value = decode(bytes(raw.data))
        except UNREADABLE as error:
            self.problems.add(f"message on {topic.name} that could not be decoded ({reason(error)})")
            return
        yield Message(topic, raw.stamp_ns, value)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()
