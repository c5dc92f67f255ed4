"""What is to be planned: files, folders, globs and URLs → inputs, each with a name for its results."""

from __future__ import annotations

import glob
import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers import is_recording
from flatgrasp_cli.source_names import in_utf8, name_of
from flatgrasp_cli.sources.files import SUFFIXES as CLOUDS
from flatgrasp_cli.sources.remote import is_url, list_url, url_state

RECORDINGS = (".bag", ".mcap", ".db3", ".zstd")
SAMPLE_BYTES = 65_536
"""A fingerprint reads so much of both ends of a file, beside its size and time: a whole night would take too long."""


@dataclass(frozen=True, slots=True)
class Input:
    """A source, and the relative path, without a suffix of ours, that its results are named after."""

    source: str
    name: str

    @property
    def called(self) -> str:
        """What documents and messages call the source."""
        return name_of(self.source)


def find_inputs(arguments: Iterable[str]) -> list[Input]:
    """The inputs that files, folders (searched), globs and URLs name, each once, in order.

    Names keep the folders below a folder given, and nothing of the way to it; unsafe characters become `_`, and equal
    names get numbers.

    Raises
    ------
    SourceError
        If a folder or a glob holds nothing to plan.
    """
    found: dict[str, PurePosixPath] = {}
    for argument in arguments:
        seen = False
        for source, place in _expanded(argument):
            seen = True
            found.setdefault(source, place)
        if not seen:
            raise SourceError(f"{name_of(argument)}: holds no clouds, meshes or recordings")
    taken: set[str] = set()
    return [Input(source, _unique(_safe(place), taken)) for source, place in found.items()]


def fingerprint(source: str) -> str:
    """A hash that changes when the input does, of its size, time, and both its ends; "gone" when it cannot be read."""
    if is_url(source):
        return hashlib.sha256(url_state(source).encode()).hexdigest()
    path, digest = Path(source), hashlib.sha256()
    try:
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file():
                state = file.stat()
                digest.update(
                    f"{in_utf8(str(file.relative_to(path)))}\0{state.st_size}\0{state.st_mtime_ns}\0".encode()
                )
                with file.open("rb") as content:
                    digest.update(content.read(SAMPLE_BYTES))
                    content.seek(-min(state.st_size, SAMPLE_BYTES), os.SEEK_END)
                    digest.update(content.read(SAMPLE_BYTES))
    except OSError:
        return "gone"
    return digest.hexdigest()


def _expanded(argument: str) -> Iterator[tuple[str, PurePosixPath]]:
    """Sources with their places below what was given."""
    if is_url(argument):
        yield from list_url(argument, (*CLOUDS, *RECORDINGS))
        return
    path = Path(argument)
    if path.is_dir() and not _is_rosbag2(path):
        yield from _searched(path, path)
    elif path.exists() or not glob.has_magic(argument):
        yield argument, PurePosixPath(path.name)  # one that is not there is reported when its turn comes
    else:
        for match in sorted(glob.glob(argument, recursive=True)):  # noqa: PTH207 - Path.glob takes no absolute pattern
            yield from _expanded(match)


def _searched(folder: Path, root: Path, above: frozenset[Path] = frozenset()) -> Iterator[tuple[str, PurePosixPath]]:
    """What lies in a folder and below; links back to a folder `above` it are not followed."""
    try:
        paths = sorted(folder.iterdir())
    except OSError:
        yield str(folder), PurePosixPath(*folder.relative_to(root.parent).parts)  # reading it will tell
        return
    above |= {folder.resolve()}
    for path in paths:
        if path.name.startswith("."):
            continue
        place = PurePosixPath(*path.relative_to(root).parts)
        if path.is_dir():
            if _is_rosbag2(path):
                yield str(path), place
            elif path.resolve() not in above:
                yield from _searched(path, root, above)
        elif path.suffix.lower() in CLOUDS or is_recording(path):
            yield str(path), place


def _is_rosbag2(folder: Path) -> bool:
    """Whether the files in a folder are one recording; without its metadata they are taken for one each."""
    return (folder / "metadata.yaml").is_file()


def _safe(place: PurePosixPath) -> str:
    """The place as a path that leads nowhere but down: no part is empty, hidden, or a way up."""
    parts = [re.sub(r"[^\w.+-]", "_", part).lstrip(".") or "_" for part in place.parts if part not in ("/", "..", ".")]
    return "/".join(parts) or "_"


def _unique(name: str, taken: set[str]) -> str:
    unique, n = name, 1
    while unique.lower() in taken:  # some file systems do not tell cases apart
        n += 1
        unique = f"{name}-{n}"
    taken.add(unique.lower())
    return unique
