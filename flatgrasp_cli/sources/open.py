"""The door to all readers: says by content, not by name, what a source is."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import Cloud

STDIN = "-"
SNIFFED_BYTES = 65_536
RECORDINGS = {b"\x89MCAP0\r\n": "an MCAP recording", b"#ROSBAG V2.0": "a ROS 1 bag"}


def read_clouds(source: str | os.PathLike[str], scale: float = 1.0) -> Iterator[Cloud]:
    """Yield the clouds of a PCD or PLY file, or of standard input for "-".

    Parameters
    ----------
    source
        A path, or "-".
    scale
        Metres in one unit of the file: 0.001 for a file in millimetres.

    Raises
    ------
    SourceError
        If the source is missing, is no cloud, or contradicts its own header.
    """
    name = os.fspath(source)
    with _on_disk(name) as path:
        yield _scaled(_read_file(path, "stdin" if name == STDIN else name), scale)


def _read_file(path: Path, name: str) -> Cloud:
    from flatgrasp_cli.sources.pcd_ply import read_pcd, read_ply

    with path.open("rb") as file:
        head = file.read(SNIFFED_BYTES)
        file.seek(0)
        if not head:
            raise SourceError(f"{name}: the file is empty")
        for magic, what in RECORDINGS.items():
            if head.startswith(magic):
                raise SourceError(f"{name}: is {what}; this version reads PCD and PLY files")
        if head.startswith((b"ply\n", b"ply\r")):
            return read_ply(file, name)
        if head.lstrip().startswith((b"#", b"VERSION", b"FIELDS")) and b"FIELDS" in head:
            return read_pcd(file, name)
    raise SourceError(f"{name}: is neither a PCD nor a PLY file (it begins with {head[:16]!r})")


@contextmanager
def _on_disk(name: str) -> Iterator[Path]:
    """A seekable file: the source itself, or a temporary copy of standard input or of a pipe."""
    path = Path(name)
    try:
        if name != STDIN and path.is_dir():
            raise SourceError(f"{name}: is a folder; give the files in it, e.g. {name.rstrip('/')}/*.pcd")
        if name != STDIN and path.is_file():
            yield path
            return
        with _pipe(name) as pipe, tempfile.NamedTemporaryFile(prefix="flatgrasp-") as spool:
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


def _scaled(cloud: Cloud, scale: float) -> Cloud:
    """The cloud in metres."""
    return cloud if scale == 1.0 else replace(cloud, points=cloud.points * scale, viewpoint=cloud.viewpoint * scale)
