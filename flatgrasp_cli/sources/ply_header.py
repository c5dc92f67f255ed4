"""The header of a PLY file.

Format: G. Turk, "The PLY Polygon File Format", 1994.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import BinaryIO

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sources.text_lines import ends_in_cr, read_line, shown, skip_byte_order_mark

BEGINNING = re.compile(rb"ply[ \t]*[\r\n]", re.IGNORECASE)
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
class PlyProperty:
    """One value of a record, or, with a `count_code`, a list of them behind their number; codes are numpy's."""

    name: str
    code: str
    count_code: str | None = None


@dataclass(frozen=True, slots=True)
class PlyElement:
    """One kind of record, and how many of them there are."""

    name: str
    count: int
    properties: tuple[PlyProperty, ...] = ()

    @property
    def has_lists(self) -> bool:
        """Whether records differ in length."""
        return any(item.count_code for item in self.properties)

    def places(self, name: str) -> list[int]:
        """Places of the properties called x, or X if there are none."""
        exact = [place for place, item in enumerate(self.properties) if item.name == name]
        return exact or [place for place, item in enumerate(self.properties) if item.name.lower() == name]


@dataclass(frozen=True, slots=True)
class PlyHeader:
    """What a PLY file says of itself; `cr` tells that lines end in a carriage return alone."""

    format: str
    elements: tuple[PlyElement, ...]
    cr: bool

    def element(self, name: str) -> PlyElement | None:
        """The element of that name, the first if there are several."""
        return next((element for element in self.elements if element.name == name), None)


def is_ply(head: bytes) -> bool:
    """Whether a file that begins so is a PLY file."""
    return BEGINNING.match(head) is not None


def read_ply_header(file: BinaryIO, name: str) -> PlyHeader:
    """Read a PLY header and check it; the file is left at its data.

    Raises
    ------
    SourceError
        If it is malformed, or has no vertices with x, y and z.
    """
    skip_byte_order_mark(file)
    cr = ends_in_cr(file)
    try:
        form, elements = _parse(_header_lines(file, name, cr))
    except (ValueError, IndexError) as error:
        raise SourceError(f"{name}: the PLY header is malformed: {shown(error)}") from error
    header = PlyHeader(form, elements, cr)
    vertices = [element for element in elements if element.name == "vertex"]
    if len(vertices) != 1:
        raise SourceError(f"{name}: the PLY file has no vertices; its elements: {shown([e.name for e in elements])}")
    axes = [vertices[0].places(axis) for axis in "xyz"]
    if any(len(places) != 1 or vertices[0].properties[places[0]].count_code for places in axes):
        names = " ".join(item.name for item in vertices[0].properties)
        raise SourceError(f"{name}: the vertices need one property each of x, y and z; they have: {shown(names)}")
    return header


def _header_lines(file: BinaryIO, name: str, cr: bool) -> list[list[str]]:
    lines: list[list[str]] = []
    for _ in range(MAX_LINES):
        words = read_line(file, MAX_LINE_BYTES, cr=cr).decode("latin-1").split()
        if [word.lower() for word in words] == ["end_header"]:
            return lines
        lines.append(words)
    raise SourceError(f"{name}: the PLY header does not end")


def _parse(lines: list[list[str]]) -> tuple[str, tuple[PlyElement, ...]]:
    form = ""
    elements: list[PlyElement] = []
    for words in lines[1:]:
        keyword = words[0].lower() if words else "comment"
        if keyword in ("comment", "obj_info"):
            continue
        if keyword == "format":
            form = words[1].lower()
        elif keyword == "element":
            elements.append(PlyElement(words[1].lower(), int(words[2])))
        elif keyword == "property":
            elements[-1] = replace(elements[-1], properties=(*elements[-1].properties, _property(words[1:])))
        else:
            raise ValueError(f"unknown line {' '.join(words)[:40]!r}")
    if form not in FORMATS:
        raise ValueError(f"format {form!r} is none of {', '.join(FORMATS)}")
    if any(element.count < 0 for element in elements):
        raise ValueError("a negative count")
    return form, tuple(elements)


def _property(words: list[str]) -> PlyProperty:
    if words[0].lower() == "list":
        count = _code(words[1])
        if count.startswith("f"):
            raise ValueError(f"a list of {words[1]} entries: their number is an integer")
        return PlyProperty(words[3], _code(words[2]), count)
    return PlyProperty(words[1], _code(words[0]))


def _code(word: str) -> str:
    if word.lower() not in CODES:
        raise ValueError(f"unknown type {word!r}")
    return CODES[word.lower()]
