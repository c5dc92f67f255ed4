"""Results on disk, so that no end loses work: every file is whole or not there.

- OUT/NAME.jsonl: the documents of a finished input, a line a frame
- OUT/NAME/SECONDS.NANOSECONDS.*.png: its pictures, when they were asked for
- OUT/.flatgrasp/manifest.json: what the results were made with
- OUT/.flatgrasp/concluded: the inputs that the files about the whole batch tell of
- OUT/.flatgrasp/done/NAME.jsonl: a finished input: its state, then a record a frame
- OUT/.flatgrasp/parts/NAME/K.jsonl: a slice of one that is not finished: its state, then record and document in turn
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from flatgrasp_cli.batch.inputs import Input
from flatgrasp_cli.batch.manifest import difference, manifest_of
from flatgrasp_cli.batch.work import Done
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.job import Job
from flatgrasp_cli.whole_files import write_bytes, write_text

STATE = ".flatgrasp"


@dataclass(frozen=True, slots=True)
class InputState:
    """What is known of a finished input, or of a slice of one that is not."""

    fingerprint: str
    frames: int = 0
    refused: int = 0
    error: str | None = None
    empty: str | None = None
    warnings: list[str] = field(default_factory=list)

    def line(self) -> str:
        """The state as a line of JSON."""
        values = {
            name: getattr(self, name) for name in ("fingerprint", "frames", "refused", "error", "empty", "warnings")
        }
        return json.dumps(values, ensure_ascii=False) + "\n"


class Store:
    """The results of one batch in the folder `out`."""

    def __init__(self, out: Path) -> None:
        self._out, self._state = out, out / STATE

    def prepare(self, job: Job, plots: bool, *, force: bool) -> None:
        """Begin, or go on with what is there.

        Raises
        ------
        UsageError
            If what is there was made with other settings, or by another version.
        """
        manifest = json.dumps(manifest_of(job, plots), indent=2, ensure_ascii=False, sort_keys=True) + "\n"
        path = self._state / "manifest.json"
        if force:
            shutil.rmtree(self._state, ignore_errors=True)
        if path.exists():
            before = path.read_text(encoding="utf-8")
            if before != manifest:
                raise UsageError(
                    f"{self._out}: holds results made otherwise ({difference(before, manifest)}); "
                    "choose another --out, or start over with --force"
                )
        write_text(path, [manifest])

    def made_with(self) -> dict[str, Any]:
        """The gripper, the settings and all else that the results were made with."""
        return dict(json.loads((self._state / "manifest.json").read_text(encoding="utf-8")))

    def finished(self, item: Input, fingerprint: str) -> InputState | None:
        """The state of an input that needs no more work; None if it has changed, failed, or is not done."""
        state = self._read_state(self._done_path(item))
        if state is None or state.fingerprint != fingerprint or state.error is not None:
            return None
        return state if state.frames == 0 or self._documents_path(item).exists() else None

    def has_part(self, item: Input, index: int, fingerprint: str) -> bool:
        """Whether a slice is done; one of an input as it was before is thrown away."""
        path = self._part_path(item, index)
        state = self._read_state(path)
        if state is None:
            return False
        if state.fingerprint != fingerprint or state.error is not None:
            path.unlink()
            return False
        return True

    def add(self, done: Done, fingerprint: str) -> None:
        """Keep what came of a slice."""
        item = done.slice.input
        self._concluded.unlink(missing_ok=True)
        for name, frame in zip(_file_names(done), done.frames, strict=True):
            frame.record["pictures"] = [f"{item.name}/{name}.{kind}.png" for kind in frame.pictures]
            for path, content in zip(frame.record["pictures"], frame.pictures.values(), strict=True):
                write_bytes(self._out / path, content)
        state = InputState(
            fingerprint=fingerprint,
            frames=len(done.frames),
            refused=sum(frame.record["status"] != "ok" for frame in done.frames),
            error=done.error,
            empty=done.empty,
            warnings=done.warnings,
        )
        lines = (
            line
            for frame in done.frames
            for line in (json.dumps(frame.record, ensure_ascii=False) + "\n", frame.document + "\n")
        )
        write_text(self._part_path(item, done.slice.index), _chain(state.line(), lines))

    def finish(self, item: Input, count: int) -> InputState:
        """Make one of the `count` slices of an input, all of which are there."""
        parts = [self._part_path(item, index) for index in range(count)]
        states = [state for state in map(self._read_state, parts) if state is not None]
        frames = sum(state.frames for state in states)
        empty = next((state.empty for state in states if state.empty is not None), None) if frames == 0 else None
        state = InputState(
            fingerprint=states[0].fingerprint,
            frames=frames,
            refused=sum(state.refused for state in states),
            error=next((state.error for state in states if state.error is not None), None) or empty,
            empty=None,
            warnings=list(dict.fromkeys(text for state in states for text in state.warnings)),
        )
        if frames:
            write_text(self._documents_path(item), _renumbered(parts))
        write_text(self._done_path(item), _chain(state.line(), _records(parts)))
        for part in parts:
            part.unlink()
        for folder in parts[0].parents:  # of names with folders, up to those that others still need
            if folder == self._state:
                break
            with suppress(OSError):
                folder.rmdir()
        return state

    def records(self, item: Input) -> Iterator[dict[str, Any]]:
        """The records of a finished input's frames, in order."""
        with self._done_path(item).open(encoding="utf-8") as lines:
            next(lines, None)
            for line in lines:
                yield json.loads(line)

    def documents(self, item: Input) -> Iterator[str]:
        """The documents of a finished input's frames, in order, as text."""
        with suppress(FileNotFoundError), self._documents_path(item).open(encoding="utf-8") as lines:
            yield from lines

    def state(self, item: Input) -> InputState | None:
        """The state of an input that was worked on to its end."""
        return self._read_state(self._done_path(item))

    def write(self, name: str, text: str) -> None:
        """Write a file about the whole batch."""
        write_text(self._out / name, [text])

    def conclude(self, inputs: Iterable[Input]) -> None:
        """Say that the files about the whole batch are those of these inputs, until more is added."""
        write_text(self._concluded, _sources(inputs))

    def concluded(self, inputs: Iterable[Input]) -> bool:
        """Whether they are."""
        with suppress(OSError):
            return self._concluded.read_text(encoding="utf-8") == "".join(_sources(inputs))
        return False

    def path(self, name: str) -> Path:
        """Where a file about the whole batch is."""
        return self._out / name

    @property
    def _concluded(self) -> Path:
        return self._state / "concluded"

    def _documents_path(self, item: Input) -> Path:
        return self._out / f"{item.name}.jsonl"

    def _done_path(self, item: Input) -> Path:
        return self._state / "done" / f"{item.name}.jsonl"

    def _part_path(self, item: Input, index: int) -> Path:
        return self._state / "parts" / item.name / f"{index:06d}.jsonl"

    @staticmethod
    def _read_state(path: Path) -> InputState | None:
        try:
            with path.open(encoding="utf-8") as lines:
                return InputState(**json.loads(next(lines)))
        except (OSError, ValueError, TypeError, StopIteration):
            return None


def _sources(inputs: Iterable[Input]) -> Iterator[str]:
    return (f"{item.name}\t{item.called}\n" for item in inputs)


def _records(parts: Iterable[Path]) -> Iterator[str]:
    for part in parts:
        with part.open(encoding="utf-8") as lines:
            yield from (line for k, line in enumerate(lines) if k % 2 == 1)


def _renumbered(parts: Iterable[Path]) -> Iterator[str]:
    """The documents of all slices, each with its place among all frames; it was that among its slice's."""
    index = 0
    for part in parts:
        with part.open(encoding="utf-8") as lines:
            documents = (line for k, line in enumerate(lines) if k > 0 and k % 2 == 0)
            for place, document in enumerate(documents):
                # quotes within strings are escaped, so that this is the key itself
                yield document.replace(f'"index":{place}', f'"index":{index}', 1)
                index += 1


def _file_names(done: Done) -> Iterator[str]:
    """A name for each frame: its time; frames of the same time are told apart by slice and number."""
    taken = set[str]()
    for k, frame in enumerate(done.frames):
        stamp_ns = frame.record["stamp_ns"]
        name = "cloud" if stamp_ns is None else "{}.{:09d}".format(*divmod(stamp_ns, 1_000_000_000))
        yield f"{name}-{done.slice.index}-{k}" if name in taken else name
        taken.add(name)


def _chain(first: str, rest: Iterable[str]) -> Iterator[str]:
    yield first
    yield from rest
