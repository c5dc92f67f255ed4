"""The door to all readers: says by content, not by name, what a source is."""

from __future__ import annotations

import math
import os
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, BinaryIO

from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.source_names import STDIN, name_of
from flatgrasp_cli.sources.remote import copy_url, is_url
from flatgrasp_cli.sources.selection import EVERYTHING, Selection

COPIED_AT_ONCE = 1 << 20
MOST_SPOOLED = 4 << 30
"""Bytes of a pipe that are kept on disk: 4 GiB; one that never ends must not fill it."""


def read_clouds(
    source: str | os.PathLike[str], scale: float = 1.0, selection: Selection = EVERYTHING
) -> Iterator[Cloud]:
    """Yield the clouds of a file, a recording, or a folder of depth images: a path, a URL, or "-" for standard input.

    Files are PCD, PLY, meshes (STL, OBJ, OFF, glTF), whose surface is sampled, and depth images (PNG, TIFF, .npy). A
    recording is an MCAP file, a ROS 1 bag, or a rosbag2 folder or file. One cloud at a time is in memory.

    Parameters
    ----------
    source
        A path, a URL that fsspec knows, or "-".
    scale
        Metres in one unit of the source: 0.001 for one in millimetres.
    selection
        Which topic and frames of a recording, of what camera depth images are, and in which frame clouds are wanted.

    Raises
    ------
    SourceError
        If the source is missing, is no cloud, or contradicts its own header.
    UsageError
        If a depth image is given without its camera's intrinsics, or only a recording could say where a frame is.
    ValueError
        If the scale is no positive number.
    """
    given = os.fspath(source)
    with on_disk(given) as path:
        yield from _clouds(path, name_of(given), scale, selection)


def read_content(content: bytes, name: str, scale: float = 1.0, selection: Selection = EVERYTHING) -> Iterator[Cloud]:
    """Yield the clouds of a file's whole content, as `read_clouds` does those of the file; `name` is what it is called.

    Raises
    ------
    SourceError
        If it is no cloud, or contradicts its own header.
    UsageError
        As `read_clouds` does.
    """
    with _spooled(name) as spool:
        spool.write(content)
        spool.flush()
        yield from _clouds(Path(spool.name), name, scale, selection)


def _clouds(path: Path, name: str, scale: float, selection: Selection) -> Iterator[Cloud]:
    if not 0 < scale < math.inf:  # false for NaN, too
        raise ValueError(f"scale is how many metres a unit of the source has, a positive number, not {scale}")
    from flatgrasp_cli.recordings.containers import is_recording
    from flatgrasp_cli.sources.folders import folder_images, kind_of_folder

    if path.is_dir() and kind_of_folder(path, name) == "images":
        yield from _placed(folder_images(path, name, scale, selection), name, selection)
    elif is_recording(path):
        from flatgrasp_cli.sources.frames import recorded_clouds

        yield from recorded_clouds(path, name, scale, selection)
    else:
        yield from _placed(_only_cloud(path, name, scale, selection), name, selection)


def _placed(clouds: Iterator[Cloud], name: str, selection: Selection) -> Iterator[Cloud]:
    """Clouds of files, which have no transforms, where they are wanted."""
    from flatgrasp_cli.placing import placed

    if selection.sensor_frame is not None:
        raise UsageError(
            f"{name}: --sensor {selection.sensor_frame}: is the name of a frame, and only a recording can say "
            "where that is; give the place X,Y,Z, above, or none"
        )
    for cloud in clouds:
        yield placed(cloud, selection.base_frame, selection.camera_pose)


def _only_cloud(path: Path, name: str, scale: float, selection: Selection) -> Iterator[Cloud]:
    from flatgrasp_cli.sources.files import read_file

    yield read_file(path, name, scale, selection)


@contextmanager
def on_disk(source: str) -> Iterator[Path]:
    """A seekable file: the source itself, or a temporary copy of standard input, of a pipe, or of what a URL names.

    Raises
    ------
    SourceError
        If there is none, it is a device, or a pipe does not end.
    """
    name = name_of(source)
    with _reporting(name):
        path = Path(source)
        if source != STDIN and (path.is_file() or path.is_dir()):
            yield path
            return
    with _spooled(name) as spool:
        if is_url(source):
            copy_url(source, spool)
        else:
            with _pipe(source) as pipe:
                _copy(pipe, spool, name)
        spool.flush()
        yield Path(spool.name)


@contextmanager
def _spooled(name: str) -> Iterator[IO[bytes]]:
    """A temporary file, for what has no place on disk of its own."""
    # in a folder: a file that goes away when it is closed cannot be opened a second time on Windows
    with (
        _reporting(name),
        tempfile.TemporaryDirectory(prefix="flatgrasp-") as folder,
        (Path(folder) / "source").open("wb") as spool,
    ):
        yield spool


@contextmanager
def _reporting(name: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise SourceError(f"{name}: cannot be read: {error.strerror or error}") from error


@contextmanager
def _pipe(source: str) -> Iterator[BinaryIO]:
    if source != STDIN:
        try:
            mode = Path(source).stat().st_mode
        except ValueError as error:  # of a NUL, or of what no path is made of
            raise SourceError(f"{name_of(source)!r}: is no path: {error}") from error
        if not stat.S_ISFIFO(mode):
            raise SourceError(f"{name_of(source)}: is a device and no file")
        with Path(source).open("rb") as pipe:
            yield pipe
    elif sys.stdin is None:
        raise SourceError("stdin: is closed")
    else:
        yield sys.stdin.buffer


def _copy(pipe: BinaryIO, spool: IO[bytes], name: str) -> None:
    """Copy a pipe to its end."""
    copied = 0
    while part := pipe.read(COPIED_AT_ONCE):
        copied += len(part)
        if copied > MOST_SPOOLED:
            raise SourceError(f"{name}: does not end within {MOST_SPOOLED / 2**30:g} GiB; save it to a file first")
        spool.write(part)
