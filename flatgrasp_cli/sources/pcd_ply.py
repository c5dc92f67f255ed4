"""PCD and PLY files, once their header has been found to tell the truth.

Open3D answers many broken files with zero points, zeros, unset memory or a crash, and no exception; and seen with 0.20,
it gets mixed types, properties in another order than x, y, z, and infinities in PLY wrong. Behind a checked header the
points are a plain table, which numpy reads, faster than Open3D and without the second that its import takes. Only
compressed PCD goes to Open3D, the one maintained reader of it whose wheels need no compiler: to its tensor reader (the
legacy one reads float64 as zeros), as a clean copy behind a header in which only x, y and z mean something.
"""

from __future__ import annotations

import io
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, ImageGrid, Source
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.sources.pcd_header import PcdHeader, check_pcd_data, read_pcd_header
from flatgrasp_cli.sources.ply_header import read_ply_header, seek_vertices

COPY_BYTES = 1 << 20


def read_pcd(file: BinaryIO, name: str, scale: float = 1.0) -> Cloud:
    """Read a PCD file: ascii, binary or binary_compressed, organised or not; NaN and infinite points are dropped.

    VIEWPOINT is the sensor's pose in the cloud's own frame as PCL writes it; others write the pose of the cloud's frame
    in another one, so its inverse is kept, too. All zeros, PCL's default, say nothing.
    """
    header = read_pcd_header(file, name)
    check_pcd_data(file, header, name)
    if header.points == 0:
        raise SourceError(f"{name}: the file declares no points")
    file.seek(header.begin)
    shape = (header.height, header.width)
    cloud = _finite(_pcd_columns(file, header, name), name, shape, scale)
    pose = header.viewpoint_pose
    if pose is None:
        return cloud
    inverse = -pose.axes @ pose.origin
    return replace(cloud, viewpoint=scale * pose.origin, inverse_viewpoint=scale * inverse)


def _pcd_columns(file: BinaryIO, header: PcdHeader, name: str) -> Sequence[FloatArray] | FloatArray:
    """x, y and z of all points of a PCD file that stands at its data."""
    if header.data == "binary_compressed":
        return _decompressed(file, header, name).T
    data = file.read()
    if header.data == "binary":
        records = np.frombuffer(data, dtype=header.point_dtype(), count=header.points)
        return [records[axis] for axis in "xyz"]
    columns = [header.column(axis) for axis in "xyz"]
    return np.loadtxt(io.BytesIO(data), comments=None, ndmin=2, usecols=columns).T


def _decompressed(file: BinaryIO, header: PcdHeader, name: str) -> FloatArray:
    """The points (n, 3) of a compressed PCD file that stands at its data."""
    with tempfile.TemporaryDirectory(prefix="flatgrasp-") as folder:
        clean = Path(folder, "clean.pcd")
        with clean.open("wb") as out:
            out.write(header.renamed())
            shutil.copyfileobj(file, out, COPY_BYTES)
        cloud = load_open3d().t.io.read_point_cloud(
            str(clean), format="pcd", remove_nan_points=False, remove_infinite_points=False
        )
    points = cloud.point.positions.numpy() if "positions" in cloud.point else np.empty((0, 3))
    if len(points) != header.points:
        raise SourceError(
            f"{name}: the header declares {header.points} points, Open3D could read {len(points)} of them"
        )
    return np.asarray(points)


def read_ply(file: BinaryIO, name: str, scale: float = 1.0) -> Cloud:
    """Read the vertices of a PLY file, ascii or binary of either endianness."""
    header = read_ply_header(file, name)
    size = seek_vertices(file, header, name)
    if header.vertex.count == 0:
        raise SourceError(f"{name}: the file declares no points")
    data = file.read(size)
    if header.format == "ascii":
        columns = [header.vertex.column(axis) for axis in "xyz"]
        return _finite(
            np.loadtxt(io.BytesIO(data), comments=None, ndmin=2, usecols=columns).T,
            name,
            (1, header.vertex.count),
            scale,
        )
    records = np.frombuffer(data, dtype=header.vertex_dtype())
    return _finite([records[axis] for axis in "xyz"], name, (1, header.vertex.count), scale)


def _finite(columns: Sequence[FloatArray] | FloatArray, name: str, shape: tuple[int, int], scale: float) -> Cloud:
    """The cloud of the finite ones of points given as columns x, y and z, of any type; `shape` is height and width."""
    x, y, z = columns
    finite = np.isfinite(x) & np.isfinite(y) & np.isfinite(z)
    rows = np.flatnonzero(finite)
    points = np.empty((len(rows), 3))
    for k, column in enumerate((x, y, z)):
        points[:, k] = column if len(rows) == len(column) else column.take(rows)
    if scale != 1.0:
        points *= scale
    pixels = ImageGrid(shape, finite) if min(shape) > 1 else None
    return Cloud(points, source=Source(name), dropped=len(x) - len(rows), pixels=pixels)
