"""Depth images: sensor_msgs/Image, and sensor_msgs/CompressedImage as compressed_depth_image_transport writes it."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import ByteArray, FloatArray
from flatgrasp_cli.recordings.messages.decoded import ROW_STEP_IGNORED, Assumption, MessageError, raw_bytes, reading
from flatgrasp_cli.recordings.messages.png import LOSSY, decode_png, png_size
from flatgrasp_cli.recordings.messages.rvl import decode_rvl, rvl_size

MILLIMETRES = frozenset({"16UC1", "mono16"})
METRES = frozenset({"32FC1"})
MILLIMETRE = 0.001
FULL_SCALE = 65_535
"""What some drivers write for no reading: no 16-bit sensor measures its last count."""
CONFIG_HEADER = struct.Struct("<iff")
"""compressedDepth puts before the PNG or the RVL: a format that nobody sets, and the quantisation's A and B."""


@dataclass(frozen=True, slots=True, eq=False)
class DepthImage:
    """`raw` (height, width) as recorded, uint16 or float32, in `unit_m`; `inverse` is A and B of inverse depth."""

    raw: NDArray[Any]
    unit_m: float
    inverse: tuple[float, float] | None = None
    assumptions: tuple[Assumption, ...] = ()

    def metres(self, unit_m: float | None = None) -> tuple[FloatArray, NDArray[np.intp]]:
        """Depths (n,) in metres, and the pixels (n,) they are at, counted row by row; only where there is depth.

        `unit_m` says what one count is; if None, it is what the encoding says.
        """
        raw = self.raw.reshape(-1)
        with np.errstate(invalid="ignore"):
            pixels = np.flatnonzero((raw > 0) & np.isfinite(raw))
        if raw.dtype == np.uint16 and self.inverse is None:
            pixels = pixels[raw[pixels] < FULL_SCALE]
        depth = raw[pixels].astype(np.float64)
        if self.inverse is not None:
            a, b = self.inverse
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                depth = a / (depth - b)
            seen = np.isfinite(depth) & (depth > 0)
            depth, pixels = depth[seen], pixels[seen]
        depth *= self.unit_m if unit_m is None else unit_m
        return depth, pixels


def is_depth(message: Any) -> bool:
    """Whether an Image or CompressedImage holds depth; colour images are of the same types."""
    if hasattr(message, "format"):
        encoding, how = _compression(message)
        return "compresseddepth" in how or (encoding in MILLIMETRES and "png" in how)
    return str(getattr(message, "encoding", "")) in MILLIMETRES | METRES


def is_lossy_depth(message: Any) -> bool:
    """Whether a CompressedImage holds depth that JPEG has destroyed."""
    encoding, how = _compression(message) if hasattr(message, "format") else ("", "")
    return encoding in MILLIMETRES | METRES and ("jpeg" in how or "jpg" in how)


def image_size(message: Any) -> tuple[int, int]:
    """Width and height that the message, or what is compressed in it, declares."""
    with reading("image"):
        if not hasattr(message, "format"):
            return int(message.width), int(message.height)
        data, codec, _ = _unpacked(message)
        return rvl_size(data) if codec == "rvl" else png_size(data)


def read_depth(message: Any) -> DepthImage:
    """The depth image in a message.

    Raises
    ------
    MessageError
        If the message holds no depth, less data than it declares, a PNG or RVL that is broken, or another encoding.
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
    unit_m = MILLIMETRE if encoding in MILLIMETRES else 1.0
    dtype = np.dtype("u2" if encoding in MILLIMETRES else "f4").newbyteorder(">" if message.is_bigendian else "<")
    if min(height, width) <= 0:
        return DepthImage(np.empty((0, 0), dtype), unit_m)
    row = width * dtype.itemsize
    data = raw_bytes(message.data)
    ignored = step != row and len(data) == height * row and height > 1  # with padding there would be more
    step = row if ignored else step
    if step < row:
        raise MessageError(f"step is {step}, but {width} pixels of {dtype.itemsize} bytes need {row}")
    need = (height - 1) * step + row  # the padding of the last row may be left out
    if len(data) < need:
        raise MessageError(f"data has {len(data)} bytes, {width} × {height} pixels in rows of {step} bytes need {need}")
    raw: NDArray[Any] = np.ndarray((height, width), dtype, data.data, 0, (step, dtype.itemsize))
    return DepthImage(raw, unit_m, assumptions=(ROW_STEP_IGNORED,) if ignored else ())


def _compressed(message: Any) -> DepthImage:
    encoding, _ = _compression(message)
    data, codec, inverse = _unpacked(message)
    raw = decode_rvl(data) if codec == "rvl" else decode_png(data)
    return DepthImage(raw, MILLIMETRE if encoding in MILLIMETRES else 1.0, inverse)


def _compression(message: Any) -> tuple[str, str]:
    """The encoding and the rest of a format such as "16UC1; compressedDepth png"; both may be written in any case."""
    encoding, _, how = str(message.format).partition(";")
    return encoding.strip(), how.strip().lower()


def _unpacked(message: Any) -> tuple[ByteArray, str, tuple[float, float] | None]:
    """The PNG or RVL in a CompressedImage, which of the two, and the quantisation where it holds inverse depth."""
    encoding, how = _compression(message)
    data = raw_bytes(message.data)
    if is_lossy_depth(message):
        raise MessageError(f"is {LOSSY}")
    if not is_depth(message) or encoding not in MILLIMETRES | METRES:
        raise MessageError(f"has format {message.format!r}, which is no depth; depth is 16UC1 or 32FC1 compressedDepth")
    if "compresseddepth" not in how:
        return data, "png", None
    if len(data) < CONFIG_HEADER.size:
        raise MessageError(f"data has {len(data)} bytes, less than the header of compressedDepth")
    _, a, b = CONFIG_HEADER.unpack_from(data.data)
    codec = "rvl" if "rvl" in how else "png"
    return data[CONFIG_HEADER.size :], codec, None if encoding in MILLIMETRES else (a, b)
