"""PCD and PLY files, once their header has been found to tell the truth.

Open3D answers many broken files with zero points, zeros, unset memory or a crash, and no exception. So the header is
checked against the bytes first. PCD then goes to Open3D's tensor reader (the legacy one reads float64 as zeros) as a
clean copy: the same data behind a header in which only x, y and z mean something. PLY does not: seen with 0.20, neither
reader gets all of mixed types, properties in another order than x, y, z, and infinities right. Behind a checked header
its vertices are a plain table, which numpy reads.
"""

from __future__ import annotations

import io
import shutil
import tempfile
from pathlib import Path
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, Source
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.sources.pcd_header import check_pcd_data, read_pcd_header
from flatgrasp_cli.sources.ply_header import read_ply_header, seek_vertices

COPY_BYTES = 1 << 20


def read_pcd(file: BinaryIO, name: str) -> Cloud:
    """Read a PCD file: ascii, binary or binary_compressed, organised or not; NaN and infinite points are dropped.

    VIEWPOINT's position is the sensor's in the cloud's own frame, as PCL writes it; its quaternion (w first) turns
    nothing, for the points are in that frame already.
    """
    header = read_pcd_header(file, name)
    check_pcd_data(file, header, name)
    if header.points == 0:
        raise SourceError(f"{name}: the file declares no points")
    file.seek(header.begin)
    with tempfile.TemporaryDirectory(prefix="flatgrasp-") as folder:
        clean = Path(folder, "clean.pcd")
        with clean.open("wb") as out:
            out.write(header.renamed())
            shutil.copyfileobj(file, out, COPY_BYTES)
        cloud = load_open3d().t.io.read_point_cloud(
            str(clean), format="pcd", remove_nan_points=False, remove_infinite_points=False
        )
    points = cloud.point.positions.numpy() if "positions" in cloud.point else np.empty((0, 3))
    return _finite(points.astype(np.float64), header.points, np.array(header.viewpoint[:3]), name)


def read_ply(file: BinaryIO, name: str) -> Cloud:
    """Read the vertices of a PLY file, ascii or binary of either endianness, seen from the origin."""
    header = read_ply_header(file, name)
    size = seek_vertices(file, header, name)
    if header.vertex.count == 0:
        raise SourceError(f"{name}: the file declares no points")
    data = file.read(size)
    if header.format == "ascii":
        rows = np.loadtxt(io.BytesIO(data), comments=None, ndmin=2)
        points = rows[:, [header.vertex.column(axis) for axis in "xyz"]]
    else:
        records = np.frombuffer(data, dtype=header.vertex_dtype())
        points = np.column_stack([records[axis] for axis in "xyz"]).astype(np.float64)
    return _finite(points, header.vertex.count, np.zeros(3), name)


def _finite(points: FloatArray, declared: int, viewpoint: FloatArray, name: str) -> Cloud:
    if len(points) != declared:
        raise SourceError(f"{name}: the header declares {declared} points, Open3D could read {len(points)} of them")
    finite = np.isfinite(points).all(axis=1)
    kept = np.ascontiguousarray(points[finite])
    return Cloud(kept, viewpoint, Source(name), dropped=declared - len(kept))
