"""Rows of numbers in text."""

from __future__ import annotations

from typing import BinaryIO

from flatgrasp_cli.errors import SourceError

NUMERIC = b"0123456789+-.eE \t\r\nnaifNAIFty"
"""Characters of numbers, nan, inf and infinity: Python's own parser would take 1_000 as well."""
MAX_ROW_BYTES = 65_536


def check_rows(file: BinaryIO, rows: int, columns: int, name: str, *, to_end: bool) -> None:
    """Check that `rows` rows of `columns` numbers follow, and nothing else when `to_end`; leaves the file behind them.

    Readers in C take a word for 0 and leave memory unset where a row is short: neither may pass in silence.

    Raises
    ------
    SourceError
        Naming the first row that is wrong.
    """
    seen = 0
    while to_end or seen < rows:
        line = file.readline(MAX_ROW_BYTES)
        if not line:
            break
        words = line.split()
        if not words:
            continue
        seen += 1
        if seen > rows:
            continue
        if len(words) != columns or line.translate(None, NUMERIC) or not _all_numbers(words):
            shown = line.decode("latin-1").strip()[:40]
            raise SourceError(f"{name}: row {seen} of the data should be {columns} numbers, it is {shown!r}")
    if seen != rows:
        raise SourceError(f"{name}: the header declares {rows} points, the file has {seen} rows")


def _all_numbers(words: list[bytes]) -> bool:
    try:
        for word in words:
            float(word)
    except ValueError:
        return False
    return True
