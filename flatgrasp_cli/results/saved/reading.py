"""Documents read from files or standard input, and checked."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from pydantic import ValidationError

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.results.contracts.plan import SCHEMA_ID
from flatgrasp_cli.results.saved.models import SavedDocument

ENDINGS = (".grasps.json", ".json", ".jsonl")


def is_document(path: str) -> bool:
    """Whether a file is named like documents are: .json or .jsonl."""
    return path.endswith(ENDINGS[1:])


def stem_of(path: str) -> str:
    """What the names of files that are made of a document begin with."""
    name = "stdin" if path == "-" else Path(path).name
    return next((name.removesuffix(ending) for ending in ENDINGS if name.endswith(ending)), name)


def read_documents(path: str) -> Iterator[SavedDocument]:
    """The documents of a file, or with "-" of standard input: one, or one a line.

    Raises
    ------
    SourceError
        If it cannot be read, or holds something else.
    """
    with _opened(path) as lines:
        try:
            for number, text in enumerate(_texts(lines), 1):
                yield parse_document(text, f"{path}: document {number}")
        except OSError as error:
            raise SourceError(f"{path}: cannot be read: {error.strerror or error}") from error
        except UnicodeDecodeError as error:
            raise SourceError(f"{path}: is no text in UTF-8, and so no document of flatgrasp") from error


@contextmanager
def _opened(path: str) -> Iterator[TextIO]:
    if path == "-":
        yield sys.stdin
        return
    try:
        file = Path(path).open(encoding="utf-8")  # noqa: SIM115 (closed below)
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror or error}") from error
    with file:
        yield file


def _texts(lines: TextIO) -> Iterator[str]:
    """Each document's text: the lines, or all of them together where the first is no document of its own."""
    first = next(lines, "")
    try:
        json.loads(first)
    except ValueError:
        yield first + lines.read()
        return
    yield first
    yield from (line for line in lines if line.strip())


def parse_document(text: str, where: str) -> SavedDocument:
    """The document that a text is; raises `SourceError`, which names it by `where`, if it is none."""
    try:
        return SavedDocument.model_validate_json(text)
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        key = ".".join(map(str, problem["loc"]))
        raise SourceError(
            f"{where}: is no plan ({SCHEMA_ID}): {f'{key}: ' if key else ''}{problem['msg']}; "
            "make one with `flatgrasp plan SOURCE`"
        ) from error
