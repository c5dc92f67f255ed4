"""Meshes become points of their surface, whatever their format."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sensor import located
from flatgrasp_cli.sources import read_clouds
from flatgrasp_cli.sources.files import read_surface
from flatgrasp_cli.sources.meshes.mesh import ACROSS, MOST_POINTS, PITCH_M, sampled_surface
from tests.conftest import Run
from tests.sources.meshes import (
    BOX,
    BOX_FACES,
    BRACKET,
    BRACKET_FACES,
    CORNERS,
    WRITERS,
    U,
    Writer,
    glb,
    gltf_scene,
    obj,
    off,
    ply,
    read,
    stl,
    triangles_of,
)


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


@pytest.mark.parametrize("write", [ply, obj, off], ids=["ply", "obj", "off"])
def test_without_faces_a_mesh_is_a_cloud(write: Writer, tmp_path: Path) -> None:
    cloud = read(tmp_path, write(CORNERS[1:], []))  # the first corner is 0 0 0
    np.testing.assert_array_equal(cloud.points, CORNERS[1:])
    assert cloud.sensor is None


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
    (same,) = read_clouds(f"{tmp_path}//./box.gltf")  # as shells and people complete it
    np.testing.assert_array_equal(same.points, cloud.points)


@pytest.mark.parametrize("name", ["ply", "stl", "stl-text", "obj", "off", "glb"])
def test_the_hand_comes_from_above_and_leaves_the_slot_alone(name: str, tmp_path: Path, run: Run) -> None:
    content = WRITERS[name](BRACKET, BRACKET_FACES)
    path = tmp_path / "bracket"
    path.write_bytes(content)
    ended = run("plan", path, "-g", "pr2", "--json")
    assert ended.code == 0, ended.err
    document = json.loads(ended.out)
    assert document["sensor"]["known_from"] == "all_sides"
    grasps = document["objects"][0]["grasps"]
    assert grasps[0]["width_m"] == pytest.approx(0.020, abs=0.0015)  # 3 degrees aslant it is still held
    for grasp in grasps:
        x, y, _, _ = grasp["pose"]["orientation"]
        assert 1 - 2 * (x * x + y * y) == pytest.approx(-1.0, abs=0.02)  # the approach's z
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


@pytest.mark.parametrize("form", WRITERS)
def test_the_triangles_of_a_file_are_those_of_its_faces(form: str, tmp_path: Path) -> None:
    path = tmp_path / "bracket"
    path.write_bytes(WRITERS[form](1e3 * BRACKET, BRACKET_FACES))
    vertices, triangles = read_surface(path, path.name, 1e-3)
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
