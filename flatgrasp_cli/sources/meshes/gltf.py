"""glTF 2.0, one GLB file or JSON with its buffers: through Open3D, as a clean copy of the triangles alone.

Open3D leaves out the triangles that it cannot read and says nothing, so they are counted; what it need not see, such as
textures, is not handed over.
"""

from __future__ import annotations

import base64
import json
import struct
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import UP_UNTOLD, CloudWarning
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.sources.meshes.mesh import Polygons
from flatgrasp_cli.sources.text_lines import shown

MAGIC = b"glTF"
HEADER, CHUNK = struct.Struct("<4sII"), struct.Struct("<I4s")
UNREADABLE = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization")
FLOAT = 5126
TRIANGLES, STRIP, FAN = 4, 5, 6
DEEPEST = 500
MALFORMED = (LookupError, TypeError, ValueError, OverflowError, AttributeError, RecursionError, struct.error)
"""What comes of entries that are missing, of another type, or out of range."""
MOST_TRIANGLES = 5_000_000
"""One mesh may be shown a million times."""
Json = dict[str, Any]
UP_ASSUMED = CloudWarning(
    UP_UNTOLD,
    "glTF says that its own +y is up, which many files do not keep to; the hand comes from +z: --up 0,1,0 states it",
)


def is_gltf(head: bytes) -> bool:
    """Whether a file that begins so is a GLB file, or JSON as glTF is; no other source is JSON."""
    return head.startswith(MAGIC) or head.lstrip().startswith(b"{")


def read_gltf(file: BinaryIO, name: str, folder: Path | None = None) -> Polygons:
    """Read the surface of a glTF scene; buffers in other files are looked for in `folder`, if there is one.

    Raises
    ------
    SourceError
        If it is malformed, compressed, or has no triangles, or a buffer is missing.
    """
    content = file.read()
    try:
        document, binary = _parts(content)
        buffers = [_buffer(item, binary, folder) for item in document["buffers"]]
        clean, expected = _clean(document, buffers)
    except SourceError as error:
        raise SourceError(f"{name}: {error}") from error
    except MALFORMED as error:
        raise SourceError(f"{name}: the glTF file is malformed: {shown(error)}") from error
    if expected == 0:
        raise SourceError(f"{name}: the glTF file has no triangles")
    mesh = _by_open3d(clean, name)
    found = len(mesh.triangle.indices) if "indices" in mesh.triangle else 0
    if found != expected:
        raise SourceError(
            f"{name}: the glTF file declares {expected} triangles, Open3D could read {found} of them; it is damaged"
        )
    corners = mesh.triangle.indices.numpy().astype(np.int64).reshape(-1)
    return Polygons(mesh.vertex.positions.numpy(), corners, np.full(found, 3))


def _by_open3d(clean: bytes, name: str) -> Any:
    """Open3D's mesh of a GLB file."""
    with tempfile.TemporaryDirectory(prefix="flatgrasp-") as folder:
        copy = Path(folder, "clean.glb")
        copy.write_bytes(clean)
        try:
            return load_open3d().t.io.read_triangle_mesh(str(copy))
        except (IndexError, RuntimeError, MemoryError) as error:  # what it raises depends on where it fails
            raise SourceError(f"{name}: Open3D cannot read the glTF file; it is damaged") from error


def _parts(content: bytes) -> tuple[Json, bytes | None]:
    """The JSON of a file, and the binary chunk of a GLB file."""
    if not content.startswith(MAGIC):
        return _json(content), None
    _, version, length = HEADER.unpack_from(content)
    if version != 2:
        raise SourceError(f"is a GLB file of version {version}, not 2")
    if length > len(content):
        raise SourceError(f"declares {length} bytes, the file has {len(content)}: it is truncated")
    chunks: dict[bytes, bytes] = {}
    place = HEADER.size
    while place < length:
        size, kind = CHUNK.unpack_from(content, place)
        place += CHUNK.size + size
        if place > length:
            raise SourceError("a chunk of the GLB file goes beyond its end: it is truncated")
        chunks.setdefault(kind, content[place - size : place])
    return _json(chunks[b"JSON"]), chunks.get(b"BIN\0")


def _json(content: bytes) -> Json:
    document = json.loads(content.decode("utf-8-sig"))
    if not isinstance(document, dict) or "asset" not in document:
        raise SourceError("is JSON, but no glTF scene")
    needed = [name for name in document.get("extensionsRequired", ()) if name in UNREADABLE]
    if needed:
        raise SourceError(f"is compressed by {needed[0]}; save the mesh without compression")
    return document


def _buffer(item: Json, binary: bytes | None, folder: Path | None) -> bytes:
    length, uri = int(item["byteLength"]), item.get("uri")
    if uri is None:
        content = binary or b""
    elif uri.startswith("data:"):
        content = base64.b64decode(uri.partition(",")[2])
    else:
        content = _companion(unquote(uri), length, folder)
    if len(content) < length:
        raise SourceError(f"a buffer should have {length} bytes, it has {len(content)}")
    return content[:length]


def _companion(uri: str, length: int, folder: Path | None) -> bytes:
    """A buffer in a file beside the glTF file or below; none that leads elsewhere is opened."""
    path = Path(uri)
    if folder is None or path.is_absolute() or ".." in path.parts or "://" in uri or "\0" in uri:
        raise SourceError(f"its buffer {uri[:80]!r} is another file; save the mesh as one file, .glb")
    try:
        with (folder / path).open("rb") as file:
            return file.read(max(length, 0))
    except OSError as error:
        raise SourceError(f"its buffer {uri[:80]!r} cannot be read: {error.strerror}") from error


def _clean(document: Json, buffers: list[bytes]) -> tuple[bytes, int]:
    """A GLB file of the scene's triangles and nothing else, and how many they are."""
    begins = np.cumsum([0, *(len(buffer) + -len(buffer) % 4 for buffer in buffers)])
    binary = b"".join(buffer + bytes(-len(buffer) % 4) for buffer in buffers)
    accessors = document.get("accessors", [])
    meshes = [{"primitives": list(_primitives(mesh, accessors))} for mesh in document.get("meshes", [])]
    nodes = document.get("nodes", [])
    roots = _roots(document, nodes)
    reached = list(_reached(roots, nodes))
    shown = [meshes[nodes[node]["mesh"]] for node in reached if "mesh" in nodes[node]]
    expected = sum(_triangles(primitive, accessors) for mesh in shown for primitive in mesh["primitives"])
    if expected > MOST_TRIANGLES:
        raise SourceError(f"shows {expected} triangles, more than {MOST_TRIANGLES}")
    views = [
        {**_only(view, "byteLength", "byteStride"), "buffer": 0, "byteOffset": _begin(view, begins, buffers)}
        for view in document.get("bufferViews", [])
    ]
    clean = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": roots}],
        "nodes": _clean_nodes(nodes, set(reached), meshes),
        "meshes": [mesh for mesh in meshes if mesh["primitives"]],
        "accessors": [
            _only(item, "bufferView", "byteOffset", "componentType", "count", "type", "min", "max")
            for item in accessors
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    return _glb(json.dumps(clean).encode(), binary), expected


def _only(item: Json, *keys: str) -> Json:
    return {key: item[key] for key in keys if key in item}


def _begin(view: Json, begins: Any, buffers: list[bytes]) -> int:
    """Where a view begins in all buffers together."""
    buffer, offset, length = int(view["buffer"]), int(view.get("byteOffset", 0)), int(view["byteLength"])
    if min(buffer, offset, length) < 0 or offset + length > len(buffers[buffer]):
        raise ValueError("a bufferView goes beyond its buffer")
    return int(begins[buffer]) + offset


def _primitives(mesh: Json, accessors: list[Json]) -> Iterator[Json]:
    """Those primitives of a mesh that are triangles, with nothing but their places."""
    for primitive in mesh["primitives"]:
        if primitive.get("mode", TRIANGLES) not in (TRIANGLES, STRIP, FAN):
            continue
        position = primitive["attributes"]["POSITION"]
        used = [accessors[position], *([accessors[primitive["indices"]]] if "indices" in primitive else [])]
        if any("sparse" in item or "bufferView" not in item for item in used):
            raise SourceError("has sparse accessors, which are not read; save the mesh again without")
        if used[0]["componentType"] != FLOAT or used[0]["type"] != "VEC3":
            raise ValueError("POSITION is no VEC3 of floats")
        yield {"attributes": {"POSITION": position}, **_only(primitive, "indices", "mode")}


def _triangles(primitive: Json, accessors: list[Json]) -> int:
    count = int(accessors[primitive.get("indices", primitive["attributes"]["POSITION"])]["count"])
    return count // 3 if primitive.get("mode", TRIANGLES) == TRIANGLES else max(count - 2, 0)


def _roots(document: Json, nodes: list[Json]) -> list[int]:
    """The nodes of the scene that is shown; without scenes, those that belong to no other."""
    scenes = document.get("scenes")
    if scenes:
        return list(scenes[document.get("scene", 0)].get("nodes", []))
    below = {child for node in nodes for child in node.get("children", ())}
    return [node for node in range(len(nodes)) if node not in below]


def _reached(roots: list[int], nodes: list[Json]) -> Iterator[int]:
    """All nodes of a scene, each of which belongs to one other at most."""
    seen: set[int] = set()
    level = roots
    for _ in range(DEEPEST):
        if not level:
            return
        for node in level:
            if node in seen or not 0 <= node < len(nodes):
                raise ValueError(f"node {node} is not there, or there twice")
            seen.add(node)
            yield node
        level = [child for node in level for child in nodes[node].get("children", ())]
    raise ValueError(f"its nodes are nested more than {DEEPEST} deep")


def _clean_nodes(nodes: list[Json], reached: set[int], meshes: list[Json]) -> list[Json]:
    """The nodes with their motions, and with their meshes by the numbers that those have without the empty ones."""
    numbers = np.cumsum([bool(mesh["primitives"]) for mesh in meshes]) - 1
    clean = []
    for k, node in enumerate(nodes):
        kept = _only(node, "children", "matrix", "translation", "rotation", "scale") if k in reached else {}
        if k in reached and "mesh" in node and meshes[node["mesh"]]["primitives"]:
            kept["mesh"] = int(numbers[node["mesh"]])
        clean.append(kept)
    return clean


def _glb(text: bytes, binary: bytes) -> bytes:
    text += b" " * (-len(text) % 4)
    size = HEADER.size + 2 * CHUNK.size + len(text) + len(binary)
    return b"".join(
        [HEADER.pack(MAGIC, 2, size), CHUNK.pack(len(text), b"JSON"), text, CHUNK.pack(len(binary), b"BIN\0"), binary]
    )
