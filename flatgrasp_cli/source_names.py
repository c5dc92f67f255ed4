"""What sources are called in documents, which are UTF-8 whatever a file system allows, and in messages."""

from __future__ import annotations

import re

STDIN = "-"
HALF_PAIRS = re.compile("[\ud800-\udfff]")
"""What Python has in a path for bytes that are no UTF-8, in the low byte of each; no text in UTF-8 can hold them."""


def name_of(source: str) -> str:
    r"""What documents and messages call a source: its path as it was given, bytes that are no UTF-8 as \xNN; or stdin.

    >>> name_of("gr\udcf6\udcdfe.pcd")
    'gr\\xf6\\xdfe.pcd'
    """
    return "stdin" if source == STDIN else HALF_PAIRS.sub(lambda half: rf"\x{ord(half[0]) & 0xFF:02x}", source)


def path_of(name: str) -> str:
    r"""The path that has a name with \xNN in it; one without may stand for itself."""
    return re.sub(r"\\x([89a-f][0-9a-f])", lambda byte: chr(0xDC00 + int(byte[1], 16)), name)
