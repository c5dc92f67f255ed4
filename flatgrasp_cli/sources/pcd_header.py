"""The header of a PCD file, checked against the bytes that follow it.

Format: PCL's "The PCD (Point Cloud Data) file format", version 0.7; and .5, which called the fields columns.
"""

from __future__ import annotations

import math
import re
import struct
from dataclasses import dataclass, replace
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.sources.text_lines import ends_in_cr, read_line, shown, skip_byte_order_mark

BEGINNING = re.compile(rb"\s*(#|VERSION|FIELDS|COLUMNS)", re.IGNORECASE)
FIELDS_LINE = re.compile(rb"(^|[\r\n])[ \t]*(FIELDS|COLUMNS)\s", re.IGNORECASE)
MAX_LINES = 200
MAX_LINE_BYTES = 65_536
LEGAL_TYPES = {"F4", "F8", "I1", "I2", "I4", "I8", "U1", "U2", "U4", "U8"}
MAX_LZF_RATIO = 133
"""LZF copies at most 264 bytes for a two- or three-byte reference."""
SIZES = struct.Struct("<II")
"""What compressed data begin with: their size, and that of what they unpack to."""


@dataclass(frozen=True, slots=True)
class PcdHeader:
    """What a PCD file says of itself; `begin` is the offset of its data."""

    fields: tuple[str, ...]
    types: tuple[str, ...]
    counts: tuple[int, ...]
    width: int
    height: int
    viewpoint: tuple[float, ...]
    points: int
    data: str
    begin: int
    cr: bool
    """Whether lines end in a carriage return alone."""

    @property
    def axes(self) -> tuple[int, ...]:
        """Places of x, y and z among the fields."""
        return tuple(_places(self.fields, axis)[0] for axis in "xyz")

    @property
    def stride(self) -> int:
        """Bytes a point in binary data."""
        return sum(int(kind[1:]) * count for kind, count in zip(self.types, self.counts, strict=True))

    @property
    def viewpoint_pose(self) -> Frame | None:
        """VIEWPOINT, x y z and a quaternion w first, as a frame; None for a position of zeros, which says nothing."""
        x, y, z, qw, qx, qy, qz = self.viewpoint
        if (x, y, z) == (0.0, 0.0, 0.0):
            return None
        norm = math.hypot(qw, qx, qy, qz)
        turn = np.array([qx, qy, qz, qw]) / norm if 0.0 < norm < math.inf else np.array([0.0, 0.0, 0.0, 1.0])
        return Frame(np.array([x, y, z]), axes_from_quaternion(turn))

    def columns(self) -> tuple[int, ...]:
        """Places of x, y and z among a point's numbers."""
        return tuple(sum(self.counts[:place]) for place in self.axes)

    def axis_types(self) -> list[np.dtype[np.generic]]:
        """Types of x, y and z in binary data, which is little-endian."""
        return [np.dtype("<" + self.types[place].lower()) for place in self.axes]

    def offsets(self) -> list[int]:
        """How many bytes of a point come before its x, y and z."""
        sizes = [int(kind[1:]) * count for kind, count in zip(self.types, self.counts, strict=True)]
        return [sum(sizes[:place]) for place in self.axes]

    def point_dtype(self) -> np.dtype[np.void]:
        """X, y and z of a point in binary data as a numpy record type."""
        formats, offsets = self.axis_types(), self.offsets()
        return np.dtype({"names": list("xyz"), "formats": formats, "offsets": offsets, "itemsize": self.stride})


def is_pcd(head: bytes) -> bool:
    """Whether a file that begins so is a PCD file."""
    return BEGINNING.match(head) is not None and FIELDS_LINE.search(head) is not None


def read_pcd_header(file: BinaryIO, name: str) -> PcdHeader:
    """Read a PCD header and check it; the file is left at its data.

    Raises
    ------
    SourceError
        If a line is missing or malformed, or lines contradict each other.
    """
    skip_byte_order_mark(file)
    cr = ends_in_cr(file)
    lines = _header_lines(file, name, cr)
    try:
        header = _parse(lines, file.tell(), cr)
    except KeyError as error:
        raise SourceError(f"{name}: the PCD header has no {error.args[0]} line") from error
    except (ValueError, IndexError) as error:
        raise SourceError(f"{name}: the PCD header is malformed: {shown(error)}") from error
    _check_axes(header, name)
    header = _with_counts(file, header)
    wrong = [kind for kind, count in zip(header.types, header.counts, strict=True) if count and kind not in LEGAL_TYPES]
    if wrong:
        raise SourceError(
            f"{name}: the PCD header has a field of TYPE and SIZE {shown(wrong[0])}; legal are F 4, F 8, "
            "and I or U with 1, 2, 4, 8"
        )
    return header


def check_pcd_data(file: BinaryIO, header: PcdHeader, name: str) -> bool:
    """Check that a file holds the binary points that its header declares, without reading them; whether there are more.

    Raises
    ------
    SourceError
        If there are fewer, or compressed data contradict the header.
    """
    size = file.seek(0, 2) - header.begin
    file.seek(header.begin)
    if header.data == "binary_compressed":
        _check_compressed(file, header, size - SIZES.size, name)
        return False
    needed = header.points * header.stride
    _expect(needed, size, header.points, name)
    return size - needed >= header.stride


def _header_lines(file: BinaryIO, name: str, cr: bool) -> dict[str, list[str]]:
    lines: dict[str, list[str]] = {}
    for _ in range(MAX_LINES):
        text = read_line(file, MAX_LINE_BYTES, cr=cr).decode("latin-1")
        words = text.split("#")[0].split()
        if words:
            lines[words[0].upper()] = words[1:]
        if not text or (words and words[0].upper() == "DATA"):
            break
    if "DATA" not in lines:
        raise SourceError(f"{name}: the PCD header ends without a DATA line")
    return lines


def _parse(lines: dict[str, list[str]], begin: int, cr: bool) -> PcdHeader:
    fields = tuple(lines["FIELDS"] if "FIELDS" in lines else lines["COLUMNS"])
    if not len(fields) == len(lines["SIZE"]) == len(lines["TYPE"]) == len(lines.get("COUNT", fields)):
        raise ValueError("FIELDS, SIZE, TYPE and COUNT must have equally many entries")
    types = tuple(f"{kind.upper()}{int(size)}" for kind, size in zip(lines["TYPE"], lines["SIZE"], strict=True))
    counts = tuple(int(count) for count in lines.get("COUNT", ["1"] * len(fields)))
    if min(counts, default=0) < 0:
        raise ValueError(f"COUNT {' '.join(map(str, counts))} has a negative entry")
    if "WIDTH" not in lines and lines.get("POINTS"):  # version .5 knows no images
        lines = lines | {"WIDTH": lines["POINTS"]}
    width, height = int(lines["WIDTH"][0]), int(lines.get("HEIGHT", ["1"])[0])
    points = int(lines["POINTS"][0]) if lines.get("POINTS") else width * height
    viewpoint = tuple(float(word) for word in lines.get("VIEWPOINT", ["0", "0", "0", "1", "0", "0", "0"]))
    if len(viewpoint) != 7 or not all(map(math.isfinite, viewpoint)):
        raise ValueError("VIEWPOINT needs seven finite numbers: x y z qw qx qy qz")
    if min(width, height, points) < 0 or width * height != points:
        raise ValueError(f"WIDTH {width} × HEIGHT {height} is not POINTS {points}")
    data = " ".join(lines["DATA"]).lower()
    if data not in ("ascii", "binary", "binary_compressed"):
        raise ValueError(f"DATA {' '.join(lines['DATA'])} is none of ascii, binary, binary_compressed")
    return PcdHeader(
        fields=fields,
        types=types,
        counts=counts,
        width=width,
        height=height,
        viewpoint=viewpoint,
        points=points,
        data=data,
        begin=begin,
        cr=cr,
    )


def _places(fields: tuple[str, ...], axis: str) -> list[int]:
    """Places of the fields called x, or X if there are none."""
    exact = [place for place, field in enumerate(fields) if field == axis]
    return exact or [place for place, field in enumerate(fields) if field.lower() == axis]


def _check_axes(header: PcdHeader, name: str) -> None:
    if any(len(_places(header.fields, axis)) != 1 for axis in "xyz"):
        raise SourceError(
            f"{name}: needs one field each of x, y and z; its fields are: {shown(' '.join(header.fields))}"
        )
    if any(header.counts[place] > 1 for place in header.axes):
        raise SourceError(f"{name}: the fields x, y and z must have COUNT 1")


def _with_counts(file: BinaryIO, header: PcdHeader) -> PcdHeader:
    """The header without COUNT 0, and the file at its data.

    Some write COUNT 0 for padding of no bytes, others, as old messages of ROS did, for a single value. The data tell.
    """
    if 0 not in header.counts:
        return header
    counts = tuple(count or int(place in header.axes) for place, count in enumerate(header.counts))
    padding = replace(header, counts=counts)
    single = replace(header, counts=tuple(count or 1 for count in header.counts))
    is_single = _holds(file, single) and not _holds(file, padding)
    file.seek(header.begin)
    return single if is_single else padding


def _holds(file: BinaryIO, header: PcdHeader) -> bool:
    """Whether the data are exactly as long as the header says; of text, the first row."""
    if header.data == "ascii":
        file.seek(header.begin)
        return len(read_line(file, MAX_LINE_BYTES, cr=header.cr).split()) == sum(header.counts)
    if header.data == "binary":
        return file.seek(0, 2) - header.begin == header.points * header.stride
    file.seek(header.begin)
    sizes = file.read(SIZES.size)
    return len(sizes) == SIZES.size and SIZES.unpack(sizes)[1] == header.points * header.stride


def _expect(needed: int, found: int, points: int, name: str) -> None:
    if found < needed:
        raise SourceError(
            f"{name}: the header declares {points} points ({needed} bytes), the file has {found} bytes of data; "
            "it is truncated or its header is wrong"
        )


def _check_compressed(file: BinaryIO, header: PcdHeader, found: int, name: str) -> None:
    if found < 0:
        _expect(SIZES.size, found + SIZES.size, header.points, name)
    compressed, unpacked = SIZES.unpack(file.read(SIZES.size))
    _expect(compressed, found, header.points, name)
    if unpacked != header.points * header.stride or unpacked > compressed * MAX_LZF_RATIO:
        raise SourceError(
            f"{name}: the header declares {header.points} points ({header.points * header.stride} bytes), "
            f"the compressed data {compressed} bytes that unpack to {unpacked}"
        )
