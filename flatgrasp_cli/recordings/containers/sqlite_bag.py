"""The SQLite files (.db3) of rosbag2.

They are read with the sqlite3 module, for rosbags refuses a whole file for one topic that it dislikes.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers.bounded import UNREADABLE, reason
from flatgrasp_cli.recordings.containers.channels import ChannelRecording, Decoders, Raw
from flatgrasp_cli.recordings.containers.definitions import Channel, ros_type
from flatgrasp_cli.recordings.containers.recording import Problems

LOWEST, HIGHEST = -(2**63), 2**63 - 1
_FAULTS: tuple[type[Exception], ...] = (*UNREADABLE, sqlite3.Error)


class SqliteRecording(ChannelRecording):
    """An open .db3 file of rosbag2; `distro` is the ROS 2 distribution, for files without message definitions."""

    container = "rosbag2 SQLite"

    def __init__(self, path: Path, name: str, problems: Problems, decoders: Decoders, distro: str = "") -> None:
        super().__init__(problems, decoders)
        self._database = _connect(path)
        try:
            self._check_tables(name)
            self._read_channels(distro)
            self._read_statistics()
        except BaseException as error:
            self._database.close()
            if isinstance(error, _FAULTS):
                raise SourceError(f"{name}: the SQLite file is damaged: {reason(error)}") from error
            raise

    def _check_tables(self, name: str) -> None:
        if missing := {"topics", "messages"} - self._tables():
            raise SourceError(f"{name}: is an SQLite file but no recording: it has no table {min(missing)}")

    def _rows(self, query: str, *values: Any) -> list[tuple[Any, ...]]:
        return self._database.execute(query, values).fetchall()

    def _tables(self) -> set[str]:
        return {name for (name,) in self._rows("SELECT name FROM sqlite_master WHERE type = 'table'")}

    def _columns(self, table: str) -> set[str]:
        return {row[1] for row in self._rows(f"PRAGMA table_info({table})")}

    def _read_channels(self, distro: str) -> None:
        if "schema" in self._tables() and "ros_distro" in self._columns("schema"):
            distro = distro or next((str(row[0]) for row in self._rows("SELECT ros_distro FROM schema")), "")
        definitions: dict[str, tuple[str, bytes]] = {}
        if "message_definitions" in self._tables():
            query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
            definitions = {str(kind): (str(form), _bytes(text)) for kind, form, text in self._rows(query)}
        for number, topic, kind, encoding in self._rows("SELECT id, name, type, serialization_format FROM topics"):
            form, text = definitions.get(str(kind), ("", b""))
            self.channels[number] = Channel(str(topic), ros_type(str(kind)), str(encoding), form, text, distro)

    def _read_statistics(self) -> None:
        try:
            counts = dict(self._rows("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id"))
            ((self.start_ns, self.end_ns),) = self._rows("SELECT MIN(timestamp), MAX(timestamp) FROM messages")
        except _FAULTS as error:
            self.problems.add(f"the SQLite file is damaged ({reason(error)}); messages may be lost", at=0)
            counts = None
        if not all(isinstance(stamp, int) for stamp in (self.start_ns, self.end_ns)):
            self.start_ns = self.end_ns = None
        self.list_topics(counts)

    def raw_messages(self, wanted: frozenset[int], start_ns: int | None, end_ns: int | None) -> Iterator[Raw]:
        """Messages of the wanted channels in order of time: the order first, then each message by its row."""
        # SQLite knows no time beyond 64 bits, though a person may ask for the year 9999
        low = LOWEST if start_ns is None else min(max(start_ns, LOWEST), HIGHEST)
        high = HIGHEST if end_ns is None else min(max(end_ns, LOWEST), HIGHEST)
        marks = ", ".join("?" * len(wanted))
        query = (
            f"SELECT rowid, topic_id, timestamp FROM messages WHERE topic_id IN ({marks})"  # noqa: S608 question marks
            " AND timestamp >= ? AND timestamp <= ? ORDER BY timestamp, rowid"
        )
        try:
            for row, channel, stamp in self._database.execute(query, (*wanted, low, high)):
                yield from self._message(row, channel, stamp)
        except _FAULTS as error:
            self.problems.add(f"the SQLite file is damaged ({reason(error)}); messages are lost", at=1)

    def _message(self, row: int, channel: int, stamp: Any) -> Iterator[Raw]:
        try:
            ((data,),) = self._rows("SELECT data FROM messages WHERE rowid = ?", row)
        except _FAULTS as error:
            topic = self.channels[channel].topic
            self.problems.add(f"message on {topic} that could not be read ({reason(error)})", at=row)
            return
        if isinstance(data, bytes) and isinstance(stamp, int):
            yield Raw(stamp, channel, memoryview(data))
        else:
            self.problems.add(f"message on {self.channels[channel].topic} without a time or data", at=row)

    def close_file(self) -> None:
        """Close the database."""
        self._database.close()


def _bytes(text: Any) -> bytes:
    return text if isinstance(text, bytes) else str(text).encode(errors="replace")


def _connect(path: Path) -> sqlite3.Connection:
    """Open for reading only; with the journal of a recorder that was stopped, if there is one."""
    journal = path.with_name(path.name + "-wal").exists()
    uri = f"{path.resolve().as_uri()}?mode=ro{'' if journal else '&immutable=1'}"
    database = sqlite3.connect(uri, uri=True, isolation_level=None)
    database.text_factory = lambda text: text.decode(errors="replace")
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, min(path.stat().st_size + 1000, 10**9))
    database.execute("PRAGMA trusted_schema = OFF")
    return database
