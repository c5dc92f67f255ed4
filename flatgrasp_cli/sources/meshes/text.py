"""Lines of text formats for meshes, and the numbers on them."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from typing import BinaryIO

from flatgrasp_cli.errors import SourceError

Line = tuple[int, list[bytes]]
"""Its number, counted from 1, and its words."""
LARGEST_INDEX = 2**53


def words_of(file: BinaryIO) -> Iterator[Line]:
    """The lines that have words, without what follows a #; they may end in any way, and go on behind a backslash."""
    text = file.read().replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    carried: list[bytes] = []
    for number, line in enumerate(io.BytesIO(text), 1):
        words = carried + line.split(b"#")[0].split()
        if words and words[-1] == b"\\":
            carried = words[:-1]
        else:
            carried = []
            if words:
                yield number, words
    if carried:
        yield number, carried


def floats(words: Sequence[bytes], line: Line, name: str) -> list[float]:
    """The numbers that these words of a line are.

    Raises
    ------
    SourceError
        If they are none.
    """
    try:
        return [float(word) for word in words]
    except ValueError:
        raise malformed(line, name) from None


def integers(words: Sequence[bytes], line: Line, name: str) -> list[int]:
    """The integers that these words of a line are; raises `SourceError` if they are none."""
    try:
        values = [int(word) for word in words]
    except ValueError:
        raise malformed(line, name) from None
    if any(abs(value) > LARGEST_INDEX for value in values):
        raise malformed(line, name)
    return values


def malformed(line: Line, name: str) -> SourceError:
    """The error for a line that makes no sense."""
    number, words = line
    shown = b" ".join(words).decode("latin-1")[:40]
    return SourceError(f"{name}: line {number} is malformed: {shown!r}")
