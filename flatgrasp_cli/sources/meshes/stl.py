"""STL: triangles, in text or binary."""

from __future__ import annotations

import re
import struct
from array import array
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.sources.meshes.mesh import Polygons
from flatgrasp_cli.sources.meshes.text import floats, malformed, words_of

TEXT = re.compile(rb"\s*solid\b", re.IGNORECASE)
FACET = re.compile(rb"[\r\n]\s*(facet|endsolid)\b", re.IGNORECASE)
HEADER = struct.Struct("<80sI")
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def is_stl(head: bytes, size: int) -> bool:
    """Whether a file of `size` bytes that begins so is an STL file; its size tells a binary one."""
    return _is_binary(head, size) or _is_text(head)


def _is_binary(head: bytes, size: int) -> bool:
    return len(head) >= HEADER.size and size == HEADER.size + RECORD.itemsize * HEADER.unpack_from(head)[1]


def _is_text(head: bytes) -> bool:
    return TEXT.match(head) is not None and FACET.search(head) is not None


def read_stl(file: BinaryIO, name: str) -> Polygons:
    """Read the surface of an STL file; many binary ones begin with "solid" as those in text do.

    Raises
    ------
    SourceError
        If it is cut off, malformed, or has no triangles with an area.
    """
    size = file.seek(0, 2)
    file.seek(0)
    head = file.read(4096)
    file.seek(0)
    if _is_binary(head, size):
        vertices = np.frombuffer(file.read(), dtype=RECORD, offset=HEADER.size)["corners"].reshape(-1, 3)
    elif _is_text(head):
        vertices = _text_vertices(file, name)
    else:
        count = HEADER.unpack_from(head)[1] if len(head) >= HEADER.size else 0
        raise SourceError(
            f"{name}: as a binary STL file it declares {count} triangles ({HEADER.size + RECORD.itemsize * count} "
            f"bytes), it has {size} bytes; it is truncated or no STL file"
        )
    if not len(vertices):
        raise SourceError(f"{name}: the mesh has no triangles")
    corners = np.arange(len(vertices))
    return Polygons(vertices, corners, np.full(len(vertices) // 3, 3))


def _text_vertices(file: BinaryIO, name: str) -> FloatArray:
    """The corners (3 n, 3) of the triangles, in their order."""
    coordinates = array("d")
    corners, ended = 0, False
    for line in words_of(file):
        keyword, *words = line[1]
        keyword = keyword.lower()
        ended = keyword == b"endsolid" or (ended and keyword != b"solid")
        if keyword == b"vertex":
            if len(words) != 3:
                raise malformed(line, name)
            coordinates.extend(floats(words, line, name))
            corners += 1
        elif keyword == b"endfacet":
            if corners != 3:
                raise SourceError(f"{name}: the facet that ends in line {line[0]} has {corners} corners, not three")
            corners = 0
        elif keyword not in (b"solid", b"facet", b"outer", b"endloop", b"endsolid"):
            raise malformed(line, name)
    if corners or not ended:
        raise SourceError(f"{name}: the STL file ends without an endsolid line; it is truncated")
    return np.array(coordinates, dtype=np.float64).reshape(-1, 3)
