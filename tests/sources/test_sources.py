"""PCD and PLY files: every layout gives the points that were written."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from string import ascii_letters
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.sources import read_clouds
from tests.sources.pcd_ply import (
    FINE,
    PCD_DATA,
    PLY_FORMATS,
    PLY_TYPES,
    POINTS,
    SPECIAL,
    WRITERS,
    XYZ,
    Dtype,
    N,
    assert_same,
    pcd,
    pcd_data,
    pcd_header,
    ply,
    read,
    table,
    text_rows,
)

LAYOUTS: dict[str, Dtype] = {
    "xyz": XYZ,
    "zyx": XYZ[::-1],
    "extra-between": [("rgb", "<u4"), ("y", "<f4"), ("label", "u1"), ("x", "<f4"), ("t", "<f8"), ("z", "<f4")],
    "padding": [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("_", "u1", 4), ("intensity", "<f4"), ("_1", "u1", 12)],
    "counts": [("fpfh", "<f4", 33), ("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("ids", "<u2", 2)],
    "float64": [("x", "<f8"), ("y", "<f8"), ("z", "<f8")],
    "int16": [("x", "<i2"), ("y", "<i2"), ("z", "<i2")],
    **{f"lone-{name}": [(name, "<f4"), *XYZ] for name in SPECIAL},
    "normals-all": [*XYZ, ("normal_x", "<f4"), ("normal_y", "<f4"), ("normal_z", "<f4"), ("curvature", "<f4")],
    "normals-two": [("normal_x", "<f4"), *XYZ, ("normal_y", "<f4")],
    "rgb-count-3": [*XYZ, ("rgb", "u1", 3)],
    "colors-count-3": [*XYZ, ("colors", "<f4", 3)],
}


@pytest.mark.parametrize("data", PCD_DATA)
@pytest.mark.parametrize("dtype", LAYOUTS.values(), ids=LAYOUTS)
def test_pcd_layouts_give_the_same_points(dtype: Dtype, data: str, tmp_path: Path) -> None:
    points = np.round(100 * POINTS) if dtype[0][1] == "<i2" else POINTS
    assert_same(read(tmp_path, pcd(table(dtype, points), data)), points)


@pytest.mark.parametrize("data", PCD_DATA)
def test_pcd_float64_loses_no_digit(data: str, tmp_path: Path) -> None:
    assert_same(read(tmp_path, pcd(table(LAYOUTS["float64"], FINE), data)), FINE)


@pytest.mark.parametrize("compressed", [False, True])
def test_pcd_written_by_open3d(compressed: bool, tmp_path: Path) -> None:
    open3d = load_open3d()
    cloud = open3d.t.geometry.PointCloud(open3d.core.Tensor(POINTS.astype(np.float32)))
    cloud.point.normals = open3d.core.Tensor(np.ones((N, 3), np.float32))
    path = tmp_path / "cloud.pcd"
    assert open3d.t.io.write_point_cloud(str(path), cloud, compressed=compressed)
    assert (b"DATA binary_compressed" in path.read_bytes()) == compressed
    (back,) = read_clouds(path)
    assert_same(back)


SHAPES = {
    "organised": {"WIDTH": "16", "HEIGHT": "13"},
    "height-major": {"WIDTH": "1", "HEIGHT": str(N)},
    "no-points-line": {"POINTS": ""},
    "no-count-line": {"COUNT": ""},
    "no-viewpoint-line": {"VIEWPOINT": ""},
    "version-.7": {"VERSION": ".7"},
}


@pytest.mark.parametrize("data", PCD_DATA)
@pytest.mark.parametrize("lines", SHAPES.values(), ids=SHAPES)
def test_pcd_header_variants_give_the_same_points(lines: dict[str, str], data: str, tmp_path: Path) -> None:
    assert_same(read(tmp_path, pcd(table(XYZ), data, **lines)))


@pytest.mark.parametrize("data", PCD_DATA)
def test_pcd_header_lines_may_end_in_crlf(data: str, tmp_path: Path) -> None:
    rows = table(XYZ)
    body = text_rows(rows, "\r\n") if data == "ascii" else pcd_data(rows, data)
    assert_same(read(tmp_path, pcd_header(rows, data).replace(b"\n", b"\r\n") + body))


def test_pcd_may_begin_with_long_comments_and_no_magic(tmp_path: Path) -> None:
    assert_same(read(tmp_path, b"# recorded by a test\n" * 100 + pcd(table(XYZ), "ascii").split(b"\n", 1)[1]))


def test_pcd_viewpoint_is_the_sensors_place(tmp_path: Path) -> None:
    rows = table(XYZ)
    cloud = read(tmp_path, pcd(rows, VIEWPOINT="0.5 -1 2.25 0 1 0 0"))
    assert cloud.viewpoint == pytest.approx([0.5, -1.0, 2.25])
    assert_same(cloud)
    assert read(tmp_path, pcd(rows, VIEWPOINT="")).viewpoint is None


def test_the_source_is_the_path_as_given(tmp_path: Path) -> None:
    cloud = read(tmp_path, pcd(table(XYZ)))
    assert cloud.source.path == str(tmp_path / "cloud")
    assert (cloud.source.topic, cloud.source.stamp_ns, cloud.source.index) == (None, None, 0)


PLY_LAYOUTS: dict[str, Dtype] = {
    "xyz": XYZ,
    "zyx": XYZ[::-1],
    "double": LAYOUTS["float64"],
    "mixed": [("x", "<f4"), ("y", "<f8"), ("z", "<f4")],
    "mixed-extra": [("nx", "<f8"), ("z", "<f8"), ("red", "u1"), ("y", "<f4"), ("x", "<f8"), ("quality", "<f4")],
    "colours": [*XYZ, ("red", "u1"), ("green", "u1"), ("blue", "u1"), ("alpha", "u1")],
    "normals": [("nx", "<f4"), ("ny", "<f4"), ("nz", "<f4"), *XYZ],
    "all-types": [*XYZ, *((f"p{k}", f"<{kind}") for k, kind in enumerate(PLY_TYPES))],
    **{f"lone-{name}": [(name, "<f4"), *XYZ] for name in SPECIAL},
}


@pytest.mark.parametrize("form", PLY_FORMATS)
@pytest.mark.parametrize("dtype", PLY_LAYOUTS.values(), ids=PLY_LAYOUTS)
def test_ply_layouts_give_the_same_points(dtype: Dtype, form: str, tmp_path: Path) -> None:
    assert_same(read(tmp_path, ply(table(dtype), form)))


@pytest.mark.parametrize("form", PLY_FORMATS)
def test_ply_doubles_lose_no_digit(form: str, tmp_path: Path) -> None:
    assert_same(read(tmp_path, ply(table(LAYOUTS["float64"], FINE), form)), FINE)


@pytest.mark.parametrize("end", ["\n", "\r\n"], ids=["lf", "crlf"])
@pytest.mark.parametrize("form", PLY_FORMATS)
def test_ply_elements_around_the_vertices(form: str, end: str, tmp_path: Path) -> None:
    camera = np.array([(7, 0.5), (8, 1.5)], [("id", "<i4"), ("x", "<f8")])
    assert_same(read(tmp_path, ply(table(XYZ), form, before=camera, links=5, end=end)))


@pytest.mark.parametrize(("value", "shift"), [(np.nan, 60), (np.inf, 90), (-np.inf, 120)], ids=["nan", "inf", "-inf"])
@pytest.mark.parametrize("form", PLY_FORMATS)
def test_ply_other_properties_need_not_be_finite(form: str, value: float, shift: int, tmp_path: Path) -> None:
    points = np.roll(POINTS, shift + len(form), axis=0)  # no other test's: unset memory may hold those
    rows = table([*XYZ, ("quality", "<f4")], points)
    rows["quality"][5] = value
    assert_same(read(tmp_path, ply(rows, form)), points)


def test_ply_value_beyond_its_type_spoils_no_point(tmp_path: Path) -> None:
    points = np.roll(POINTS, 50, axis=0)
    content = ply(table([*XYZ, ("red", "<u2")], points)).replace(b"ushort red", b"uchar red")
    lines = content.splitlines()
    lines[-100] = lines[-100].rsplit(b" ", 1)[0] + b" 300"
    try:
        cloud = read(tmp_path, b"\n".join(lines) + b"\n")
    except SourceError as error:
        assert "300" in str(error)  # noqa: PT017 (either will do: the points, or a refusal)
    else:
        assert_same(cloud, points)


@pytest.mark.parametrize("form", PLY_FORMATS)
def test_ply_is_seen_from_the_origin(form: str, tmp_path: Path) -> None:
    assert read(tmp_path, ply(table(XYZ), form)).viewpoint is None


@pytest.mark.parametrize(("write", "how"), WRITERS.values(), ids=WRITERS)
def test_nan_and_inf_are_dropped_and_counted(write: Any, how: str, tmp_path: Path) -> None:
    points = POINTS.copy()
    points[3, 0], points[10], points[50, 2], points[N - 1, 1] = np.nan, np.nan, np.inf, -np.inf
    cloud = read(tmp_path, write(table(XYZ, points), how))
    np.testing.assert_array_equal(cloud.points, np.delete(POINTS, [3, 10, 50, N - 1], axis=0))
    assert cloud.dropped == 4


@pytest.mark.parametrize(("write", "how"), WRITERS.values(), ids=WRITERS)
def test_a_cloud_of_nan_alone_is_an_empty_cloud(write: Any, how: str, tmp_path: Path) -> None:
    cloud = read(tmp_path, write(table(XYZ, np.full((5, 3), np.nan)), how))
    assert cloud.points.shape == (0, 3)
    assert cloud.dropped == 5


@pytest.mark.parametrize(("write", "how"), WRITERS.values(), ids=WRITERS)
def test_scale_makes_metres_of_millimetres(write: Any, how: str, tmp_path: Path) -> None:
    cloud = read(tmp_path, write(table(XYZ, 1024 * POINTS), how), scale=0.001)
    np.testing.assert_allclose(cloud.points, 1.024 * POINTS, rtol=1e-12)


def test_scale_moves_the_viewpoint_too(tmp_path: Path) -> None:
    cloud = read(tmp_path, pcd(table(XYZ), VIEWPOINT="0 500 1000 1 0 0 0"), scale=0.001)
    assert cloud.viewpoint == pytest.approx([0.0, 0.5, 1.0])


@pytest.mark.parametrize("scale", [0.0, -1.0, np.nan, np.inf])
def test_a_scale_that_is_no_positive_number_is_refused(scale: float, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=f"a positive number, not {scale}"):
        read(tmp_path, pcd(table(XYZ)), scale=scale)


@pytest.mark.parametrize("turn", ["1 0 0 0", "0.5 0.5 0.5 0.5"])
@pytest.mark.parametrize("scale", [1.0, 10.0])
def test_a_viewpoint_too_far_to_be_written_in_metres_is_none(turn: str, scale: float, tmp_path: Path) -> None:
    cloud = read(tmp_path, pcd(table(XYZ), VIEWPOINT=f"1.7e308 1.7e308 1.7e308 {turn}"), scale=scale)
    assert (cloud.viewpoint, cloud.inverse_viewpoint) == (None, None)


@pytest.mark.parametrize("name", ["a\0b", "\ud800"])
def test_what_no_path_is_made_of_is_said(name: str) -> None:
    with pytest.raises(SourceError, match="is no path"):
        next(read_clouds(name))


NUMBERS = st.sampled_from(("i1", "u1", "<i2", "<u2", "<i4", "<u4", "<f4", "<f8"))
NAMES = st.one_of(st.sampled_from((*SPECIAL, "_")), st.text(ascii_letters + "_", min_size=1, max_size=9))


@st.composite
def layouts(draw: st.DrawFn, counts: Sequence[int]) -> Dtype:
    """x, y, z of one type and up to five other fields, in any order."""
    kind = draw(st.sampled_from(("<f4", "<f8")))
    names = draw(st.lists(NAMES.filter(lambda name: name not in ("x", "y", "z")), max_size=5, unique=True))
    extra = [(name, draw(NUMBERS), (draw(st.sampled_from(counts)),)) for name in names]
    return draw(st.permutations([*((axis, kind) for axis in "xyz"), *extra]))


@settings(max_examples=60)
@given(dtype=layouts((1, 2, 5)), data=st.sampled_from(PCD_DATA))
def test_pcd_fields_may_come_in_any_order_among_any_others(dtype: Dtype, data: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        assert_same(read(Path(folder), pcd(table(dtype), data)))


@settings(max_examples=60)
@given(dtype=layouts((1,)), form=st.sampled_from(PLY_FORMATS))
def test_ply_properties_may_come_in_any_order_among_any_others(dtype: Dtype, form: str) -> None:
    scalars = [column[:2] for column in dtype]
    with tempfile.TemporaryDirectory() as folder:
        assert_same(read(Path(folder), ply(table(scalars), form)))
