"""Recordings in every container: MCAP, ROS 1 bags, rosbag2 folders and their files, told apart by content."""

from __future__ import annotations

from pathlib import Path

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers.recording import Message, Problems, Recording, Topic, printable
from flatgrasp_cli.recordings.containers.sniff import kind_of

__all__ = ["Message", "Problems", "Recording", "Topic", "is_recording", "open_recording", "printable"]


def is_recording(path: Path) -> bool:
    """Whether a file or folder is a recording, judged by its content; False for what cannot be read."""
    try:
        if path.is_dir():
            from flatgrasp_cli.recordings.containers.rosbag2 import is_folder

            return is_folder(path)
        return kind_of(path) != ""
    except OSError:
        return False


def open_recording(path: Path, name: str, *, strict: bool = False) -> Recording:
    """Open a recording; use it as a context manager.

    Parameters
    ----------
    path
        An MCAP file, a ROS 1 bag, a rosbag2 folder or one of its files, compressed with zstd or not.
    name
        What errors call it.
    strict
        Makes the first problem an error, instead of reading on and counting it.

    Raises
    ------
    SourceError
        If it cannot be read at all; with `strict`, also later, when a problem is met.
    """
    from flatgrasp_cli.recordings.containers.opening import open_file, open_folder

    problems = Problems(name=name, strict=strict)
    try:
        if path.is_dir():
            return open_folder(path, name, problems)
        return open_file(path, name, problems)
    except OSError as error:
        raise SourceError(f"{name}: cannot be read: {error.strerror or error}") from error
