"""Files that hold one cloud, a mesh, or a depth image: what they are is told by content, and by name where that fails.

A file found to be of a kind is read as that; an STL file cut short, which nothing but its name tells, gets an error
that says so.
"""

from __future__ import annotations

from pathlib import Path, PurePath
from typing import TYPE_CHECKING, BinaryIO, Literal

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import Cloud, Source
from flatgrasp_cli.recordings.containers.sniff import ZSTD_MAGIC
from flatgrasp_cli.source_names import in_utf8
from flatgrasp_cli.sources.idle_options import idle_options
from flatgrasp_cli.sources.pcd_header import is_pcd
from flatgrasp_cli.sources.pcd_ply import read_pcd, read_ply, read_polygons
from flatgrasp_cli.sources.ply_header import is_ply
from flatgrasp_cli.sources.selection import EVERYTHING, Selection
from flatgrasp_cli.sources.text_lines import BYTE_ORDER_MARK

if TYPE_CHECKING:
    from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
    from flatgrasp_cli.sources.meshes import Polygons

Kind = Literal["PCD", "PLY", "STL", "OBJ", "OFF", "glTF", "depth image"]
SNIFFED_BYTES = 65_536
MESHES: dict[str, Kind] = {".stl": "STL", ".obj": "OBJ", ".off": "OFF", ".glb": "glTF", ".gltf": "glTF"}
SUFFIXES = (".pcd", ".ply", *MESHES)
"""Of files that hold one cloud or one mesh."""
IMAGES = (".png", ".tif", ".tiff", ".npy")
"""Of depth images."""
ELSE: dict[bytes, str] = {
    b"\xff\xfe": "is text in UTF-16; save it as ASCII or UTF-8",
    b"\xfe\xff": "is text in UTF-16; save it as ASCII or UTF-8",
    ZSTD_MAGIC: "is compressed with zstd, and is damaged or cut short where it begins, or holds no recording",
    b"\xff\xd8\xff": "is a JPEG picture, which cannot hold depth",
}


def read_file(path: Path, name: str, scale: float = 1.0, selection: Selection = EVERYTHING) -> Cloud:
    """Read the cloud of a file.

    `name` is what errors call it, `scale` the metres in a unit of the file; of the `selection` depth images need what
    it says of their camera.

    Raises
    ------
    SourceError
        If it is of no kind that is read, or broken.
    """
    kind = kind_of_file(path, name)
    cloud = read_kind(kind, path, name, scale, selection)
    return cloud.warned(*idle_options(selection, recorded=False, images=kind == "depth image"))


def read_kind(kind: Kind, path: Path, name: str, scale: float, selection: Selection) -> Cloud:
    """Read a file whose kind is known."""
    if kind == "depth image":
        from flatgrasp_cli.sources.depth_files import DepthFiles

        return DepthFiles(selection, scale).read(path, Source(name))
    with path.open("rb") as file:
        if kind == "PCD":
            return read_pcd(file, name, scale)
        if kind == "PLY":
            return read_ply(file, name, scale)
        from flatgrasp_cli.sources.meshes import UP_ASSUMED, polygon_cloud

        cloud = polygon_cloud(_polygons(kind, file, path, name), name, scale)
        return cloud.warned(UP_ASSUMED) if kind == "glTF" else cloud


def read_surface(path: Path, name: str, scale: float = 1.0) -> tuple[FloatArray, IntArray]:
    """The vertices (n, 3) of a mesh file, in metres, and the triangles (m, 3) over them.

    Raises
    ------
    SourceError
        If it is no mesh, or broken.
    """
    from flatgrasp_cli.sources.meshes import surface

    kind = kind_of_file(path, name)
    with path.open("rb") as file:
        polygons = None if kind in ("PCD", "depth image") else _polygons(kind, file, path, name)
    if polygons is None or len(polygons.sizes) == 0:
        raise SourceError(f"{name}: has no faces; a mesh is wanted (STL, OBJ, PLY, OFF, glTF)")
    return surface(polygons, name, scale)


def _polygons(kind: Kind, file: BinaryIO, path: Path, name: str) -> Polygons:
    """The polygons of a mesh file."""
    from flatgrasp_cli.sources.meshes import read_gltf, read_obj, read_off, read_stl

    if kind == "PLY":
        return read_polygons(file, name)
    if kind == "glTF":  # its buffers may be files beside it, if it is no copy of a pipe
        own = in_utf8(str(path)) == str(PurePath(name))
        return read_gltf(file, name, path.parent if own else None)
    return {"STL": read_stl, "OBJ": read_obj, "OFF": read_off}[kind](file, name)


def kind_of_file(path: Path, name: str) -> Kind:
    """What kind of file it is.

    Raises
    ------
    SourceError
        If it is of none that is read.
    """
    with path.open("rb") as file:
        head = file.read(SNIFFED_BYTES)
        size = file.seek(0, 2)
    if not head:
        raise SourceError(f"{name}: the file is empty")
    kind = _by_content(head.removeprefix(BYTE_ORDER_MARK), size) or MESHES.get(PurePath(name).suffix.lower())
    if kind is not None:
        return kind
    known = next((text for magic, text in ELSE.items() if head.startswith(magic)), None)
    raise SourceError(
        f"{name}: {known}"
        if known
        else f"{name}: is neither a PCD or PLY file, a mesh (STL, OBJ, OFF, glTF) or a depth image (PNG, TIFF, .npy), "
        f"nor a ROS bag or an MCAP recording (it begins with {head[:16]!r})"
    )


def _by_content(head: bytes, size: int) -> Kind | None:
    if is_ply(head):
        return "PLY"
    if is_pcd(head):
        return "PCD"
    from flatgrasp_cli.sources.depth_files import is_depth_file
    from flatgrasp_cli.sources.meshes import is_gltf, is_obj, is_off, is_stl

    found: dict[Kind, bool] = {  # in this order: "{" and "v 1" say less than a magic
        "depth image": is_depth_file(head),
        "STL": is_stl(head, size),
        "glTF": is_gltf(head),
        "OFF": is_off(head),
        "OBJ": is_obj(head),
    }
    return next((kind for kind, is_it in found.items() if is_it), None)
