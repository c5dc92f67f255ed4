"""The door to all readers: says by content, not by name, what a source is."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources.remote import copy_url, is_url
from flatgrasp_cli.sources.selection import EVERYTHING, Selection

STDIN = "-"
SNIFFED_BYTES = 65_536


def read_clouds(
    source: str | os.PathLike[str], scale: float = 1.0, selection: Selection = EVERYTHING
) -> Iterator[Cloud]:
    """Yield the clouds of a PCD or PLY file or of a recording: a path, a URL, or "-" for standard input.

    A recording is an MCAP file, a ROS 1 bag, or a rosbag2 folder or file. One cloud at a time is in memory.

    Parameters
    ----------
    source
        A path, a URL that fsspec knows, or "-".
    scale
        Metres in one unit of the source: 0.001 for one in millimetres.
    selection
        Which topic and frames of a recording; a file with one cloud has no choice.

    Raises
    ------
    SourceError
        If the source is missing, is no cloud, or contradicts its own header.
    UsageError
        If a file is to say where a frame is.
    """
    from flatgrasp_cli.sources.containers import is_recording

    name = os.fspath(source)
    with on_disk(name) as path:
        label = "stdin" if name == STDIN else name
        if is_recording(path):
            from flatgrasp_cli.sources.frames import recorded_clouds

            yield from recorded_clouds(path, label, scale, selection)
        elif selection.sensor_frame is not None:
            raise UsageError(
                f"{label}: --sensor {selection.sensor_frame}: is the name of a frame, and only a recording can say "
                "where that is; give the place X,Y,Z, above, or none"
            )
        else:
            yield read_file(path, label, scale)


def read_file(path: Path, name: str, scale: float = 1.0) -> Cloud:
    """Read the cloud of a PCD or PLY file, told apart by content.

    `name` is what errors call it, `scale` the metres in a unit of the file.
    """
    from flatgrasp_cli.sources.pcd_ply import read_pcd, read_ply

    if path.is_dir():
        raise SourceError(f"{name}: is a folder and no rosbag2; give the files in it, e.g. {name.rstrip('/')}/*.pcd")
    with path.open("rb") as file:
        head = file.read(SNIFFED_BYTES)
        file.seek(0)
        if not head:
            raise SourceError(f"{name}: the file is empty")
        if head.startswith((b"ply\n", b"ply\r")):
            return read_ply(file, name, scale)
        if head.lstrip().startswith((b"#", b"VERSION", b"FIELDS")) and b"FIELDS" in head:
            return read_pcd(file, name, scale)
    raise SourceError(
        f"{name}: is neither a PCD or PLY file, nor a ROS bag, nor an MCAP recording (it begins with {head[:16]!r})"
    )


@contextmanager
def on_disk(name: str) -> Iterator[Path]:
    """A seekable file: the source itself, or a temporary copy of standard input, of a pipe, or of what a URL names."""
    path = Path(name)
    try:
        if name != STDIN and (path.is_file() or path.is_dir()):
            yield path
            return
        with tempfile.NamedTemporaryFile(prefix="flatgrasp-") as spool:
            if is_url(name):
                copy_url(name, spool)
            else:
                with _pipe(name) as pipe:
                    shutil.copyfileobj(pipe, spool)
            spool.flush()
            yield Path(spool.name)
    except OSError as error:
        raise SourceError(f"{name}: cannot be read: {error.strerror or error}") from error


@contextmanager
def _pipe(name: str) -> Iterator[BinaryIO]:
    if name != STDIN:
        with Path(name).open("rb") as pipe:
            yield pipe
    elif sys.stdin is None:
        raise SourceError("stdin: is closed")
    else:
        yield sys.stdin.buffer
