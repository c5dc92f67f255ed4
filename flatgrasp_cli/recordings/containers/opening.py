"""Opening files and folders; what rosbag2 compressed as a whole is unpacked to a temporary file first."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers.bounded import inflate_file
from flatgrasp_cli.recordings.containers.channels import ChannelRecording, Decoders
from flatgrasp_cli.recordings.containers.recording import Problems
from flatgrasp_cli.recordings.containers.rosbag2 import FolderRecording, describe
from flatgrasp_cli.recordings.containers.sniff import ZSTD_MAGIC, first_bytes, kind_of


class _Unpacked:
    """Temporary copies of zstd files, gone when closed."""

    def __init__(self) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._copies: dict[Path, Path] = {}

    def plain(self, path: Path, name: str, problems: Problems) -> Path:
        """The file itself, or an unpacked copy, made at the first call."""
        if path in self._copies:
            return self._copies[path]
        with path.open("rb") as source:
            if source.read(len(ZSTD_MAGIC)) != ZSTD_MAGIC:
                return path
            source.seek(0)
            if self._folder is None:
                self._folder = tempfile.TemporaryDirectory(prefix="flatgrasp-")
            copy = Path(self._folder.name) / f"{len(self._copies)}-{path.stem}"
            with copy.open("wb") as target:
                fault = inflate_file(source, target, path.stat().st_size, name)
        if fault:
            problems.add(f"its zstd compression is damaged or cut short ({fault}); what comes after is lost", at=0)
        self._copies[path] = copy
        return copy

    def close(self) -> None:
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None


def open_file(path: Path, name: str, problems: Problems) -> ChannelRecording:
    """Open one file."""
    unpacked = _Unpacked()
    try:
        recording = _open(path, unpacked, name, problems, Decoders())
    except BaseException:
        unpacked.close()
        raise
    recording.on_close = unpacked.close
    return recording


def open_folder(path: Path, name: str, problems: Problems) -> FolderRecording:
    """Open a rosbag2 folder."""
    files, distro = describe(path, name, problems)
    unpacked, decoders = _Unpacked(), Decoders()
    opening = [
        partial(_open, file, unpacked, f"{name}: {file.name}", problems.within(file.name), decoders, distro)
        for file in files
    ]
    try:
        recording = FolderRecording(opening, name, problems)
    except BaseException:
        unpacked.close()
        raise
    recording.on_close = unpacked.close
    return recording


def _open(
    path: Path, unpacked: _Unpacked, name: str, problems: Problems, decoders: Decoders, distro: str = ""
) -> ChannelRecording:
    file = unpacked.plain(path, name, problems)
    kind = kind_of(file)
    if kind == "mcap":
        from flatgrasp_cli.recordings.containers.mcap import McapRecording

        return McapRecording(file, name, problems, decoders)
    if kind == "ros1":
        from flatgrasp_cli.recordings.containers.ros1_bag import Ros1Recording

        return Ros1Recording(file, name, problems, decoders)
    if kind == "sqlite":
        from flatgrasp_cli.recordings.containers.sqlite_bag import SqliteRecording

        return SqliteRecording(file, name, problems, decoders, distro)
    head = first_bytes(file)
    if not head:
        raise SourceError(f"{name}: the file is empty")
    raise SourceError(f"{name}: is no MCAP file, ROS bag or SQLite file (it begins with {head!r})")
