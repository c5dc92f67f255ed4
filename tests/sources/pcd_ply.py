"""PCD and PLY files written value by value, and what is read back of them."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources import read_clouds

Table = NDArray[np.void]
Dtype = list[tuple[Any, ...]]

N = 208
POINTS: FloatArray = np.random.default_rng(7).integers(-200, 200, (N, 3)) / 1024.0
"""Exact in float32 and in a few decimals, so that nothing but equality will do."""
FINE: FloatArray = 1000.0 + np.random.default_rng(8).random((N, 3))
"""Needs float64."""
XYZ: Dtype = [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]
PCD_DATA = ("ascii", "binary", "binary_compressed")
PLY_FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")
PLY_TYPES = {"f4": "float", "f8": "double", "i1": "char", "u1": "uchar", "i2": "short", "u2": "ushort", "i4": "int"}
PLY_TYPES["u4"] = "uint"
SPECIAL = ("normal_x", "positions", "normals", "colors", "rgb", "rgba", "nx", "red", "intensity", "label", "curvature")
"""Names that mean something to Open3D or PCL, each alone where it takes several to mean it."""


def table(dtype: Dtype, points: FloatArray = POINTS) -> Table:
    """Rows of a structured dtype: x, y and z from `points`, small positive numbers elsewhere."""
    rows = np.zeros(len(points), np.dtype(dtype))
    rng = np.random.default_rng(1)
    for name in rows.dtype.names or ():
        rows[name] = points[:, "xyz".index(name)] if name in ("x", "y", "z") else rng.integers(1, 100, rows[name].shape)
    return rows


def text_rows(rows: Table, end: str = "\n") -> bytes:
    """Rows as text, the entries of a field with a count one after another."""
    names = rows.dtype.names or ()
    lines = (" ".join(str(value) for name in names for value in np.ravel(row[name]).tolist()) for row in rows)
    return "".join(line + end for line in lines).encode()


def lzf(data: bytes) -> bytes:
    """LZF data of literal runs alone: a length less one, then that many bytes."""
    return b"".join(bytes([len(run) - 1]) + run for run in (data[k : k + 32] for k in range(0, len(data), 32)))


def pcd_header(rows: Table, data: str, **lines: str) -> bytes:
    """A PCD header; `lines` replace its lines, an empty one goes. Fields called _, _1, … are padding, all called _."""
    dtype = rows.dtype
    names = dtype.names or ()
    kinds = [dtype[name].base for name in names]
    words = {
        "VERSION": "0.7",
        "FIELDS": " ".join("_" if name[1:].isdigit() and name[0] == "_" else name for name in names),
        "SIZE": " ".join(str(kind.itemsize) for kind in kinds),
        "TYPE": " ".join(kind.kind.upper() for kind in kinds),
        "COUNT": " ".join(str(int(np.prod(dtype[name].shape, dtype=int))) for name in names),
        "WIDTH": str(len(rows)),
        "HEIGHT": "1",
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(len(rows)),
        "DATA": data,
    } | lines
    text = "".join(f"{key} {value}\n" for key, value in words.items() if value)
    return b"# .PCD v0.7 - Point Cloud Data file format\n" + text.encode()


def pcd_data(rows: Table, data: str) -> bytes:
    """What follows the header: rows as text, rows packed, or columns packed and compressed."""
    if data == "ascii":
        return text_rows(rows)
    if data == "binary":
        return rows.tobytes()
    columns = b"".join(np.ascontiguousarray(rows[name]).tobytes() for name in rows.dtype.names or ())
    packed = lzf(columns)
    return struct.pack("<II", len(packed), len(columns)) + packed


def pcd(rows: Table, data: str = "binary", **lines: str) -> bytes:
    """A PCD file."""
    return pcd_header(rows, data, **lines) + pcd_data(rows, data)


def ply_element(name: str, rows: Table) -> str:
    """An element's lines of a PLY header."""
    names = rows.dtype.names or ()
    properties = "".join(f"property {PLY_TYPES[rows.dtype[each].str[1:]]} {each}\n" for each in names)
    return f"element {name} {len(rows)}\n{properties}"


def ply_rows(rows: Table, form: str, end: str = "\n") -> bytes:
    """An element's data."""
    if form == "ascii":
        return text_rows(rows, end)
    return rows.astype(rows.dtype.newbyteorder(">" if form == "binary_big_endian" else "<")).tobytes()


def ply(rows: Table, form: str = "ascii", before: Table | None = None, links: int = 0, end: str = "\n") -> bytes:
    """A PLY file: perhaps an element before the vertices, perhaps links of them after; `end` ends its lines."""
    header = f"ply\nformat {form} 1.0\ncomment made by a test\nobj_info none\n"
    data = b""
    if before is not None:
        header += ply_element("camera", before)
        data += ply_rows(before, form, end)
    header += ply_element("vertex", rows)
    data += ply_rows(rows, form, end)
    if links:
        header += f"element link {links}\nproperty list uchar int vertex_indices\n"
        order = ">" if form == "binary_big_endian" else "<"
        triangle = f"3 0 1 2{end}".encode() if form == "ascii" else struct.pack(f"{order}B3i", 3, 0, 1, 2)
        data += links * triangle
    return (header + "end_header\n").replace("\n", end).encode() + data


def read(folder: Path, content: bytes, name: str = "cloud", scale: float = 1.0) -> Cloud:
    """The one cloud of a file with this content; its name has no suffix, for content alone must tell what it is."""
    path = folder / name
    path.write_bytes(content)
    (cloud,) = read_clouds(path, scale)
    return cloud


def assert_same(cloud: Cloud, points: FloatArray = POINTS) -> None:
    """The cloud holds these points, all of them, in this order."""
    assert cloud.points.dtype == np.float64
    np.testing.assert_array_equal(cloud.points, points)
    assert cloud.dropped == 0


WRITERS = {
    **{f"pcd-{data}": (pcd, data) for data in PCD_DATA},
    **{f"ply-{form}": (ply, form) for form in PLY_FORMATS},
}


def refusal(path: Path) -> str:
    """The text of the error that reading the path raises; it names the path and fits two lines."""
    with pytest.raises(SourceError) as caught:
        list(read_clouds(path))
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert len(text.splitlines()) <= 2
    return text.removeprefix(f"{path}: ")
