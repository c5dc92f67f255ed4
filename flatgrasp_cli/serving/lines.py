"""Lines of a stream that may be longer than memory."""

from __future__ import annotations

from collections.abc import Iterator
from io import BufferedIOBase
from typing import BinaryIO

LONGEST_REQUEST = 64 << 20
"""Bytes, 64 MiB: a frame of 1280 × 720 points with colours takes 20 MB in base64."""
SKIPPED_AT_ONCE = 1 << 20


def requests_in(stream: BinaryIO | BufferedIOBase, longest: int = LONGEST_REQUEST) -> Iterator[bytes | None]:
    """The lines of a stream that are not blank, each when it is there; None for one of more than `longest` bytes."""
    while line := stream.readline(longest + 1):
        if len(line) > longest and not line.endswith(b"\n"):
            while line and not line.endswith(b"\n"):
                line = stream.readline(SKIPPED_AT_ONCE)
            yield None
        elif line.strip():
            yield line
