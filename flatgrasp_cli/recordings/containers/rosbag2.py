"""Folders of rosbag2: a recording in one file or several, described by metadata.yaml, which may be missing or wrong."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any, Self

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers.bounded import UNREADABLE, reason
from flatgrasp_cli.recordings.containers.channels import ChannelRecording
from flatgrasp_cli.recordings.containers.merge import in_order
from flatgrasp_cli.recordings.containers.recording import Message, Problems, Topic

METADATA = "metadata.yaml"
KEY = "rosbag2_bagfile_information"
MAX_METADATA_BYTES = 2**22
SUFFIXES = (".mcap", ".db3", ".mcap.zstd", ".db3.zstd")


@dataclass(frozen=True, slots=True)
class Part:
    """One file: how to open it (again), and what it holds."""

    open: Callable[[], ChannelRecording]
    topics: tuple[Topic, ...]
    start_ns: int
    end_ns: int


def is_folder(path: Path) -> bool:
    """Whether a folder is a recording: it has rosbag2's metadata or storage files."""
    try:
        with (path / METADATA).open("rb") as file:
            if KEY.encode() in file.read(4096):
                return True
    except OSError:
        pass
    return bool(storage_files(path))


def storage_files(path: Path) -> list[Path]:
    """The storage files of a folder, by name."""
    return sorted(file for file in path.iterdir() if file.name.endswith(SUFFIXES) and file.is_file())


def describe(path: Path, name: str, problems: Problems) -> tuple[list[Path], str]:
    """The files of the recording in a folder, and the ROS distribution that wrote it ("" if it is not told).

    Raises
    ------
    SourceError
        If there are no files.
    """
    listed: list[Path] = []
    distro = ""
    try:
        information = _metadata(path / METADATA)
        names = [PurePosixPath(str(each)).name for each in _files(information)]
        listed = [path / each for each in names if each]
        distro = str(information.get("ros_distro") or "")
    except FileNotFoundError:
        problems.add(f"{METADATA} is missing; the storage files in the folder are read", at=0)
    except UNREADABLE as error:
        problems.add(f"{METADATA} cannot be used ({reason(error)}); the storage files in the folder are read", at=0)
    for file in listed:
        if not file.is_file():
            problems.add(f"{file.name} is missing, though {METADATA} lists it", at=0)
    files = [file for file in listed if file.is_file()] or storage_files(path)
    if not files:
        raise SourceError(f"{name}: the folder has no {' or '.join(SUFFIXES[:2])} file to read")
    return files, distro


def _metadata(path: Path) -> dict[str, Any]:
    import yaml

    with path.open("rb") as file:
        text = file.read(MAX_METADATA_BYTES)
    try:
        # libyaml, where it is there, is ten times as fast, and batch reads this once for each slice
        document = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506
    except yaml.YAMLError as error:
        raise ValueError("it is no YAML") from error
    information = document.get(KEY) if isinstance(document, dict) else None
    if not isinstance(information, dict):
        raise ValueError(f"it has no {KEY}")  # noqa: TRY004 - the file's fault, not the caller's
    return information


def _files(information: dict[str, Any]) -> list[Any]:
    files = information.get("relative_file_paths")
    if not isinstance(files, list):
        raise ValueError("it lists no files")  # noqa: TRY004
    return files


class FolderRecording:
    """The files of a folder as one recording; each is opened when its time comes."""

    def __init__(self, opening: Sequence[Callable[[], ChannelRecording]], name: str, problems: Problems) -> None:
        self.problems = problems
        self.on_close: Callable[[], None] = lambda: None
        self._parts: list[Part] = []
        kinds: set[str] = set()
        counts: dict[tuple[str, str], Topic] = {}
        failures: list[SourceError] = []
        bounds: list[int] = []
        for reopen in opening:
            try:
                with reopen() as part:
                    kinds.add(part.container.removeprefix("rosbag2 "))
                    bounds += [stamp for stamp in (part.start_ns, part.end_ns) if stamp is not None]
                    self._parts.append(Part(reopen, part.topics, part.start_ns or 0, part.end_ns or 0))
            except SourceError as error:
                problems.add(str(error).removeprefix(f"{name}: "), at=0)
                failures.append(error)
        if not self._parts:
            raise failures[0]
        for topic in (topic for part in self._parts for topic in part.topics):
            key = (topic.name, topic.type)
            earlier = counts[key].count if key in counts else 0
            known = topic.count is not None and earlier is not None
            counts[key] = replace(topic, count=(earlier or 0) + (topic.count or 0) if known else None)
        self._topics = counts
        self.topics = tuple(counts[key] for key in sorted(counts))
        self.start_ns = min(bounds, default=None)
        self.end_ns = max(bounds, default=None)
        self.container = f"rosbag2 folder ({len(self._parts)} × {', '.join(sorted(kinds))})"

    def messages(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[Message]:
        """Decoded messages of all files on the named topics with start_ns ≤ stamp < end_ns, in order of log time."""

        def read(part: Part) -> Iterator[Message]:
            with part.open() as recording:
                for message in recording.messages(topics, start_ns, end_ns):
                    yield replace(message, topic=self._topics[message.topic.name, message.topic.type])

        chosen = [
            (part.start_ns, partial(read, part))
            for part in self._parts
            if any(topic.name in topics for topic in part.topics)
            and (start_ns is None or part.end_ns >= start_ns)
            and (end_ns is None or part.start_ns < end_ns)
        ]
        return in_order(chosen, lambda message: message.stamp_ns)

    def close(self) -> None:
        """Remove the unpacked copies; no file stays open but those that messages() is reading."""
        self.on_close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()
