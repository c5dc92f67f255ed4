"""Meshes: every format gives the same evenly sampled surface, and a broken file an error that says why."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sensor import located
from flatgrasp_cli.sources import read_clouds
from flatgrasp_cli.sources.files import read_surface
from flatgrasp_cli.sources.meshes.mesh import ACROSS, MOST_POINTS, PITCH_M, sampled_surface
from flatgrasp_cli.sources.meshes.triangles import triangulated
from tests.conftest import Run

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


@pytest.mark.parametrize("form", WRITERS)
def test_every_format_gives_the_same_surface(form: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    cloud = read(tmp_path, WRITERS[form](BRACKET, BRACKET_FACES))
    expected = sampled_surface(BRACKET[triangles_of(BRACKET, BRACKET_FACES)], "test")
    np.testing.assert_allclose(cloud.points, expected, atol=1e-6)
    assert cloud.sensor is not None
    assert cloud.sensor.sees_all_sides
    assert cloud.sensor.position is None
    np.testing.assert_array_equal(cloud.sensor.direction, [0.0, 0.0, 1.0])
    assert (cloud.viewpoint, cloud.dropped) == (None, 0)
    assert [warning.code for warning in cloud.warnings] == (["mesh_up_assumed"] if form in ("glb", "gltf") else [])
    assert [warning.code for warning in located(cloud, (0.0, 1.0, 0.0), 0).warnings] == []
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS)
def test_the_slot_of_a_u_stays_open(write: Writer, tmp_path: Path) -> None:
    x, y, z = read(tmp_path, write(BRACKET, BRACKET_FACES)).points.T
    slot = (np.abs(x) < 0.0199) & (y > -0.0099)
    assert not slot.any()
    assert z.min() == pytest.approx(0.480, abs=1e-6)
    assert z.max() == pytest.approx(0.500, abs=1e-6)


def test_points_are_spread_by_area_and_leave_no_gaps() -> None:
    points = sampled_surface(CORNERS[triangles_of(CORNERS, BOX_FACES)], "test")
    pitch = 0.060 / ACROSS
    assert len(points) == pytest.approx((2 * 60 * 30 + 2 * 60 * 20 + 2 * 30 * 20) * 1e-6 / pitch**2, rel=1e-3)
    top = points[points[:, 2] > 0.02 - 1e-9]
    assert len(top) / len(points) == pytest.approx(1800 / 7200, rel=0.01)
    anywhere = np.random.default_rng(0).uniform([0.0, 0.0], [0.060, 0.030], (20_000, 2))
    gaps = cKDTree(top[:, :2]).query(anywhere)[0]
    assert gaps.max() < 1.6 * pitch  # a square grid has 0.71, chance about 3
    assert np.array_equal(points, sampled_surface(CORNERS[triangles_of(CORNERS, BOX_FACES)], "test"))


@pytest.mark.parametrize(("scale", "pitch"), [(0.05, 0.003 / ACROSS), (1.0, 0.06 / ACROSS), (4.0, PITCH_M)])
def test_a_pitch_is_a_millimetre_or_a_hundredth_of_the_mesh(scale: float, pitch: float) -> None:
    triangles = scale * CORNERS[triangles_of(CORNERS, BOX_FACES)]
    assert len(sampled_surface(triangles, "test")) == pytest.approx(7.2e-3 * scale**2 / pitch**2, rel=1e-3)


def test_no_mesh_gives_more_points_than_a_camera() -> None:
    triangles = 100.0 * CORNERS[triangles_of(CORNERS, BOX_FACES)]
    assert len(sampled_surface(triangles, "test")) == MOST_POINTS


def test_scale_makes_metres_of_millimetres_and_its_lack_is_told(tmp_path: Path) -> None:
    content = stl(1000 * BRACKET, BRACKET_FACES)
    np.testing.assert_allclose(
        read(tmp_path, content, 0.001).points, read(tmp_path, stl(BRACKET, BRACKET_FACES)).points, atol=1e-6
    )
    (warning,) = read(tmp_path, content).warnings
    assert warning.code == "mesh_size"
    assert "--scale 0.001" in warning.text


POLYGONS: dict[str, list[tuple[float, float]]] = {
    "square": [(0, 0), (1, 0), (1, 1), (0, 1)],
    "arrowhead": [(0, 0), (2, 1), (0, 2), (1, 1)],
    "arrowhead-from-its-bay": [(1, 1), (0, 0), (2, 1), (0, 2)],
    "hexagon": [(np.cos(k * np.pi / 3), np.sin(k * np.pi / 3)) for k in range(6)],
    "corner-on-a-side": [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)],
    "u": [(float(x), float(y)) for x, y in U],
    "star": [((1 + k % 2) * np.cos(k * np.pi / 5), (1 + k % 2) * np.sin(k * np.pi / 5)) for k in range(10)],
}


@pytest.mark.parametrize("turned", [False, True], ids=["ccw", "cw"])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("outline", POLYGONS.values(), ids=POLYGONS)
def test_triangles_cover_their_polygon_and_nothing_else(
    outline: list[tuple[float, float]], axis: int, turned: bool
) -> None:
    flat = np.array(outline[::-1] if turned else outline, dtype=np.float64)
    vertices = np.insert(flat, axis, 0.3 * flat[:, 0] + 0.2 * flat[:, 1], axis=1)  # a slanted plane
    pieces = [shapely.Polygon(flat[triangle]) for triangle in triangles_of(vertices, [list(range(len(flat)))])]
    assert sum(piece.area for piece in pieces) == pytest.approx(shapely.Polygon(flat).area)
    assert shapely.union_all(pieces).symmetric_difference(shapely.Polygon(flat)).area == pytest.approx(0, abs=1e-9)


BOX = CORNERS, BOX_FACES


@pytest.mark.parametrize("write", [ply, obj, off], ids=["ply", "obj", "off"])
def test_without_faces_a_mesh_is_a_cloud(write: Writer, tmp_path: Path) -> None:
    cloud = read(tmp_path, write(CORNERS[1:], []))  # the first corner is 0 0 0
    np.testing.assert_array_equal(cloud.points, CORNERS[1:])
    assert cloud.sensor is None


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


def test_nodes_of_a_gltf_scene_move_its_meshes(tmp_path: Path) -> None:
    document, binary = gltf_scene(*BOX)
    half = float(np.sqrt(0.5))
    document["nodes"] = [
        {"children": [1], "translation": [1.0, 2.0, 3.0]},
        {"mesh": 0, "rotation": [0.0, 0.0, half, half], "scale": [2.0, 1.0, 1.0]},  # a quarter turn about z
        {"mesh": 0},
    ]
    document["scenes"] = [{"nodes": [0, 2]}]
    points = read(tmp_path, glb(document, binary)).points
    here = points[:, 2] < 1
    np.testing.assert_allclose(points[here].max(axis=0), [0.06, 0.03, 0.02], atol=1e-3)
    np.testing.assert_allclose(points[~here].min(axis=0), [0.97, 2.0, 3.0], atol=1e-3)
    np.testing.assert_allclose(points[~here].max(axis=0), [1.0, 2.12, 3.02], atol=1e-3)


def test_a_gltf_buffer_may_be_a_file_beside_it(tmp_path: Path) -> None:
    document, binary = gltf_scene(*BOX)
    path = tmp_path / "box.gltf"
    path.write_text(json.dumps(document | {"buffers": [{"byteLength": len(binary), "uri": "box%20one.bin"}]}))
    with pytest.raises(SourceError, match=r"box one\.bin"):
        list(read_clouds(path))
    (tmp_path / "box one.bin").write_bytes(binary)
    (cloud,) = read_clouds(path)
    np.testing.assert_allclose(cloud.points, read(tmp_path, glb(document, binary)).points)


@pytest.mark.parametrize("name", ["ply", "stl", "stl-text", "obj", "off", "glb"])
def test_the_hand_comes_from_above_and_leaves_the_slot_alone(name: str, tmp_path: Path, run: Run) -> None:
    content = WRITERS[name](BRACKET, BRACKET_FACES)
    path = tmp_path / "bracket"
    path.write_bytes(content)
    ended = run("plan", path, "-g", "pr2", "--json")
    assert ended.code == 0, ended.err
    document = json.loads(ended.out)
    assert document["sensor"]["known_from"] == "all_sides"
    for grasp in document["objects"][0]["grasps"]:
        x, y, _, _ = grasp["pose"]["orientation"]
        assert 1 - 2 * (x * x + y * y) == pytest.approx(-1.0, abs=0.02)  # the approach's z
        assert grasp["width_m"] == pytest.approx(0.020, abs=0.001)
        for place in grasp["contacts"]:
            assert not (abs(place[0]) < 0.019 and place[1] > -0.009)
    other = run("plan", "-", "-g", "pr2", "--json", stdin=content)
    assert json.loads(other.out)["objects"] == document["objects"]


def test_inspect_shows_a_mesh(tmp_path: Path, run: Run) -> None:
    path = tmp_path / "bracket.stl"
    path.write_bytes(stl(BRACKET, BRACKET_FACES))
    ended = run("inspect", path, "--json")
    summary = json.loads(ended.out)
    assert (ended.code, summary["container"]) == (0, "STL")
    np.testing.assert_allclose(summary["clouds"][0]["high_m"], [0.04, 0.03, 0.5], atol=1e-3)


@pytest.mark.parametrize(
    ("name", "content"),
    [("a.stl", stl), ("b.stl", stl_text), ("c.obj", obj), ("d.off", off), ("e.ply", ply)],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_the_triangles_of_a_file_are_those_of_its_faces(
    name: str, content: Callable[[FloatArray, Faces], bytes], tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_bytes(content(1e3 * BRACKET, BRACKET_FACES))
    vertices, triangles = read_surface(path, name, 1e-3)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6  # of a closed surface, by the divergence theorem
    assert volume == pytest.approx((0.08 * 0.06 - 0.04 * 0.04) * 0.02, rel=1e-5)


@pytest.mark.parametrize(
    "text", ["ply\nformat ascii 1.0\nelement vertex 1\n", "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n"]
)
def test_points_have_no_triangles(text: str, tmp_path: Path) -> None:
    path = tmp_path / "points"
    ends = {
        "p": "property float x\nproperty float y\nproperty float z\nend_header\n0 0 1\n",
        "#": "SIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 1\n",
    }
    path.write_text(text + ends[text[0]], encoding="utf-8")
    with pytest.raises(SourceError, match="points: has no faces; a mesh is wanted"):
        read_surface(path, "points")
