"""Files that hold one cloud: what they are is told by their content, not by their name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources.depth_files import is_depth_file, read_depth_file
from flatgrasp_cli.sources.pcd_header import is_pcd
from flatgrasp_cli.sources.pcd_ply import read_pcd, read_ply
from flatgrasp_cli.sources.ply_header import is_ply
from flatgrasp_cli.sources.selection import EVERYTHING, Selection
from flatgrasp_cli.sources.text_lines import BYTE_ORDER_MARK

SNIFFED_BYTES = 65_536
UTF_16 = (b"\xff\xfe", b"\xfe\xff")
MESH_SUFFIXES = (".stl", ".obj", ".off", ".glb", ".gltf")
CLOUD_SUFFIXES = (".pcd", ".ply", *MESH_SUFFIXES)


@dataclass(frozen=True, slots=True)
class FileKind:
    """What a file is, in words for people, and whether depth has to be told from colour in it."""

    name: str
    is_image: bool = False


def kind_of_file(path: Path, name: str) -> str:
    """What a file is: "PCD", "PLY", "STL", "OBJ", "OFF", "glTF", or "depth image".

    Raises
    ------
    SourceError
        If it is none of these.
    """
    from flatgrasp_cli.sources.meshes import is_gltf, is_obj, is_off, is_stl

    with path.open("rb") as file:
        head = file.read(SNIFFED_BYTES)
        size = file.seek(0, 2)
    if not head:
        raise SourceError(f"{name}: the file is empty")
