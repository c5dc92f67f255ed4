"""TIFF with one channel: what it declares is held against what it can hold before OpenCV decodes it.

Format: Adobe's "TIFF, Revision 6.0", 1992.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.recordings.messages import MessageError

MAGICS = {b"II*\0": "<", b"MM\0*": ">"}
ENTRY_BYTES = 12
SHORT, LONG = 3, 4
WIDTH, HEIGHT, BITS, COMPRESSION, SAMPLES = 256, 257, 258, 259, 277
UNCOMPRESSED = 1
MOST_RATIO = 4096
"""No byte of a compressed TIFF stands for more bytes of its image: LZW's codes of twelve bits are the densest."""


def tiff_size(data: bytes) -> tuple[int, int]:
    """Width and height of the first page, after a look at whether it can be depth and the file can hold it.

    Raises
    ------
    MessageError
        If it has colours, or too few bits or bytes.
    """
    tags = _first_page(data)
    width, height, bits = tags.get(WIDTH, 0), tags.get(HEIGHT, 0), tags.get(BITS, 1)
    if tags.get(SAMPLES, 1) != 1:
        raise MessageError(f"the TIFF has {tags[SAMPLES]} channels; depth has one")
    if bits not in (16, 32, 64):
        raise MessageError(f"the TIFF has {bits} bits a pixel; depth has 16, or 32 or 64 as a float")
    ratio = 1 if tags.get(COMPRESSION, UNCOMPRESSED) == UNCOMPRESSED else MOST_RATIO
    if min(width, height) < 1 or width * height * bits // 8 > len(data) * ratio:
        raise MessageError(f"the TIFF has {len(data)} bytes, which cannot hold {width} × {height} pixels")
    return width, height


def decode_tiff(data: bytes) -> NDArray[Any]:
    """The image (height, width) of the first page: integers of 16 or 32 bits, or floats.

    Raises
    ------
    MessageError
        If it is broken or of a kind that OpenCV does not read.
    """
    import cv2

    width, height = tiff_size(data)
    with _quiet():
        try:
            raw = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
        except cv2.error:
            raw = None
    if raw is None or raw.shape != (height, width):
        raise MessageError("the TIFF is broken, or of a kind that OpenCV does not read")
    return np.asarray(raw)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep OpenCV from printing what is wrong with a file: we say it."""
    import cv2

    before = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        yield
    finally:
        cv2.utils.logging.setLogLevel(before)


def _first_page(data: bytes) -> dict[int, int]:
    """The tags of the first page that are a number of 16 or 32 bits."""
    order = MAGICS[data[:4]]
    try:
        (begin,) = struct.unpack_from(order + "I", data, 4)
        (count,) = struct.unpack_from(order + "H", data, begin)
        entries = [struct.unpack_from(order + "HHI", data, begin + 2 + ENTRY_BYTES * k) for k in range(count)]
        places = [begin + 2 + ENTRY_BYTES * k + 8 for k in range(count)]
        return {
            tag: struct.unpack_from(order + ("H" if kind == SHORT else "I"), data, place)[0]
            for (tag, kind, values), place in zip(entries, places, strict=True)
            if kind in (SHORT, LONG) and values == 1
        }
    except struct.error as error:
        raise MessageError(f"the TIFF is cut off after {len(data)} bytes") from error
