"""MCAP files, of ROS or not: with or without chunks, index and footer, whole or cut short.

Where the summary is missing or damaged, the headers of all records are read instead, and chunks that declare channels.
Format: the MCAP format specification, mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections import Counter
from collections.abc import Iterator
from io import BytesIO
from typing import NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel as ChannelRecord
from mcap.records import ChunkIndex, Footer, Schema, Statistics

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers.bounded import MAX_CHUNK_BYTES, UNREADABLE, inflate, reason
from flatgrasp_cli.recordings.containers.channels import Raw
from flatgrasp_cli.recordings.containers.chunked import Chunk, ChunkedRecording
from flatgrasp_cli.recordings.containers.definitions import Channel, ros_type

MAGIC = b"\x89MCAP0\r\n"
FOOTER_BYTES = 9 + 20 + len(MAGIC)
CHUNK_HEAD_BYTES = 32
"""What a chunk has before the name of its compression: times, size, CRC, and that name's length."""
MAX_RECORD_BYTES = 2**26
"""Largest schema, channel or index record that is read into memory."""
_FAULTS: tuple[type[Exception], ...] = (*UNREADABLE, McapError)


class _Record(NamedTuple):
    opcode: int
    offset: int
    """Of the body."""
    length: int


class McapRecording(ChunkedRecording):
    """An open MCAP file."""

    def take_stock(self, name: str) -> None:
        """Find channels and chunks, from the summary or by reading through the file."""
        self._schemas: dict[int, Schema] = {}
        self._compressions: set[str] = set()
        if self.read_at(0, len(MAGIC)) != MAGIC:
            raise SourceError(f"{name}: is no MCAP file")
        statistics = self._read_summary()
        if statistics is None:
            self._scan()
        known = all(chunk.counts is not None for chunk in self.chunks)
        scanned = sum((chunk.counts or Counter() for chunk in self.chunks), Counter[int]())
        self.list_topics(statistics.channel_message_counts if statistics else scanned if known else None)
        self.find_bounds()
        kinds = sorted(kind or "uncompressed" for kind in self._compressions)
        self.container = f"MCAP, {' and '.join(kinds)} chunks" if kinds else "MCAP without chunks"

    def _read_summary(self) -> Statistics | None:
        """Take channels and chunks from the summary; None, and nothing taken, unless it is whole."""
        tail = self.read_at(self.size - FOOTER_BYTES, FOOTER_BYTES)
        if len(tail) < FOOTER_BYTES or tail[0] != Opcode.FOOTER or not tail.endswith(MAGIC):
            return None
        footer = Footer.read(ReadDataStream(BytesIO(tail[9:29])))
        begin, end = footer.summary_start, self.size - FOOTER_BYTES
        if not len(MAGIC) <= begin < end or end - begin > MAX_CHUNK_BYTES:
            return None
        section = self.read_at(begin, end - begin)
        if footer.summary_crc not in (0, zlib.crc32(section + tail[:25])):
            self.problems.add("the summary is damaged (its CRC is wrong); the whole file is read instead", at=begin)
            return None
        statistics: list[Statistics] = []
        indexes: list[ChunkIndex] = []
        for record in _records(memoryview(section)):
            body = section[record.offset : record.offset + record.length]
            try:
                if record.opcode == Opcode.STATISTICS:
                    statistics.append(Statistics.read(ReadDataStream(BytesIO(body))))
                elif record.opcode == Opcode.CHUNK_INDEX:
                    indexes.append(ChunkIndex.read(ReadDataStream(BytesIO(body))))
                else:
                    self._declare(record.opcode, body)
            except _FAULTS:
                break
        if not self._is_whole(statistics, indexes):
            self._schemas.clear()
            self.channels.clear()
            return None
        for index in indexes:
            held = Counter(dict.fromkeys(index.message_index_offsets, 1)) or None
            bounds = index.message_start_time, index.message_end_time
            self.chunks.append(Chunk(index.chunk_start_offset, *bounds, held))
            self._compressions.add(index.compression)
        return statistics[0]

    def _is_whole(self, statistics: list[Statistics], indexes: list[ChunkIndex]) -> bool:
        if len(statistics) != 1 or statistics[0].chunk_count != len(indexes):
            return False
        used = {channel for index in indexes for channel in index.message_index_offsets}
        used.update(statistics[0].channel_message_counts)
        return used <= self.channels.keys() and (bool(indexes) or statistics[0].message_count == 0)

    def _scan(self) -> None:
        """Find channels and chunks from the headers of all records in the file, as far as it goes."""
        offset = len(MAGIC)
        while True:
            head = self.read_at(offset, 9)
            if len(head) < 9:
                self.problems.add(
                    f"not closed by its recorder: ends without a footer at byte {offset}"
                    if not head
                    else f"truncated at byte {offset}; what comes after is lost",
                    at=offset,
                )
                break
            opcode, length = struct.unpack("<BQ", head)
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                if self.read_at(self.size - len(MAGIC), len(MAGIC)) != MAGIC:
                    self.problems.add(
                        f"truncated beyond byte {offset}, where its messages end; none is lost", at=offset
                    )
                break
            whole = offset + 9 + length <= self.size
            if opcode == 0 or Opcode.DATA_END < opcode < 0x80:
                self.problems.add(f"damaged at byte {offset}: no record begins there; what comes after is lost", offset)
                break
            self._note(_Record(opcode, offset + 9, length), whole)
            if not whole:
                self.truncated(offset)
                break
            offset += 9 + length
        self.learn()

    def _note(self, record: _Record, whole: bool) -> None:
        """Take note of one record of the data section."""
        begin = record.offset - 9
        if record.opcode == Opcode.CHUNK:
            head = self.read_at(record.offset, CHUNK_HEAD_BYTES)
            if len(head) == CHUNK_HEAD_BYTES:  # of a shorter one nothing can be read
                start_ns, end_ns = struct.unpack_from("<QQ", head)
                self.chunks.append(Chunk(begin, start_ns, end_ns, counts=None))
        elif not whole:
            return
        elif record.opcode == Opcode.MESSAGE and record.length >= 22:
            channel, _, stamp = struct.unpack("<HIQ", self.read_at(record.offset, 14))
            self.note_loose(begin, record.offset + record.length, channel, stamp)
        elif record.opcode == Opcode.MESSAGE_INDEX and self.chunks and record.length >= 6:
            channel, size = struct.unpack("<HI", self.read_at(record.offset, 6))
            counts = self.chunks[-1].counts = self.chunks[-1].counts or Counter()
            counts[channel] += size // 16
        elif record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL) and record.length <= MAX_RECORD_BYTES:
            try:
                self._declare(record.opcode, self.read_at(record.offset, record.length))
            except _FAULTS as error:
                self.problems.add(f"record at byte {begin} that cannot be read ({reason(error)})", at=begin)

    def _declare(self, opcode: int, body: bytes) -> None:
        """Take a schema or a channel; the first of an id stays."""
        stream = ReadDataStream(BytesIO(body))
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            self._schemas.setdefault(schema.id, schema)
        elif opcode == Opcode.CHANNEL:
            record = ChannelRecord.read(stream)
            self.channels.setdefault(record.id, self._channel(record))

    def _channel(self, record: ChannelRecord) -> Channel:
        schema = self._schemas.get(record.schema_id)
        if schema is None:
            return Channel(record.topic, "", record.message_encoding)
        is_ros = record.message_encoding in ("cdr", "ros1")
        kind = ros_type(schema.name) if is_ros else schema.name
        return Channel(
            topic=record.topic,
            type=kind,
            encoding=record.message_encoding,
            schema_encoding=schema.encoding,
            schema=schema.data,
        )

    def read_chunk(self, chunk: Chunk) -> Iterator[Raw]:
        """The messages of a chunk as they lie in it."""
        data = self._loose(chunk) if chunk.end is not None else self._content(chunk.offset)
        end = 0
        for record in _records(data):
            body = data[record.offset : record.offset + record.length]
            end = record.offset + record.length
            if record.opcode == Opcode.MESSAGE and record.length >= 22:
                channel, _, stamp = struct.unpack_from("<HIQ", body)
                if channel in self.channels:
                    yield Raw(stamp, channel, body[22:])
                else:
                    self.problems.add(f"message on channel {channel}, which is not declared")
            elif record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                try:
                    self._declare(record.opcode, bytes(body))
                except _FAULTS as error:
                    self.problems.add(f"chunk at byte {chunk.offset} has a damaged record ({reason(error)})", at=end)
        if end < len(data) and not self._is_cut(chunk.offset):
            self.problems.add(f"chunk at byte {chunk.offset} is damaged at byte {end} of its content", at=chunk.offset)

    def _loose(self, chunk: Chunk) -> memoryview:
        return memoryview(self.read_at(chunk.offset, (chunk.end or 0) - chunk.offset))

    def _is_cut(self, offset: int) -> bool:
        head = self.read_at(offset, 9)
        return len(head) < 9 or offset + 9 + int.from_bytes(head[1:], "little") > self.size

    def _content(self, offset: int) -> memoryview:
        """The records of a chunk; nothing, and a problem, if it is corrupt; the beginning if the file is cut short."""
        head = self.read_at(offset, 9 + CHUNK_HEAD_BYTES)
        fault, content = "it is not there", memoryview(b"")
        if len(head) == 9 + CHUNK_HEAD_BYTES and head[0] == Opcode.CHUNK:
            length, _, _, size, crc, words = struct.unpack_from("<QQQQII", head, 1)
            kind = self.read_at(offset + 41, words).decode(errors="replace") if words < 100 else "?"
            data = offset + 41 + words + 8
            stored = int.from_bytes(self.read_at(data - 8, 8), "little")
            cut = self._is_cut(offset)
            if data <= self.size:  # else its name may be cut short, too
                self._compressions.add(kind)
            if min(size, stored) > MAX_CHUNK_BYTES or (stored > length and not cut):
                fault = f"declares {max(size, stored)} bytes"
            else:
                content, fault = inflate(kind, self.read_at(data, stored), size)
                if cut:
                    return content
                if not fault and crc not in (0, zlib.crc32(content)):
                    fault = "its CRC is wrong"
        if fault:
            self.problems.add(f"chunk at byte {offset} skipped: {fault}", at=offset)
            return memoryview(b"")
        return content


def _records(data: memoryview) -> Iterator[_Record]:
    """The records that lie whole in `data`, up to a byte that begins none."""
    offset = 0
    while offset + 9 <= len(data):
        opcode, length = struct.unpack_from("<BQ", data, offset)
        if opcode == 0 or offset + 9 + length > len(data):  # 0 is no opcode: a gigabyte of them is no data
            return
        yield _Record(opcode, offset + 9, length)
        offset += 9 + length
