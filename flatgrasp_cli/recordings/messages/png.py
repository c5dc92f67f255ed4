"""PNG of 16-bit grey: what it declares is held against what it can hold before OpenCV decodes it."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import ByteArray
from flatgrasp_cli.recordings.messages.decoded import MessageError

PNG_MAGIC = b"\x89PNG\r\n\x1a\n"
JPEG_MAGIC = b"\xff\xd8"
LOSSY = "JPEG, which destroys depth: record the image raw, as PNG or as compressedDepth"
PNG_HEADER = struct.Struct(">8sI4sIIBB")
PNG_CHUNK = struct.Struct(">I4s")
PNG_CHECKSUM = struct.Struct(">I")
DEFLATE_RATIO = 1032
"""No byte of a PNG can stand for more bytes of its image."""


def png_size(data: ByteArray) -> tuple[int, int]:
    """Width and height of a PNG of 16-bit grey, after a look at whether it can hold them."""
    if len(data) < PNG_HEADER.size or data[:8].tobytes() != PNG_MAGIC:
        raise MessageError(
            f"the compressed image is no PNG{' but ' + LOSSY if data[:2].tobytes() == JPEG_MAGIC else ''}"
        )
    _, _, chunk, width, height, depth, kind = PNG_HEADER.unpack_from(data.data)
    if chunk != b"IHDR" or (depth, kind) != (16, 0):
        raise MessageError(f"the PNG has {depth} bits of colour type {kind}; depth has 16 bits of grey")
    if width * height * 2 > len(data) * DEFLATE_RATIO:
        raise MessageError(f"the PNG has {len(data)} bytes, which cannot hold {width} × {height} pixels")
    return width, height


def _check_chunks(data: ByteArray) -> None:
    """Raise `MessageError` if the PNG is cut off or altered; the decoder would print that to stderr, or overlook it."""
    end = len(PNG_MAGIC)
    kind = b""
    while kind != b"IEND":
        begin = end
        if begin + PNG_CHUNK.size > len(data):
            raise MessageError(f"the PNG is cut off after {len(data)} bytes")
        size, kind = PNG_CHUNK.unpack_from(data.data, begin)
        end = begin + PNG_CHUNK.size + size + PNG_CHECKSUM.size
        if end > len(data):
            raise MessageError(f"the PNG is cut off after {len(data)} bytes")
        checked = data[begin + PNG_CHECKSUM.size : end - PNG_CHECKSUM.size]
        if PNG_CHECKSUM.unpack_from(data.data, end - PNG_CHECKSUM.size)[0] != zlib.crc32(checked.data):
            raise MessageError("the PNG is broken: a checksum does not match")


def decode_png(data: ByteArray) -> NDArray[Any]:
    """The image (height, width), uint16.

    Raises
    ------
    MessageError
        If it is cut off, altered, or of another kind.
    """
    import cv2

    width, height = png_size(data)
    _check_chunks(data)
    try:
        raw = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise MessageError("the PNG is broken") from error
    if raw is None or raw.shape != (height, width) or raw.dtype != np.uint16:
        raise MessageError("the PNG is broken")
    return np.asarray(raw)
