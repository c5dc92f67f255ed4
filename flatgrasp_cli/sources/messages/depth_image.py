"""Depth images: sensor_msgs/Image, and sensor_msgs/CompressedImage as compressed_depth_image_transport writes it."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import ByteArray, FloatArray
from flatgrasp_cli.sources.messages.decoded import MessageError, raw_bytes, reading

MILLIMETRES = frozenset({"16UC1", "mono16"})
METRES = frozenset({"32FC1"})
MM_IN_M = 1000.0
PNG_MAGIC = b"\x89PNG\r\n\x1a\n"
PNG_HEADER = struct.Struct(">8sI4sIIBB")
PNG_CHUNK = struct.Struct(">I4s")
PNG_CHECKSUM = struct.Struct(">I")
DEFLATE_RATIO = 1032
"""No byte of a PNG can stand for more bytes of its image."""
CONFIG_HEADER = struct.Struct("<iff")
"""compressedDepth puts before the PNG: a format that nobody sets, and the quantisation's A and B."""


@dataclass(frozen=True, slots=True, eq=False)
class DepthImage:
    """`raw` (height, width) as recorded, uint16 or float32; `inverse` is A and B where that is inverse depth."""

    raw: NDArray[Any]
    millimetres: bool
    inverse: tuple[float, float] | None = None

    def metres(self) -> tuple[FloatArray, NDArray[np.intp]]:
        """Depths (n,) in metres, and the pixels (n,) they are at, counted row by row; only where there is depth."""
        raw = self.raw.reshape(-1)
        with np.errstate(invalid="ignore"):
            pixels = np.flatnonzero((raw > 0) & np.isfinite(raw))
        depth = raw[pixels].astype(np.float64)
        if self.inverse is not None:
            a, b = self.inverse
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                depth = a / (depth - b)
            seen = np.isfinite(depth) & (depth > 0)
            return depth[seen], pixels[seen]
        return (depth / MM_IN_M if self.millimetres else depth), pixels


def is_depth(message: Any) -> bool:
    """Whether an Image or CompressedImage holds depth; colour images are of the same types."""
    if hasattr(message, "format"):
        encoding, how = _compression(message)
        return "compresseddepth" in how or (encoding in MILLIMETRES and "png" in how)
    return str(getattr(message, "encoding", "")) in MILLIMETRES | METRES


def image_size(message: Any) -> tuple[int, int]:
    """Width and height that the message, or the PNG in it, declares."""
    with reading("image"):
        if not hasattr(message, "format"):
            return int(message.width), int(message.height)
        return _png_size(_png(message)[0])


def read_depth(message: Any) -> DepthImage:
    """The depth image in a message.

    Raises
    ------
    MessageError
        If the message holds no depth, less data than it declares, a PNG that is broken, or an encoding not read here.
    """
    with reading("image"):
        if hasattr(message, "format"):
            return _compressed(message)
        return _plain(message)


def _plain(message: Any) -> DepthImage:
    height, width, step = int(message.height), int(message.width), int(message.step)
    encoding = str(message.encoding)
    if encoding not in MILLIMETRES | METRES:
        raise MessageError(f"has encoding {encoding!r}, which is no depth; depth is 16UC1, mono16 or 32FC1")
    dtype = np.dtype("u2" if encoding in MILLIMETRES else "f4").newbyteorder(">" if message.is_bigendian else "<")
    if min(height, width) <= 0:
        return DepthImage(np.empty((0, 0), dtype), encoding in MILLIMETRES)
    row = width * dtype.itemsize
    if step < row:
        raise MessageError(f"step is {step}, but {width} pixels of {dtype.itemsize} bytes need {row}")
    data = raw_bytes(message.data)
    need = (height - 1) * step + row  # the padding of the last row may be left out
    if len(data) < need:
        raise MessageError(f"data has {len(data)} bytes, {width} × {height} pixels in rows of {step} bytes need {need}")
    raw: NDArray[Any] = np.ndarray((height, width), dtype, data.data, 0, (step, dtype.itemsize))
    return DepthImage(raw, encoding in MILLIMETRES)


def _compressed(message: Any) -> DepthImage:
    encoding, _ = _compression(message)
    data, inverse = _png(message)
    raw = _decoded_png(data)
    return DepthImage(raw, encoding in MILLIMETRES, inverse)


def _compression(message: Any) -> tuple[str, str]:
    """The encoding and the rest of a format such as "16UC1; compressedDepth png"; both may be written in any case."""
    encoding, _, how = str(message.format).partition(";")
    return encoding.strip(), how.strip().lower()


def _png(message: Any) -> tuple[ByteArray, tuple[float, float] | None]:
    """The PNG in a CompressedImage, and the quantisation where it holds inverse depth."""
    encoding, how = _compression(message)
    data = raw_bytes(message.data)
    if "rvl" in how:
        raise MessageError("compressedDepth rvl is not read; republish as png")
    if not is_depth(message) or encoding not in MILLIMETRES | METRES:
        raise MessageError(f"has format {message.format!r}, which is no depth; depth is 16UC1 or 32FC1 compressedDepth")
    if "compresseddepth" not in how:
        return data, None
    if len(data) < CONFIG_HEADER.size:
        raise MessageError(f"data has {len(data)} bytes, less than the header of compressedDepth")
    _, a, b = CONFIG_HEADER.unpack_from(data.data)
    return data[CONFIG_HEADER.size :], None if encoding in MILLIMETRES else (a, b)


def _png_size(data: ByteArray) -> tuple[int, int]:
    """Width and height of a PNG of 16-bit grey, after a look at whether it can hold them."""
    if len(data) < PNG_HEADER.size or data[:8].tobytes() != PNG_MAGIC:
        raise MessageError("the compressed image is no PNG")
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


def _decoded_png(data: ByteArray) -> NDArray[Any]:
    import cv2

    width, height = _png_size(data)
    _check_chunks(data)
    try:
        raw = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise MessageError("the PNG is broken") from error
    if raw is None or raw.shape != (height, width) or raw.dtype != np.uint16:
        raise MessageError("the PNG is broken")
    return np.asarray(raw)
