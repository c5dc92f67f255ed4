"""Meshes written triangle by triangle in every format."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources import read_clouds
from flatgrasp_cli.sources.meshes.triangles import triangulated

Faces = Sequence[Sequence[int]]
U = [(-40, -30), (40, -30), (40, 30), (20, 30), (20, -10), (-20, -10), (-20, 30), (-40, 30)]
"""A U of 80 × 60 mm with a slot of 40 × 40 mm, open at +y; its legs and its base are 20 mm wide."""


def extruded(outline: Sequence[tuple[float, float]], low: float, high: float) -> tuple[FloatArray, list[list[int]]]:
    """Vertices in metres and faces of a solid of this outline in mm: two caps, and a wall along each side."""
    n = len(outline)
    flat = 1e-3 * np.array(outline, dtype=np.float64)
    vertices = np.vstack([np.column_stack([flat, np.full(n, 1e-3 * z)]) for z in (low, high)])
    walls = [[k, (k + 1) % n, (k + 1) % n + n, k + n] for k in range(n)]
    return vertices, [list(range(n))[::-1], list(range(n, 2 * n)), *walls]


BRACKET, BRACKET_FACES = extruded(U, 480, 500)
CORNERS, BOX_FACES = extruded([(0, 0), (60, 0), (60, 30), (0, 30)], 0, 20)


def triangles_of(vertices: FloatArray, faces: Faces) -> NDArray[np.intp]:
    sizes = np.array([len(face) for face in faces])
    return triangulated(vertices, np.concatenate([np.array(face) for face in faces]), sizes, "test")


def ply(vertices: FloatArray, faces: Faces, form: str = "ascii", lists: str = "uchar int vertex_indices") -> bytes:
    kinds = "".join(f"property double {axis}\n" for axis in "xyz")
    header = f"ply\nformat {form} 1.0\nelement vertex {len(vertices)}\n{kinds}element face {len(faces)}\n"
    header += f"property list {lists}\nproperty uchar red\nend_header\n"
    if form == "ascii":
        rows = [" ".join(map(repr, row)) for row in vertices.tolist()]
        rows += [" ".join(map(str, (len(face), *face, 255))) for face in faces]
        return (header + "\n".join(rows) + "\n").encode()
    order = ">" if "big" in form else "<"
    polygons = (struct.pack(f"{order}B{len(face)}iB", len(face), *face, 255) for face in faces)
    return header.encode() + vertices.astype(order + "f8").tobytes() + b"".join(polygons)


def stl(vertices: FloatArray, faces: Faces, header: bytes = b"solid but binary") -> bytes:
    places = vertices[triangles_of(vertices, faces)]
    record = np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    rows = np.zeros(len(places), record)
    rows["v"] = places
    return header.ljust(80, b"\0") + struct.pack("<I", len(rows)) + rows.tobytes()


def stl_text(vertices: FloatArray, faces: Faces) -> bytes:
    text = "solid made by a test\n"
    for triangle in vertices[triangles_of(vertices, faces)].tolist():
        corners = "".join(f"      vertex {x!r} {y!r} {z!r}\n" for x, y, z in triangle)
        text += f"  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet\n"
    return (text + "endsolid made by a test\n").encode()


def obj(vertices: FloatArray, faces: Faces, corner: Callable[[int], str] = lambda k: str(k + 1)) -> bytes:
    lines = ["# made by a test", "mtllib nowhere.mtl", "o thing", "vt 0 0", "vn 0 0 1"]
    lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["usemtl none", *("f " + " ".join(map(corner, face)) for face in faces)]
    return ("\n".join(lines) + "\n").encode()


def off(vertices: FloatArray, faces: Faces, head: str = "OFF\n# made by a test\n\n") -> bytes:
    lines = [f"{len(vertices)} {len(faces)} 0", *(" ".join(map(repr, row)) for row in vertices.tolist())]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    return (head + "\n".join(lines) + "\n").encode()


def gltf_scene(vertices: FloatArray, faces: Faces) -> tuple[dict[str, Any], bytes]:
    """A glTF document and its buffer."""
    indices = triangles_of(vertices, faces).astype("<u2")
    places = vertices.astype("<f4")
    binary = places.tobytes() + indices.tobytes()
    begin = places.nbytes
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"uri": "nowhere.png"}],
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": begin},
            {"buffer": 0, "byteOffset": begin, "byteLength": indices.nbytes},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"}
            | {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()},
            {"bufferView": 1, "componentType": 5123, "count": indices.size, "type": "SCALAR"},
        ],
    }
    return document, binary


def glb(document: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def gltf(document: dict[str, Any], binary: bytes) -> bytes:
    uri = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    return json.dumps(document | {"buffers": [{"byteLength": len(binary), "uri": uri}]}).encode()


Writer = Callable[[FloatArray, Faces], bytes]
WRITERS: dict[str, Writer] = {
    "ply": ply,
    "ply-little": lambda v, f: ply(v, f, "binary_little_endian"),
    "ply-big": lambda v, f: ply(v, f, "binary_big_endian"),
    "ply-vertex_index": lambda v, f: ply(v, f, lists="uint8 uint32 vertex_index"),
    "stl": stl,
    "stl-text": stl_text,
    "stl-text-cr": lambda v, f: stl_text(v, f).replace(b"\n", b"\r"),
    "obj": obj,
    "obj-slashes": lambda v, f: obj(v, f, lambda k: f"{k + 1}/1/1"),
    "obj-negative": lambda v, f: obj(v, f, lambda k: str(k - len(v))),
    "obj-crlf": lambda v, f: obj(v, f).replace(b"\n", b"\r\n"),
    "off": off,
    "off-one-line": lambda v, f: off(v, f, "OFF "),
    "off-modelnet": lambda v, f: off(v, f, "OFF"),
    "glb": lambda v, f: glb(*gltf_scene(v, f)),
    "gltf": lambda v, f: gltf(*gltf_scene(v, f)),
}


def read(folder: Path, content: bytes, scale: float = 1.0) -> Cloud:
    """The one cloud of a file with this content; its name has no suffix, for content alone must tell what it is."""
    path = folder / "mesh"
    path.write_bytes(content)
    (cloud,) = read_clouds(path, scale)
    return cloud


BOX = CORNERS, BOX_FACES
