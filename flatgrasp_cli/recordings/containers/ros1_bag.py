"""ROS 1 bags, format 2.0: closed or not, whole or cut short, chunks in any order.

rosbags reads only bags that were closed, so the headers of all records are read here instead; it does so too, to learn
the index. Format: wiki.ros.org/Bags/Format/2.0.
"""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers.bounded import MAX_CHUNK_BYTES, inflate, inflate_lz4_unchecked
from flatgrasp_cli.recordings.containers.channels import Raw
from flatgrasp_cli.recordings.containers.chunked import Chunk, ChunkedRecording
from flatgrasp_cli.recordings.containers.definitions import Channel, ros_type

MAGIC = b"#ROSBAG V2.0\n"
MAX_HEADER_BYTES = 2**24
MESSAGE, BAG_HEADER, INDEX, CHUNK, CHUNK_INFO, CONNECTION = range(2, 8)


class _Record(NamedTuple):
    op: int
    header: dict[str, bytes]
    offset: int
    """Of the data."""
    length: int


class Ros1Recording(ChunkedRecording):
    """An open ROS 1 bag."""

    def take_stock(self, name: str) -> None:
        """Find connections and chunks by reading through the file."""
        magic = self.read_at(0, len(MAGIC))
        if magic != MAGIC and MAGIC.startswith(magic):
            raise SourceError(f"{name}: is a ROS bag that is truncated in its first line, at byte {self.size}")
        if magic != MAGIC:
            version = magic.decode(errors="replace").strip()
            raise SourceError(f"{name}: is a ROS bag of the format {version!r}, not 2.0; convert it with `rosbag fix`")
        self._compressions: set[str] = set()
        self._index = 0
        stopped = self._scan(len(MAGIC), name)
        if stopped < self._index < self.size:
            # the index at the end still tells the connections and the chunks beyond the damage
            self._scan(self._index, name)
        elif stopped == self.size < self._index:  # cut between two records, which leaves no other trace
            self.problems.add(
                f"truncated at byte {stopped}, before its index at byte {self._index}; what comes after is lost",
                stopped,
            )
        elif self.size == len(MAGIC):
            self.problems.add(f"truncated at byte {self.size}, before its first record", self.size)
        self.learn()
        self.list_topics(sum((chunk.counts or Counter() for chunk in self.chunks), Counter[int]()))
        self.find_bounds()
        kinds = sorted(self._compressions - {"none"})
        self.container = f"ROS 1 bag, {' and '.join(kinds)} chunks" if kinds else "ROS 1 bag"

    def _scan(self, offset: int, name: str) -> int:
        """Take note of the records from `offset` on; returns where the end or damage stops it."""
        while offset < self.size:
            record = self._record(offset)
            if record is None:
                self.problems.add(f"truncated or damaged at byte {offset}; what comes after is lost", at=offset)
                break
            self._note(record, offset, name)
            end = record.offset + record.length
            if end > self.size:
                self.truncated(offset)
                break
            offset = end
        return offset

    def _record(self, offset: int) -> _Record | None:
        """The record at `offset`; None if its header is no header."""
        length = int.from_bytes(self.read_at(offset, 4), "little")
        if not 0 < length <= MAX_HEADER_BYTES or offset + 8 + length > self.size:
            return None
        return _record(memoryview(self.read_at(offset, 8 + length)), offset)

    def _note(self, record: _Record, offset: int, name: str) -> None:
        """Take note of one record outside of the chunks; headers that lack a field are passed over."""
        header = record.header
        if record.op == BAG_HEADER:
            self._index = int.from_bytes(header.get("index_pos", b""), "little")
            if header.get("encryptor"):
                raise SourceError(f"{name}: is encrypted; decrypt it with `rosbag decrypt`")
            if self._index == 0:
                self.problems.add("not closed by its recorder, or truncated: it has no index", at=0)
        elif record.op == CHUNK:
            self._compressions.add(header.get("compression", b"").decode(errors="replace")[:20])
            self.chunks.append(Chunk(offset, counts=None))
        elif record.op == MESSAGE and len(header.get("time", b"")) == 8:
            # a recorder that was killed leaves its last chunk open, with a declared size of 0
            channel = int.from_bytes(header.get("conn", b""), "little")
            self.note_loose(offset, min(record.offset + record.length, self.size), channel, _time(header))
        elif record.op == INDEX and self.chunks:
            self._note_index(record)
        elif record.op == CONNECTION:
            self._declare(header, self.read_at(record.offset, record.length))
        elif record.op == CHUNK_INFO and "chunk_pos" in header:
            position = int.from_bytes(header["chunk_pos"], "little")
            if self.chunks and position > self.chunks[-1].offset:
                self.chunks.append(Chunk(position, counts=None))

    def _note_index(self, record: _Record) -> None:
        """Counts and bounds of the chunk before: the index has 12 bytes a message."""
        chunk = self.chunks[-1]
        entries = self.read_at(record.offset, record.length)
        entries = entries[: len(entries) // 12 * 12]
        if not entries or len(record.header.get("conn", b"")) != 4:
            return
        stamps = [sec * 10**9 + nsec for sec, nsec, _ in struct.iter_unpack("<III", entries)]
        known = chunk.counts is not None
        counts = chunk.counts = chunk.counts or Counter()
        counts[int.from_bytes(record.header["conn"], "little")] += len(stamps)
        chunk.start_ns = min(stamps) if not known else min(chunk.start_ns, *stamps)
        chunk.end_ns = max(chunk.end_ns, *stamps)

    def _declare(self, header: dict[str, bytes], data: bytes) -> None:
        """Take a connection; the first of an id stays."""
        fields = _fields(memoryview(data))
        if fields is None or "type" not in fields or "topic" not in header or "conn" not in header:
            return
        topic, kind = (text.decode(errors="replace") for text in (header["topic"], fields["type"]))
        channel = Channel(
            topic=topic,
            type=ros_type(kind),
            encoding="ros1",
            schema_encoding="ros1msg",
            schema=fields.get("message_definition", b""),
        )
        self.channels.setdefault(int.from_bytes(header["conn"], "little"), channel)

    def read_chunk(self, chunk: Chunk) -> Iterator[Raw]:
        """The messages of a chunk as they lie in it."""
        if chunk.end is not None:
            loose = memoryview(self.read_at(chunk.offset, chunk.end - chunk.offset))
            yield from self._messages(loose, chunk.offset, cut=chunk.end >= self.size)
            return
        record = self._record(chunk.offset)
        if record is None or record.op != CHUNK:
            self.problems.add(f"chunk at byte {chunk.offset} skipped: it is not there", at=chunk.offset)
            return
        cut = record.offset + record.length > self.size
        kind = record.header.get("compression", b"").decode(errors="replace")
        size = int.from_bytes(record.header.get("size", b""), "little")
        if max(size, record.length if kind == "none" else 0) > MAX_CHUNK_BYTES:
            data, fault = memoryview(b""), f"declares {size} bytes"
        else:
            packed = self.read_at(record.offset, record.length)
            data, fault = inflate(kind, packed, size)
            if fault and kind == "lz4" and (whole := inflate_lz4_unchecked(packed, size)) is not None:
                self.problems.add(f"chunk at byte {chunk.offset} used, though its checksum is wrong", at=chunk.offset)
                data, fault = whole, ""
        if fault and not cut:
            self.problems.add(f"chunk at byte {chunk.offset} skipped: {fault}", at=chunk.offset)
            return
        yield from self._messages(data, chunk.offset, cut)

    def _messages(self, data: memoryview, chunk: int, cut: bool) -> Iterator[Raw]:
        offset = 0
        while offset < len(data):
            record = _record(data[offset:], offset)
            if record is None or record.offset + record.length > len(data):
                if not cut:
                    self.problems.add(f"chunk at byte {chunk} is damaged at byte {offset} of its content", at=chunk)
                return
            offset = record.offset + record.length
            body = data[record.offset : offset]
            if record.op == CONNECTION:
                self._declare(record.header, bytes(body))
            elif record.op == MESSAGE and len(record.header.get("time", b"")) == 8:
                connection = int.from_bytes(record.header.get("conn", b""), "little")
                if connection in self.channels:
                    yield Raw(_time(record.header), connection, body)
                else:
                    self.problems.add(f"message on connection {connection}, which is not declared")


def _record(data: memoryview, offset: int) -> _Record | None:
    """The record that begins at the first byte of `data`, which lies at `offset`; None if it has no whole header."""
    if len(data) < 8:
        return None
    (length,) = struct.unpack_from("<I", data)
    if not 0 < length <= min(MAX_HEADER_BYTES, len(data) - 8):
        return None
    header = _fields(data[4 : 4 + length])
    if header is None or len(header.get("op", b"")) != 1:
        return None
    (size,) = struct.unpack_from("<I", data, 4 + length)
    return _Record(header["op"][0], header, offset + 8 + length, size)


def _time(header: dict[str, bytes]) -> int:
    sec, nsec = struct.unpack("<II", header["time"])
    return int(sec * 10**9 + nsec)


def _fields(data: memoryview) -> dict[str, bytes] | None:
    """The name=value fields of a header; None if it is no header."""
    fields: dict[str, bytes] = {}
    offset = 0
    while offset < len(data):
        if offset + 4 > len(data):
            return None
        (size,) = struct.unpack_from("<I", data, offset)
        name, equals, value = bytes(data[offset + 4 : offset + 4 + size]).partition(b"=")
        if offset + 4 + size > len(data) or not equals:
            return None
        fields[name.decode(errors="replace")] = value
        offset += 4 + size
    return fields
