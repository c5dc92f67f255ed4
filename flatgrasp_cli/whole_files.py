"""Files that are whole or not there, whenever this process ends and whether or not the disk is full."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def draft_of(path: Path) -> Iterator[Path]:
    """A file beside `path` to write to: it takes its place in the end, and is gone when something goes wrong."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.part")
    try:
        yield draft
        draft.replace(path)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise


def write_text(path: Path, lines: Iterable[str]) -> None:
    """Write lines, each with its end, as UTF-8."""
    with draft_of(path) as draft, draft.open("w", encoding="utf-8", newline="\n") as out:
        out.writelines(lines)


def write_bytes(path: Path, content: bytes) -> None:
    """Write bytes as they are."""
    with draft_of(path) as draft:
        draft.write_bytes(content)
