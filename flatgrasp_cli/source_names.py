"""What sources are called in documents, which are UTF-8 whatever a file system allows, and in messages."""

from __future__ import annotations

import re

STDIN = "-"
NO_UTF_8 = re.compile("[\udc80-\udcff]")
"""What Python has in a path for a byte that is no UTF-8, the byte being the low one."""
AS_BYTE = re.compile(r"\\x([89a-f][0-9a-f])")


def name_of(source: str) -> str:
    r"""What documents and messages call a source: its path as it was given, bytes that are no UTF-8 as \xNN; or stdin.

    >>> name_of("gr\udcf6\udcdfe.pcd")
    'gr\\xf6\\xdfe.pcd'
    """
    return "stdin" if source == STDIN else in_utf8(source)


def in_utf8(path: str) -> str:
    r"""A path, or a part of one, as text that UTF-8 has: what is none as \xNN."""
    text = NO_UTF_8.sub(lambda byte: rf"\x{ord(byte[0]) & 0xFF:02x}", path)
    return text.encode(errors="backslashreplace").decode()  # Windows has more in its names than bytes


def path_of(name: str) -> str:
    r"""The path that has a name with \xNN in it; one without may stand for itself."""
    return AS_BYTE.sub(lambda byte: chr(0xDC00 + int(byte[1], 16)), name)
