"""Rows of numbers in text."""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Callable, Iterator, Sequence
from typing import BinaryIO, TypeVar

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray

MAX_ROW_BYTES = 65_536
NOT_A_NUMBER = re.compile(rb"[+-]?(nan(\(\w*\))?|1\.?#\w*)", re.IGNORECASE)
"""What C libraries write for NaN and infinity, beside what Python reads: -nan(ind), 1.#QNAN, -1.#IND00, 1.#INF."""

Parsed = TypeVar("Parsed")


def parsed_rows(
    file: BinaryIO, rows: int, parse: Callable[[list[float]], Parsed | None], name: str, expected: str
) -> Iterator[Parsed]:
    """What `parse` makes of the numbers of each of the next rows of a file, which is left behind them.

    Lines end in LF. Readers in C take a word for 0 and leave memory unset where a row is short: neither may pass in
    silence. So `parse` gives None for numbers that cannot be such a row; `expected` says what a row should be.

    Raises
    ------
    SourceError
        Naming the first row that is wrong.
    """
    seen = 0
    while seen < rows and (line := file.readline(MAX_ROW_BYTES)):
        words = line.split()
        if not words:
            continue
        seen += 1
        numbers = _numbers(words, line)
        row = None if numbers is None else parse(numbers)
        if row is None:
            shown = line.decode("latin-1").strip()[:40]
            raise SourceError(f"{name}: row {seen} of the data should be {expected}, it is {shown!r}")
        yield row
    if seen != rows:
        raise SourceError(f"{name}: the header declares {rows} rows, the file has {seen}; it is truncated")


def read_columns(file: BinaryIO, rows: int, columns: int, places: Sequence[int], name: str) -> FloatArray:
    """The numbers (len(places), rows) at these places of rows that have so many columns; see `parsed_rows`."""

    def parse(numbers: list[float]) -> list[float] | None:
        return [numbers[place] for place in places] if len(numbers) == columns else None

    values = array("d")
    for row in parsed_rows(file, rows, parse, name, f"{columns} numbers"):
        values.extend(row)
    return np.array(values, dtype=np.float64).reshape(rows, len(places)).T


def more_rows(file: BinaryIO) -> bool:
    """Whether anything but white space follows."""
    return any(line.strip() for line in iter(lambda: file.readline(MAX_ROW_BYTES), b""))


def _numbers(words: list[bytes], line: bytes) -> list[float] | None:
    """The numbers that the words of a line are, or None."""
    if b"_" in line:  # Python takes 1_000 for a number
        return None
    try:
        return [float(word) for word in words]
    except ValueError:
        pass
    try:
        return [math.nan if NOT_A_NUMBER.fullmatch(word) else float(word) for word in words]
    except ValueError:
        return None
