"""Folders as sources: a recording, or the depth images of one camera; nothing in them is left out without a word."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.model import Cloud, Source
from flatgrasp_cli.recordings.containers import is_recording
from flatgrasp_cli.source_names import in_utf8
from flatgrasp_cli.sources.files import IMAGES
from flatgrasp_cli.sources.files import SUFFIXES as CLOUDS
from flatgrasp_cli.sources.idle_options import idle_options
from flatgrasp_cli.sources.selection import Selection


def kind_of_folder(folder: Path, name: str) -> Literal["recording", "images"]:
    """What a folder is: one with rosbag2's metadata or nothing but its files is a recording.

    Raises
    ------
    SourceError
        If it is neither, or holds things of several kinds.
    """
    from flatgrasp_cli.recordings.containers.rosbag2 import METADATA, storage_files

    if (folder / METADATA).is_file() and is_recording(folder):
        return "recording"
    files = _files(folder)
    images = [file for file in files if file.suffix.lower() in IMAGES]
    clouds = [file for file in files if file.suffix.lower() in CLOUDS]
    recordings = [file for file in files if file not in images and file not in clouds and is_recording(file)]
    if recordings and not images and not clouds and set(recordings) <= set(storage_files(folder)):
        return "recording"
    if images and not clouds and not recordings:
        return "images"
    given = name.rstrip("/") or name
    if clouds or recordings:
        suffix = (clouds or recordings)[0].suffix
        batch = "" if images else f", or plan all with flatgrasp batch {given}"
        raise SourceError(
            f"{name}: is a folder with {len(clouds)} clouds, {len(recordings)} recordings and {len(images)} images; "
            f"give the files, e.g. {given}/*{suffix}{batch}"
        )
    raise SourceError(
        f"{name}: is a folder without recordings or depth images; give the files in it, e.g. {given}/*.pcd"
    )


def folder_images(folder: Path, name: str, scale: float, selection: Selection) -> Iterator[Cloud]:
    """Yield the wanted clouds of a folder of depth images of one camera, by name.

    Raises
    ------
    UsageError
        If frames are chosen by their time, or the intrinsics are missing.
    SourceError
        If an image is broken or no depth.
    """
    from flatgrasp_cli.sources.depth_files import DepthFiles

    timed = (selection.start, selection.end, selection.at, selection.every.period_ns)
    if any(value is not None for value in timed):
        raise UsageError(f"{name}: images have no time; choose among them with --every N and --count N")
    images = [file for file in _files(folder) if file.suffix.lower() in IMAGES]
    reader = DepthFiles(selection, scale)
    idle = idle_options(selection, recorded=False, images=True)
    for index, image in enumerate(images[:: selection.every.frames][: selection.count]):
        yield reader.read(image, Source(f"{name.rstrip('/')}/{in_utf8(image.name)}", index=index)).warned(*idle)


def _files(folder: Path) -> list[Path]:
    """The files of a folder by name, without hidden ones."""
    return sorted(file for file in folder.iterdir() if file.is_file() and not file.name.startswith("."))
