"""The header of a PLY file, checked against the bytes that follow it.

Format: G. Turk, "The PLY Polygon File Format", 1994.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sources.ascii_rows import check_rows

MAX_LINES = 1000
MAX_LINE_BYTES = 65_536
FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")
CODES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
"""numpy's codes of PLY's types, without byte order."""


@dataclass(frozen=True, slots=True)
class PlyElement:
    """One kind of record: `properties` are (name, type) pairs, `lists` tells that some are lists."""

    name: str
    count: int
    properties: tuple[tuple[str, str], ...]
    lists: bool

    @property
    def stride(self) -> int:
        """Bytes a record in binary data."""
        return sum(int(CODES[kind][1:]) for _, kind in self.properties)

    def column(self, name: str) -> int:
        """Place of a property among the record's numbers."""
        return [key for key, _ in self.properties].index(name)


@dataclass(frozen=True, slots=True)
class PlyHeader:
    """What a PLY file says of itself; its data begin at offset `begin`."""

    format: str
    elements: tuple[PlyElement, ...]
    begin: int

    @property
    def vertex(self) -> PlyElement:
        """The element with the points."""
        return next(element for element in self.elements if element.name == "vertex")

    @property
    def before_vertex(self) -> tuple[PlyElement, ...]:
        """The elements stored before the points."""
        return self.elements[: self.elements.index(self.vertex)]

    def vertex_dtype(self) -> np.dtype[np.void]:
        """The vertices of binary data as a numpy record type."""
        order = ">" if self.format == "binary_big_endian" else "<"
        return np.dtype([(name, order + CODES[kind]) for name, kind in self.vertex.properties])


def read_ply_header(file: BinaryIO, name: str) -> PlyHeader:
    """Read a PLY header and check it; the file is left at its data.

    Raises
    ------
    SourceError
        If it is malformed, or has no vertices with x, y and z.
    """
    words = [line.split() for line in _header_lines(file, name)]
    try:
        form, elements = _parse(words)
    except (ValueError, IndexError, KeyError) as error:
        raise SourceError(f"{name}: the PLY header is malformed: {error}") from error
    header = PlyHeader(form, elements, file.tell())
    vertices = [element for element in elements if element.name == "vertex"]
    if len(vertices) != 1:
        raise SourceError(f"{name}: the PLY file has no vertices; its elements: {[e.name for e in elements]}")
    names = [key for key, _ in vertices[0].properties]
    if len(set(names)) < len(names) or any(axis not in names for axis in "xyz"):
        raise SourceError(f"{name}: the vertices need one property each of x, y and z; they have: {' '.join(names)}")
    if any(element.lists for element in (*header.before_vertex, vertices[0])):
        raise SourceError(f"{name}: has lists in or before its vertices; save it again with the vertices first")
    return header


def seek_vertices(file: BinaryIO, header: PlyHeader, name: str) -> int:
    """Move the file to its vertices, check that all are there, and return how many bytes they take."""
    size = file.seek(0, 2)
    file.seek(header.begin)
    if header.format == "ascii":
        for element in header.before_vertex:
            check_rows(file, element.count, len(element.properties), name, to_end=False)
        begin = file.tell()
        check_rows(
            file,
            header.vertex.count,
            len(header.vertex.properties),
            name,
            to_end=header.elements[-1:] == (header.vertex,),
        )
        end = file.tell()
    else:
        begin = header.begin + sum(element.count * element.stride for element in header.before_vertex)
        end = begin + header.vertex.count * header.vertex.stride
        if end > size:
            raise SourceError(
                f"{name}: the header declares {header.vertex.count} points, which end at byte {end}; "
                f"the file has {size} bytes: it is truncated or its header is wrong"
            )
    file.seek(begin)
    return end - begin


def _header_lines(file: BinaryIO, name: str) -> list[str]:
    lines: list[str] = []
    for _ in range(MAX_LINES):
        line = file.readline(MAX_LINE_BYTES).decode("latin-1").strip()
        if line == "end_header":
            return lines
        lines.append(line)
    raise SourceError(f"{name}: the PLY header does not end")


def _parse(lines: list[list[str]]) -> tuple[str, tuple[PlyElement, ...]]:
    form = ""
    elements: list[PlyElement] = []
    for words in lines[1:]:
        if not words or words[0] in ("comment", "obj_info"):
            continue
        if words[0] == "format":
            form = words[1]
        elif words[0] == "element":
            elements.append(PlyElement(words[1], int(words[2]), (), lists=False))
        elif words[0] == "property":
            elements[-1] = _with_property(elements[-1], words[1:])
        else:
            raise ValueError(f"unknown line {' '.join(words)!r}")
    if form not in FORMATS:
        raise ValueError(f"format {form!r} is none of {', '.join(FORMATS)}")
    if any(element.count < 0 for element in elements):
        raise ValueError("a negative count")
    return form, tuple(elements)


def _with_property(element: PlyElement, words: list[str]) -> PlyElement:
    if words[0] == "list":
        return PlyElement(element.name, element.count, element.properties, lists=True)
    if words[0] not in CODES:
        raise ValueError(f"unknown type {words[0]!r}")
    return PlyElement(element.name, element.count, (*element.properties, (words[1], words[0])), element.lists)
