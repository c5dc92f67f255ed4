"""Decompression that stops at a bound: what a file declares must not decide how much memory is used."""

from __future__ import annotations

import bz2
import struct
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, Protocol

import lz4.frame  # type: ignore[import-untyped,unused-ignore]

from flatgrasp_cli.errors import SourceError

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

MAX_CHUNK_BYTES = 2**30
"""No chunk and no compressed message inflates to more; recorders write chunks of about 1 to 100 MB."""
MAX_FILE_RATIO = 500
MIN_FILE_BYTES = 2**30
"""A compressed file may grow to 500 times its size, or to 1 GiB if that is more; recordings shrink by 2 to 20."""
PIECE_BYTES = 2**20
LZ4_HEADER_BYTES, LZ4_HAS_SIZE = 7, 0x08
"""An lz4 frame's header, to which the flag adds the content's size in 8 bytes."""
MESSAGE_PIECE_BYTES = 2**26
"""Hardly any message is larger, and those that are not take one call."""

UNREADABLE: tuple[type[Exception], ...] = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
    MemoryError,
    OSError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
    struct.error,
    zstd.ZstdError,
)
"""What parsers raise, ours and the libraries', on bytes that make no sense."""


class _Decompressor(Protocol):
    @property
    def eof(self) -> bool: ...
    @property
    def needs_input(self) -> bool: ...
    def decompress(self, data: Any, max_length: int = -1) -> bytes: ...


_DECOMPRESSORS: dict[str, Callable[[], _Decompressor]] = {
    "bz2": bz2.BZ2Decompressor,
    "lz4": lz4.frame.LZ4FrameDecompressor,
    "zstd": zstd.ZstdDecompressor,
}


def inflate(compression: str, data: bytes, size: int) -> tuple[memoryview, str]:
    """The content of compressed data that declares to have `size` bytes, and why it is not whole ("" if it is).

    Damaged data gives what comes before the damage.
    """
    if compression in ("", "none"):
        return memoryview(data)[:size], "" if len(data) >= size else "it is cut short"
    if compression not in _DECOMPRESSORS:
        return memoryview(b""), f"unknown compression {compression[:20]!r}"
    if size > MAX_CHUNK_BYTES:
        return memoryview(b""), f"declares more than {MAX_CHUNK_BYTES} bytes"
    out, fault = _inflated(_DECOMPRESSORS[compression](), data, size)
    if len(out) > size:
        return memoryview(b""), "inflates beyond its declared size"
    return memoryview(out).toreadonly(), fault or ("" if len(out) == size else "it is cut short")


def _inflated(decompressor: _Decompressor, data: bytes, size: int) -> tuple[bytearray, str]:
    """What comes out, until a little more than `size` bytes; and what went wrong."""
    out = bytearray()
    try:
        out += decompressor.decompress(data, PIECE_BYTES)
        while not decompressor.eof and not decompressor.needs_input and len(out) <= size:
            piece = decompressor.decompress(b"", PIECE_BYTES)
            if not piece:
                break
            out += piece
    except UNREADABLE as error:
        return out, f"cannot be decompressed: {reason(error)}"
    return out, ""


def inflate_lz4_unchecked(data: bytes, size: int) -> memoryview | None:
    """The content of an lz4 frame without a look at its checksum; None unless it is whole and has `size` bytes.

    Some files of RealSense's SDK hold whole frames with a checksum that is wrong.
    """
    try:
        about = lz4.frame.get_frame_info(data)
    except UNREADABLE:
        return None
    if not about["content_checksum"] or size > MAX_CHUNK_BYTES:
        return None
    compressor = lz4.frame.LZ4FrameCompressor(
        block_size=about["block_size_id"],
        block_linked=about["block_linked"],
        block_checksum=about["block_checksum"],
        content_checksum=False,
    )
    header = bytes(compressor.begin())
    blocks = data[LZ4_HEADER_BYTES + (8 if data[4] & LZ4_HAS_SIZE else 0) :]
    decompressor = lz4.frame.LZ4FrameDecompressor()
    out, fault = _inflated(decompressor, header + blocks, size)
    return None if fault or len(out) != size or not decompressor.eof else memoryview(out).toreadonly()


def inflate_message(data: bytes) -> bytes:
    """One message that the recorder compressed with zstd.

    Raises
    ------
    ValueError
        If it is damaged or inflates to more than MAX_CHUNK_BYTES.
    """
    decompressor = zstd.ZstdDecompressor()
    out = decompressor.decompress(data, MESSAGE_PIECE_BYTES)
    if decompressor.eof:
        return out
    grown = bytearray(out)  # all at once, the library would hold a large one twice
    while not decompressor.eof and not decompressor.needs_input and len(grown) <= MAX_CHUNK_BYTES:
        grown += decompressor.decompress(b"", MESSAGE_PIECE_BYTES)
    if not decompressor.eof or len(grown) > MAX_CHUNK_BYTES:
        raise ValueError("its zstd frame is cut short or too large")
    return bytes(grown)


def inflate_file(source: BinaryIO, target: BinaryIO, size: int, name: str) -> str:
    """Write the content of a zstd file of `size` bytes to `target`; returns why it is not whole ("" if it is).

    Raises
    ------
    SourceError
        If it inflates beyond MAX_FILE_RATIO and MIN_FILE_BYTES, or the temporary folder's disk would be filled.
    """
    bound = max(MIN_FILE_BYTES, MAX_FILE_RATIO * size)
    written = 0
    try:
        with zstd.open(source, "rb") as stream:
            while piece := stream.read(PIECE_BYTES):
                written += len(piece)
                if written > bound:
                    raise SourceError(
                        f"{name}: the zstd file of {size} bytes inflates to more than {bound} bytes; "
                        "if it is no fraud, unpack it with `zstd -d` and give the result"
                    )
                target.write(piece)
    except (zstd.ZstdError, EOFError) as error:
        return reason(error)
    except OSError as error:
        raise SourceError(
            f"{name}: cannot be unpacked to the temporary folder ({error.strerror or error}); "
            "set TMPDIR to a folder with more room"
        ) from error
    return ""


def first_inflated_bytes(path: Path, count: int) -> bytes:
    """The first bytes of what a zstd file holds; none if it is damaged there."""
    try:
        with zstd.open(path, "rb") as stream:
            return stream.read(count)
    except (zstd.ZstdError, EOFError):
        return b""


def reason(error: Exception) -> str:
    """An exception of a library in a few words."""
    return (str(error).splitlines() or [type(error).__name__])[0][:120]
