"""Every container that recordings come in, and what is read back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from backports import zstd
from mcap.writer import CompressionType
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from flatgrasp_cli.recordings.containers import open_recording
from tests.recordings.writing import (
    BARE,
    write_mcap,
    write_ros1,
    write_rosbag2,
)

BZ2, LZ4 = Ros1Writer.CompressionFormat.BZ2, Ros1Writer.CompressionFormat.LZ4
NONE = CompressionType.NONE


def _folder(storage: StoragePlugin, mode: CompressionMode) -> Callable[[Path], Path]:
    return lambda folder: write_rosbag2(folder / "bag", storage=storage, compression=mode)


def _alone(write: Callable[[Path], Path]) -> Callable[[Path], Path]:
    """The storage file of a folder without its metadata."""

    def alone(folder: Path) -> Path:
        file = next(file for file in write(folder).iterdir() if file.name != "metadata.yaml")
        return file.rename(folder / "recorded")

    return alone


def _packed(write: Callable[[Path], Path]) -> Callable[[Path], Path]:
    def packed(folder: Path) -> Path:
        path = folder / "packed"
        path.write_bytes(zstd.compress(write(folder).read_bytes()))
        return path

    return packed


SQLITE, MCAP = StoragePlugin.SQLITE3, StoragePlugin.MCAP
CONTAINERS: dict[str, Callable[[Path], Path]] = {
    "mcap zstd": lambda folder: write_mcap(folder / "a"),
    "mcap lz4": lambda folder: write_mcap(folder / "a", compression=CompressionType.LZ4),
    "mcap none": lambda folder: write_mcap(folder / "a", compression=NONE),
    "mcap ros1": lambda folder: write_mcap(folder / "a", encoding="ros1"),
    "mcap without summary": lambda folder: write_mcap(folder / "a", **BARE),
    "mcap without chunks": lambda folder: write_mcap(folder / "a", use_chunking=False),
    "mcap shuffled": lambda folder: write_mcap(folder / "a", order=[2, 0, 1, 4, 3]),
    "mcap zstd file": _packed(lambda folder: write_mcap(folder / "a")),
    "ros1": lambda folder: write_ros1(folder / "a"),
    "ros1 bz2": lambda folder: write_ros1(folder / "a", compression=BZ2),
    "ros1 lz4": lambda folder: write_ros1(folder / "a", compression=LZ4),
    "sqlite folder": _folder(SQLITE, CompressionMode.NONE),
    "sqlite folder, zstd files": _folder(SQLITE, CompressionMode.FILE),
    "sqlite folder, zstd messages": _folder(SQLITE, CompressionMode.MESSAGE),
    "mcap folder": _folder(MCAP, CompressionMode.NONE),
    "mcap folder, zstd files": _folder(MCAP, CompressionMode.FILE),
    "mcap folder, zstd messages": _folder(MCAP, CompressionMode.MESSAGE),
    "db3 alone": _alone(_folder(SQLITE, CompressionMode.NONE)),
    "db3 alone, zstd messages": _alone(_folder(SQLITE, CompressionMode.MESSAGE)),
    "db3 alone, zstd file": _alone(_folder(SQLITE, CompressionMode.FILE)),
}


def read(path: Path, topics: set[str] | None = None, **times: int) -> tuple[list[Any], dict[str, int]]:
    """All messages and problems."""
    with open_recording(path, "rec") as recording:
        messages = list(recording.messages(topics or {topic.name for topic in recording.topics}, **times))
        return messages, dict(recording.problems.counts)
