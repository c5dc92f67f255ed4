"""The header of a PCD file, checked against the bytes that follow it.

Format: PCL's "The PCD (Point Cloud Data) file format", version 0.7.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.sources.ascii_rows import check_rows

MAX_LINES = 200
MAX_LINE_BYTES = 65_536
LEGAL_TYPES = {"F4", "F8", "I1", "I2", "I4", "I8", "U1", "U2", "U4", "U8"}
MAX_LZF_RATIO = 133
"""LZF copies at most 264 bytes for a two- or three-byte reference."""


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

    def column(self, name: str) -> int:
        """Place of a field's first number among a point's numbers."""
        return sum(self.counts[: self.fields.index(name)])

    def point_dtype(self) -> np.dtype[np.void]:
        """X, y and z of a point in binary data, which is little-endian, as a numpy record type."""
        sizes = [int(kind[1:]) * count for kind, count in zip(self.types, self.counts, strict=True)]
        places = [self.fields.index(axis) for axis in "xyz"]
        return np.dtype(
            {
                "names": ["x", "y", "z"],
                "formats": ["<" + self.types[place].lower() for place in places],
                "offsets": [sum(sizes[:place]) for place in places],
                "itemsize": self.stride,
            }
        )

    def renamed(self) -> bytes:
        """A header for the same data in which x, y and z keep their names and nothing else has one with a meaning.

        Open3D takes names such as normal_x or positions for attributes of its own and crashes when the rest of such an
        attribute is missing.
        """
        names = [name if name in ("x", "y", "z") else f"other{k}" for k, name in enumerate(self.fields)]
        lines = {
            "VERSION": "0.7",
            "FIELDS": " ".join(names),
            "SIZE": " ".join(kind[1:] for kind in self.types),
            "TYPE": " ".join(kind[0] for kind in self.types),
            "COUNT": " ".join(map(str, self.counts)),
            "WIDTH": str(self.points),
            "HEIGHT": "1",
            "VIEWPOINT": "0 0 0 1 0 0 0",
            "POINTS": str(self.points),
            "DATA": self.data,
        }
        return "".join(f"{key} {value}\n" for key, value in lines.items()).encode()


def read_pcd_header(file: BinaryIO, name: str) -> PcdHeader:
    """Read a PCD header and check it; the file is left at its data.

    Raises
    ------
    SourceError
        If a line is missing or malformed, or lines contradict each other.
    """
    lines = _header_lines(file, name)
    try:
        header = _parse(lines, file.tell())
    except KeyError as error:
        raise SourceError(f"{name}: the PCD header has no {error.args[0]} line") from error
    except (ValueError, IndexError) as error:
        raise SourceError(f"{name}: the PCD header is malformed: {error}") from error
    _check_fields(header, name)
    return header


def check_pcd_data(file: BinaryIO, header: PcdHeader, name: str) -> None:
    """Check that the file holds the points that its header declares, without reading them into memory."""
    size = file.seek(0, 2) - header.begin
    file.seek(header.begin)
    if header.data == "ascii":
        check_rows(file, header.points, sum(header.counts), name, to_end=True)
    elif header.data == "binary":
        _expect(header.points * header.stride, size, header.points, name)
    else:
        _check_compressed(file, header, size - 8, name)


def _header_lines(file: BinaryIO, name: str) -> dict[str, list[str]]:
    lines: dict[str, list[str]] = {}
    for _ in range(MAX_LINES):
        text = file.readline(MAX_LINE_BYTES).decode("latin-1")
        words = text.split("#")[0].split()
        if words:
            lines[words[0].upper()] = words[1:]
        if not text or (words and words[0].upper() == "DATA"):
            break
    if "DATA" not in lines:
        raise SourceError(f"{name}: the PCD header ends without a DATA line")
    return lines


def _parse(lines: dict[str, list[str]], begin: int) -> PcdHeader:
    fields = tuple(lines["FIELDS"])
    if not len(fields) == len(lines["SIZE"]) == len(lines["TYPE"]) == len(lines.get("COUNT", fields)):
        raise ValueError("FIELDS, SIZE, TYPE and COUNT must have equally many entries")
    types = tuple(kind + size for kind, size in zip(lines["TYPE"], lines["SIZE"], strict=True))
    counts = tuple(int(count) for count in lines.get("COUNT", ["1"] * len(fields)))
    width, height = int(lines["WIDTH"][0]), int(lines.get("HEIGHT", ["1"])[0])
    points = int(lines["POINTS"][0]) if lines.get("POINTS") else width * height
    viewpoint = tuple(float(word) for word in lines.get("VIEWPOINT", ["0", "0", "0", "1", "0", "0", "0"]))
    if len(viewpoint) != 7 or not all(map(math.isfinite, viewpoint)):
        raise ValueError("VIEWPOINT needs seven finite numbers: x y z qw qx qy qz")
    if min(width, height, points) < 0 or width * height != points:
        raise ValueError(f"WIDTH {width} × HEIGHT {height} is not POINTS {points}")
    if not lines["DATA"] or lines["DATA"][0] not in ("ascii", "binary", "binary_compressed"):
        raise ValueError(f"DATA {' '.join(lines['DATA'])} is none of ascii, binary, binary_compressed")
    return PcdHeader(fields, types, counts, width, height, viewpoint, points, lines["DATA"][0], begin)


def _check_fields(header: PcdHeader, name: str) -> None:
    missing = [axis for axis in "xyz" if header.fields.count(axis) != 1]
    if missing:
        raise SourceError(f"{name}: needs one field each of x, y and z; its fields are: {' '.join(header.fields)}")
    wrong = [kind for kind in header.types if kind not in LEGAL_TYPES]
    if wrong or min(header.counts) < 1:
        raise SourceError(f"{name}: the PCD header has a field of no legal TYPE, SIZE or COUNT: {' '.join(wrong)}")
    axes = {(header.types[k], header.counts[k]) for k in (header.fields.index(axis) for axis in "xyz")}
    if len(axes) > 1 or next(iter(axes))[1] != 1:
        raise SourceError(f"{name}: the fields x, y and z must have one type and COUNT 1")


def _expect(needed: int, found: int, points: int, name: str) -> None:
    if found < needed:
        raise SourceError(
            f"{name}: the header declares {points} points ({needed} bytes), the file has {found} bytes of data; "
            "it is truncated or its header is wrong"
        )


def _check_compressed(file: BinaryIO, header: PcdHeader, found: int, name: str) -> None:
    if found < 0:
        _expect(8, found + 8, header.points, name)
    compressed, unpacked = struct.unpack("<II", file.read(8))
    _expect(compressed, found, header.points, name)
    if unpacked != header.points * header.stride or unpacked > compressed * MAX_LZF_RATIO:
        raise SourceError(
            f"{name}: the header declares {header.points} points ({header.points * header.stride} bytes), "
            f"the compressed data {compressed} bytes that unpack to {unpacked}"
        )
