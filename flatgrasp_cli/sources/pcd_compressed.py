"""Compressed PCD data, through Open3D: the one maintained reader of them whose wheels need no compiler.

Open3D's tensor reader (the legacy one reads float64 as zeros) takes names such as normal_x or positions for attributes
of its own and crashes when the rest of such an attribute is missing. So it gets a clean copy, behind a header in which
only x, y and z mean something.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.sources.pcd_header import PcdHeader

COPY_BYTES = 1 << 20
Field = tuple[str, str, int]
"""Name, type and count."""


def decompressed(file: BinaryIO, header: PcdHeader, name: str) -> Sequence[FloatArray] | FloatArray:
    """x, y and z of a compressed PCD file that stands at its data and has been checked.

    Raises
    ------
    SourceError
        If the data cannot be unpacked.
    """
    types = header.axis_types()
    if len(set(types)) > 1:  # Open3D wants one type; seen as single bytes, the fields have one
        return _columns_of(_raw(file, header, name), header)
    names = {place: axis for axis, place in zip("xyz", header.axes, strict=True)}
    kinds = enumerate(zip(header.types, header.counts, strict=True))
    fields = [(names.get(k, f"other{k}"), kind, count) for k, (kind, count) in kinds if count]
    return np.asarray(_read(file, header, fields, name).positions.numpy()).T


def _raw(file: BinaryIO, header: PcdHeader, name: str) -> bytes:
    """All that the data unpack to: field after field, each with the values of all points."""
    names = ("x", "y", "z", *(f"byte{k}" for k in range(3, header.stride)))
    point = _read(file, header, [(each, "U1", 1) for each in names], name)
    return b"".join([point.positions.numpy().T.tobytes(), *(point[each].numpy().tobytes() for each in names[3:])])


def _columns_of(raw: bytes, header: PcdHeader) -> list[FloatArray]:
    begins = [header.points * offset for offset in header.offsets()]
    return [
        np.frombuffer(raw, dtype=kind, count=header.points, offset=begin)
        for kind, begin in zip(header.axis_types(), begins, strict=True)
    ]


def _read(file: BinaryIO, header: PcdHeader, fields: Sequence[Field], name: str) -> Any:
    """Open3D's attributes of the points, of fields with these names and types."""
    with tempfile.TemporaryDirectory(prefix="flatgrasp-") as folder:
        clean = Path(folder, "clean.pcd")
        with clean.open("wb") as out:
            out.write(_clean_header(header.points, fields))
            shutil.copyfileobj(file, out, COPY_BYTES)
        point = (
            load_open3d()
            .t.io.read_point_cloud(str(clean), format="pcd", remove_nan_points=False, remove_infinite_points=False)
            .point
        )
    found = len(point.positions) if "positions" in point else 0
    if found != header.points:
        raise SourceError(f"{name}: the header declares {header.points} points, Open3D could read {found} of them")
    return point


def _clean_header(points: int, fields: Sequence[Field]) -> bytes:
    lines = {
        "VERSION": "0.7",
        "FIELDS": " ".join(name for name, _, _ in fields),
        "SIZE": " ".join(kind[1:] for _, kind, _ in fields),
        "TYPE": " ".join(kind[0] for _, kind, _ in fields),
        "COUNT": " ".join(str(count) for _, _, count in fields),
        "WIDTH": str(points),
        "HEIGHT": "1",
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(points),
        "DATA": "binary_compressed",
    }
    return "".join(f"{key} {value}\n" for key, value in lines.items()).encode()
