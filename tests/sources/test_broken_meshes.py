"""A broken mesh is an error that says why."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sources import read_clouds
from tests.sources.meshes import (
    BOX,
    BOX_FACES,
    CORNERS,
    WRITERS,
    glb,
    gltf_scene,
    obj,
    off,
    ply,
    read,
    stl,
    stl_text,
    triangles_of,
)

BEYOND = [[0, 1, 2], [0, 2, 300]]
FLAT = CORNERS * [1, 0, 0], triangles_of(*BOX).tolist()
HOLED = np.where(np.arange(8)[:, None] == 6, np.nan, CORNERS)
FAR = np.where(np.arange(8)[:, None] == 6, 1e30, CORNERS)
BOWTIE = [[0, 1, 3, 2]]


def changed(**entries: Any) -> bytes:
    """A GLB file of a box whose document has other entries."""
    document, binary = gltf_scene(*BOX)
    return glb(document | entries, binary)


def with_accessor(place: int, **entries: Any) -> bytes:
    document, binary = gltf_scene(*BOX)
    document["accessors"][place] |= entries
    return glb(document, binary)


SCENE = gltf_scene(*BOX)
BROKEN: dict[str, tuple[bytes, str]] = {
    **{f"{name}-no-area": (WRITERS[name](*FLAT), "area") for name in WRITERS},
    **{
        f"{name}-nan": (WRITERS[name](HOLED, [[0, 1, 6]]), "finite") for name in ("ply", "ply-big", "stl", "obj", "off")
    },
    **{f"{name}-far": (WRITERS[name](FAR, [[0, 1, 6]]), "10 km") for name in ("ply", "stl-text", "obj", "off", "glb")},
    **{f"{name}-index": (WRITERS[name](CORNERS, BEYOND), "vertex 300") for name in ("ply", "ply-little", "obj", "off")},
    **{f"{name}-crossed": (WRITERS[name](CORNERS, BOWTIE), "crosses") for name in ("ply", "ply-little", "obj", "off")},
    "ply-negative-index": (ply(CORNERS, [[0, 1, -1]]), "vertex -1"),
    "ply-half-index": (ply(*BOX).replace(b"\n4 0 1 5 4", b"\n4 0 1.5 5 4"), "vertex 1.5"),
    "ply-cut": (ply(*BOX, "binary_little_endian")[:-9], "truncated"),
    "ply-text-cut": (ply(*BOX)[:-30], "row"),
    "ply-strips": (ply(*BOX).replace(b"element face", b"element tristrips"), "strips"),
    "ply-faces-of-what": (ply(*BOX, lists="uchar int corners"), "vertex_indices"),
    "stl-text-cut": (stl_text(*BOX)[:-200], "line"),
    "stl-text-no-end": (stl_text(*BOX).replace(b"endsolid made by a test\n", b""), "truncated"),
    "stl-text-word": (stl_text(*BOX).replace(b"vertex 0.0 ", b"vertex zero ", 1), "line"),
    "stl-text-two-corners": (stl_text(*BOX).replace(b"      vertex 0.0 0.0 0.0\n", b"", 1), "corners"),
    "stl-signalling-nan": (stl(*BOX)[:96] + b"\x01\0\x80\x7f" + stl(*BOX)[100:], "finite"),
    "glb-infinite-count": (with_accessor(1, count=float("inf")), "malformed"),
    "stl-no-triangles": (stl(CORNERS, BOX_FACES)[:80] + bytes(4), "no triangles"),
    "obj-index-0": (obj(CORNERS, [[-1, 0, 1]]), "line"),
    "obj-two-corners": (obj(CORNERS, [[0, 1]]), "line"),
    "obj-word": (obj(*BOX).replace(b"v 0.06 ", b"v wide "), "line"),
    "obj-back-too-far": (obj(*BOX) + b"f -1 -2 -9\n", "vertex -1"),
    "off-cut": (off(*BOX)[:-10], "truncated"),
    "off-immense": (off(*BOX).replace(b"8 6 0", b"4000000000 6 0"), "truncated"),
    "off-no-counts": (b"OFF\n", "line"),
    "off-binary": (b"OFF BINARY\n" + bytes(40), "binary"),
    "off-negative": (off(*BOX).replace(b"8 6 0", b"-8 6 0"), "line"),
    "glb-index": (glb(SCENE[0], SCENE[1][:-2] + b"\xff\xff"), "Open3D could read"),
    "glb-cut": (glb(*SCENE)[:-8], "truncated"),
    "glb-version-1": (b"glTF" + struct.pack("<II", 1, 12), "version 1"),
    "glb-no-json": (b"glTF" + struct.pack("<II", 2, 12), "malformed"),
    "glb-no-meshes": (changed(meshes=[], nodes=[{}]), "no triangles"),
    "glb-points": (changed(meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}]), "no triangles"),
    "glb-cycle": (changed(nodes=[{"mesh": 0, "children": [0]}]), "twice"),
    "glb-node-of-nowhere": (changed(nodes=[{"mesh": 7}]), "malformed"),
    "glb-draco": (changed(extensionsRequired=["KHR_draco_mesh_compression"]), "draco"),
    "glb-list-for-a-number": (changed(buffers=[{"byteLength": []}]), "malformed"),
    "glb-immense-buffer": (changed(buffers=[{"byteLength": 10**12}]), "buffer"),
    "glb-immense-count": (with_accessor(0, count=10**9), "Open3D"),
    "glb-immense-instances": (with_accessor(1, count=3 * 10**9), "triangles"),
    "glb-sparse": (with_accessor(0, sparse={"count": 1}), "sparse"),
    "glb-no-view": (changed(accessors=[{"componentType": 5126, "count": 9, "type": "VEC3"}] * 2), "sparse"),
    "glb-view-beyond": (changed(bufferViews=[{"buffer": 0, "byteLength": 10**6}] * 2), "buffer"),
    "gltf-elsewhere": (json.dumps(SCENE[0] | {"buffers": [{"byteLength": 9, "uri": "/etc/passwd"}]}).encode(), ".glb"),
    "gltf-nested": (b'{"asset": ' + b"[" * 100_000, "malformed"),
    "json": (b'{"a": 1}', "no glTF"),
}


@pytest.mark.parametrize(("content", "word"), BROKEN.values(), ids=BROKEN)
def test_a_broken_mesh_is_an_error_that_says_why(
    content: bytes, word: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SourceError) as caught:
        read(tmp_path, content)
    text = str(caught.value)
    assert text.startswith(f"{tmp_path / 'mesh'}: ")
    assert word in text
    assert len(text.splitlines()) == 1
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(("suffix", "word"), [("stl", "triangles"), ("obj", "vertices"), ("off", "no faces")])
def test_a_suffix_says_what_a_file_cut_short_should_be(suffix: str, word: str, tmp_path: Path) -> None:
    path = tmp_path / f"mesh.{suffix}"
    path.write_bytes({"stl": stl(*BOX)[:-1], "obj": b"# nothing\n", "off": b"OFF 0 0 0\n"}[suffix])
    with pytest.raises(SourceError) as caught:
        list(read_clouds(path))
    assert word in str(caught.value) or "vertices" in str(caught.value)
