"""Lines of text files from any system: they end in LF, in CR LF, or, as old Macs wrote them, in CR alone."""

from __future__ import annotations

import io
from typing import BinaryIO

from flatgrasp_cli.recordings.containers import printable

SHOWN = 100
"""Characters of a file's own words that an error repeats."""
BYTE_ORDER_MARK = b"\xef\xbb\xbf"
SNIFFED_BYTES = 65_536


def skip_byte_order_mark(file: BinaryIO) -> None:
    """Move the file, which stands at its beginning, behind the mark that some programs put before UTF-8 text."""
    if file.read(len(BYTE_ORDER_MARK)) != BYTE_ORDER_MARK:
        file.seek(0)


def ends_in_cr(file: BinaryIO) -> bool:
    """Whether the line that the file stands at ends in a carriage return alone; the file stays where it is."""
    begin = file.tell()
    head = file.read(SNIFFED_BYTES)
    file.seek(begin)
    end = head.find(b"\r")
    return end >= 0 and b"\n" not in head[: end + 2]


def read_line(file: BinaryIO, most: int, *, cr: bool) -> bytes:
    """The next line of a header, of at most so many bytes; behind it the file may go on with binary data."""
    if not cr:
        return file.readline(most)
    begin = file.tell()
    block = file.read(most)
    end = block.find(b"\r")
    if end < 0:
        return block
    file.seek(begin + end + 1)
    return block[: end + 1]


def with_lf(file: BinaryIO, *, cr: bool) -> BinaryIO:
    """The rest of a text file, with lines that end in LF."""
    return io.BytesIO(file.read().replace(b"\r", b"\n")) if cr else file


def shown(words: object) -> str:
    """Words of a file, or an error about them, as they may be shown: printable, and not without end."""
    text = printable(str(words))
    return text if len(text) <= SHOWN else text[:SHOWN] + "…"
