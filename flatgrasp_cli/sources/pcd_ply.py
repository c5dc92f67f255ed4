"""PCD and PLY files, once their header has been found to tell the truth.

Open3D answers many broken files with zero points, zeros, unset memory or a crash, and no exception; and seen with 0.20,
it gets mixed types, properties in another order than x, y, z, and infinities in PLY wrong. Behind a checked header the
points are a plain table, which numpy reads, faster than Open3D and without the second that its import takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.kernels.points import measured
from flatgrasp_cli.model import Cloud, CloudWarning, ImageGrid, Source
from flatgrasp_cli.model.clouds import LARGEST_COORDINATE_M
from flatgrasp_cli.model.measured import Measured
from flatgrasp_cli.sources.ascii_rows import more_rows, read_columns
from flatgrasp_cli.sources.pcd_header import PcdHeader, check_pcd_data, read_pcd_header
from flatgrasp_cli.sources.ply_elements import Column, read_element
from flatgrasp_cli.sources.ply_header import PlyElement, PlyHeader, read_ply_header
from flatgrasp_cli.sources.text_lines import shown, with_lf

if TYPE_CHECKING:
    from flatgrasp_cli.sources.meshes import Polygons

MORE_POINTS = CloudWarning(
    "more_points_than_declared",
    "The file goes on behind the points that its header declares; what follows them is left out.",
)
FACE_LISTS = ("vertex_indices", "vertex_index")
CAMERA_PLACE = ("view_px", "view_py", "view_pz")
CAMERA_IMAGE = ("viewporty", "viewportx")
"""What PCL writes the height and width of an organised cloud to."""


def read_pcd(file: BinaryIO, name: str, scale: float = 1.0) -> Cloud:
    """Read a PCD file: ascii, binary or binary_compressed, organised or not; NaN and infinite points are dropped.

    VIEWPOINT is the sensor's pose in the cloud's own frame as PCL writes it; others write the pose of the cloud's frame
    in another one, so its inverse is kept, too. All zeros, PCL's default, say nothing.
    """
    header = read_pcd_header(file, name)
    file.seek(header.begin)
    columns, more = _text_columns(file, header, name) if header.data == "ascii" else _columns(file, header, name)
    if header.points == 0:
        raise SourceError(f"{name}: the file declares no points")
    cloud = _cloud(columns, name, (header.height, header.width), scale)
    if more:
        cloud = cloud.warned(MORE_POINTS)
    pose = header.viewpoint_pose
    if pose is None or _too_far(pose.origin, scale):
        return cloud
    inverse = -pose.axes @ pose.origin
    return replace(cloud, viewpoint=scale * pose.origin, inverse_viewpoint=scale * inverse)


def _text_columns(file: BinaryIO, header: PcdHeader, name: str) -> tuple[FloatArray, bool]:
    """x, y and z of all points of a PCD file that stands at its data, and whether there are more."""
    rows = with_lf(file, cr=header.cr)
    columns = read_columns(rows, header.points, sum(header.counts), header.columns(), name)
    return columns, more_rows(rows)


def _columns(file: BinaryIO, header: PcdHeader, name: str) -> tuple[Sequence[FloatArray] | FloatArray, bool]:
    more = check_pcd_data(file, header, name)
    file.seek(header.begin)
    if header.points and header.data == "binary_compressed":
        from flatgrasp_cli.sources.pcd_compressed import decompressed

        return decompressed(file, header, name), more
    data = file.read(header.points * header.stride)
    records = np.frombuffer(data, dtype=header.point_dtype(), count=header.points)
    return [records[axis] for axis in "xyz"], more


def read_ply(file: BinaryIO, name: str, scale: float = 1.0) -> Cloud:
    """Read a PLY file, ascii or binary of either endianness: its vertices, or the surface if it has faces.

    `element camera`, as PCL writes it, has the sensor's place; all zeros, PCL's default, say nothing.
    """
    header = read_ply_header(file, name)
    text = with_lf(file, cr=header.cr) if header.format == "ascii" else file
    found = _elements(text, header, name)
    vertices = [column.values for column in found["vertex"]]
    if len(vertices[0]) == 0:
        raise SourceError(f"{name}: the file declares no points")
    if found.get("face"):
        from flatgrasp_cli.sources.meshes import polygon_cloud

        return polygon_cloud(_polygons(found), name, scale)
    cloud = _seen_by(found.get("camera"), vertices, name, scale)
    return cloud.warned(MORE_POINTS) if _goes_on(text, header) else cloud


def read_polygons(file: BinaryIO, name: str) -> Polygons:
    """Read the faces of a PLY file; none if it has none."""
    header = read_ply_header(file, name)
    text = with_lf(file, cr=header.cr) if header.format == "ascii" else file
    return _polygons(_elements(text, header, name))


def _elements(text: BinaryIO, header: PlyHeader, name: str) -> dict[str, list[Column]]:
    """The columns that are wanted of each element."""
    wanted = [_wanted(element, name) for element in header.elements]
    last = max(k for k, places in enumerate(wanted) if places)
    found: dict[str, list[Column]] = {}
    for element, places in zip(header.elements[: last + 1], wanted, strict=False):
        columns = read_element(text, header, element, places, name)
        found.setdefault(element.name, columns)
    return found


def _polygons(found: dict[str, list[Column]]) -> Polygons:
    from flatgrasp_cli.sources.meshes import Polygons

    with np.errstate(invalid="ignore"):  # NaN of some kinds warn when they are converted
        vertices = np.stack([column.values for column in found["vertex"]], axis=1)
    if not found.get("face"):
        return Polygons(vertices, np.empty(0), np.empty(0, dtype=np.intp))
    (faces,) = found["face"]
    return Polygons(vertices, faces.values, faces.sizes)


def _wanted(element: PlyElement, name: str) -> list[int]:
    """Places of the properties that are read: of vertices, of the corners of faces, and of a camera."""
    if element.count == 0 and element.name != "vertex":
        return []
    if element.name == "vertex":
        return [element.places(axis)[0] for axis in "xyz"]
    if element.name == "tristrips":
        raise SourceError(f"{name}: has triangle strips, which are not read; save the mesh with faces")
    lists = [place for place, item in enumerate(element.properties) if item.count_code and item.name in FACE_LISTS]
    if element.name == "face":
        if not lists:
            names = " ".join(item.name for item in element.properties)
            raise SourceError(f"{name}: its faces have no list vertex_indices; they have: {shown(names)}")
        return lists[:1]
    scalars = {item.name: place for place, item in enumerate(element.properties) if not item.count_code}
    if element.name == "camera" and element.count == 1 and all(each in scalars for each in CAMERA_PLACE):
        return [scalars[each] for each in (*CAMERA_PLACE, *CAMERA_IMAGE) if each in scalars]
    return []


def _seen_by(camera: list[Column] | None, vertices: Sequence[FloatArray], name: str, scale: float) -> Cloud:
    """The cloud of the vertices, an image if the camera says of what size."""
    if not camera:
        return _cloud(vertices, name, (1, len(vertices[0])), scale)
    place, image = (np.array([float(column.values[0]) for column in part]) for part in (camera[:3], camera[3:]))
    shape = (1, len(vertices[0]))
    if len(image) == 2 and np.isfinite(image).all() and image.prod() == len(vertices[0]):
        shape = (int(image[0]), int(image[1]))
    cloud = _cloud(vertices, name, shape, scale)
    return replace(cloud, viewpoint=scale * place) if place.any() and not _too_far(place, scale) else cloud


def _too_far(place: FloatArray, scale: float) -> bool:
    """Whether a viewpoint (3,), in units of `scale` metres, is none: nothing that looks at objects is so far away."""
    return not scale * float(np.abs(place).max()) <= LARGEST_COORDINATE_M  # true for NaN, too


def _goes_on(file: BinaryIO, header: PlyHeader) -> bool:
    """Whether more vertices follow those that were read last; behind other elements nobody could tell."""
    element = header.elements[-1]
    if element.name != "vertex":
        return False
    if header.format == "ascii":
        return more_rows(file)
    size = sum(int((item.count_code or item.code)[1:]) for item in element.properties)
    return len(file.read(size)) == size


def _cloud(columns: Sequence[FloatArray] | FloatArray, name: str, shape: tuple[int, int], scale: float) -> Cloud:
    """The cloud of points given as columns x, y and z, of any type; `shape` is height and width."""
    x, y, z = _numbers(columns)
    filled, corners = np.empty(len(x), dtype=np.bool_), np.empty((2, 3))
    points = measured(x, y, z, scale, LARGEST_COORDINATE_M, filled.view(np.uint8), corners)
    pixels = ImageGrid(shape, filled) if min(shape) > 1 else None
    dropped, known = len(x) - len(points), Measured(points, corners)
    return Cloud(points, source=Source(name), dropped=dropped, pixels=pixels, measured=known)


def _numbers(columns: Sequence[FloatArray] | FloatArray) -> Sequence[FloatArray]:
    """The columns as numbers of one type, in which a processor reckons."""
    if len({column.dtype for column in columns} | {np.dtype(np.float32)}) == 1:
        return list(columns)
    with np.errstate(invalid="ignore"):  # NaN of some kinds warn when they are converted
        return [np.asarray(column, dtype=np.float64) for column in columns]
