"""PCD and PLY files, read by Open3D once their header has been found to tell the truth.

Open3D answers many broken files with zero points, zeros, unset memory or a crash, and no exception. So the header is
checked against the bytes first, and Open3D gets a clean copy: the same data behind a header in which only x, y and z
mean something. Its tensor reader reads float64 PCD rightly, its legacy reader PLY with mixed types; each not vice versa
(seen with 0.20).
"""

from __future__ import annotations

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
    with tempfile.TemporaryDirectory(prefix="flatgrasp-") as folder:
        clean = Path(folder, "clean.ply")
        with clean.open("wb") as out:
            out.write(header.vertices_only())
            _copy(file, out, size)
        cloud = load_open3d().io.read_point_cloud(
            str(clean), format="ply", remove_nan_points=False, remove_infinite_points=False
        )
    return _finite(np.array(cloud.points), header.vertex.count, np.zeros(3), name)


def _copy(file: BinaryIO, out: BinaryIO, size: int) -> None:
    while size > 0 and (block := file.read(min(size, COPY_BYTES))):
        out.write(block)
        size -= len(block)


def _finite(points: FloatArray, declared: int, viewpoint: FloatArray, name: str) -> Cloud:
    if len(points) != declared:
        raise SourceError(f"{name}: the header declares {declared} points, Open3D could read {len(points)} of them")
    finite = np.isfinite(points).all(axis=1)
    kept = np.ascontiguousarray(points[finite])
    return Cloud(kept, viewpoint, Source(name), dropped=declared - len(kept))
