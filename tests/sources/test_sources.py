"""PCD and PLY files: every layout gives the points that were written, every broken file an error that names it."""

from __future__ import annotations

import struct
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.sources import read_clouds

Table = NDArray[np.void]
Dtype = list[tuple[Any, ...]]

N = 208
POINTS: FloatArray = np.random.default_rng(7).integers(-200, 200, (N, 3)) / 1024.0
"""Exact in float32 and in a few decimals, so that nothing but equality will do."""
FINE: FloatArray = 1000.0 + np.random.default_rng(8).random((N, 3))
"""Needs float64."""
XYZ: Dtype = [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]
PCD_DATA = ("ascii", "binary", "binary_compressed")
PLY_FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")
PLY_TYPES = {"f4": "float", "f8": "double", "i1": "char", "u1": "uchar", "i2": "short", "u2": "ushort", "i4": "int"}
PLY_TYPES["u4"] = "uint"
SPECIAL = ("normal_x", "positions", "normals", "colors", "rgb", "rgba", "nx", "red", "intensity", "label", "curvature")
"""Names that mean something to Open3D or PCL, each alone where it takes several to mean it."""


def table(dtype: Dtype, points: FloatArray = POINTS) -> Table:
    """Rows of a structured dtype: x, y and z from `points`, small positive numbers elsewhere."""
    rows = np.zeros(len(points), np.dtype(dtype))
    rng = np.random.default_rng(1)
    for name in rows.dtype.names or ():
        rows[name] = points[:, "xyz".index(name)] if name in ("x", "y", "z") else rng.integers(1, 100, rows[name].shape)
    return rows


def text_rows(rows: Table, end: str = "\n") -> bytes:
    """Rows as text, the entries of a field with a count one after another."""
    names = rows.dtype.names or ()
    lines = (" ".join(str(value) for name in names for value in np.ravel(row[name]).tolist()) for row in rows)
    return "".join(line + end for line in lines).encode()


def lzf(data: bytes) -> bytes:
    """LZF data of literal runs alone: a length less one, then that many bytes."""
    return b"".join(bytes([len(run) - 1]) + run for run in (data[k : k + 32] for k in range(0, len(data), 32)))


def pcd_header(rows: Table, data: str, **lines: str) -> bytes:
    """A PCD header; `lines` replace its lines, an empty one goes. Fields called _, _1, … are padding, all called _."""
    dtype = rows.dtype
    names = dtype.names or ()
    kinds = [dtype[name].base for name in names]
    words = {
        "VERSION": "0.7",
        "FIELDS": " ".join("_" if name[1:].isdigit() and name[0] == "_" else name for name in names),
        "SIZE": " ".join(str(kind.itemsize) for kind in kinds),
        "TYPE": " ".join(kind.kind.upper() for kind in kinds),
        "COUNT": " ".join(str(int(np.prod(dtype[name].shape, dtype=int))) for name in names),
        "WIDTH": str(len(rows)),
        "HEIGHT": "1",
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(len(rows)),
        "DATA": data,
    } | lines
    text = "".join(f"{key} {value}\n" for key, value in words.items() if value)
    return b"# .PCD v0.7 - Point Cloud Data file format\n" + text.encode()


def pcd_data(rows: Table, data: str) -> bytes:
    """What follows the header: rows as text, rows packed, or columns packed and compressed."""
    if data == "ascii":
        return text_rows(rows)
    if data == "binary":
        return rows.tobytes()
    columns = b"".join(np.ascontiguousarray(rows[name]).tobytes() for name in rows.dtype.names or ())
    packed = lzf(columns)
    return struct.pack("<II", len(packed), len(columns)) + packed


def pcd(rows: Table, data: str = "binary", **lines: str) -> bytes:
    """A PCD file."""
    return pcd_header(rows, data, **lines) + pcd_data(rows, data)


def ply_element(name: str, rows: Table) -> str:
    """An element's lines of a PLY header."""
    names = rows.dtype.names or ()
    properties = "".join(f"property {PLY_TYPES[rows.dtype[each].str[1:]]} {each}\n" for each in names)
    return f"element {name} {len(rows)}\n{properties}"


def ply_rows(rows: Table, form: str, end: str = "\n") -> bytes:
    """An element's data."""
    if form == "ascii":
        return text_rows(rows, end)
    return rows.astype(rows.dtype.newbyteorder(">" if form == "binary_big_endian" else "<")).tobytes()


def ply(rows: Table, form: str = "ascii", before: Table | None = None, links: int = 0, end: str = "\n") -> bytes:
    """A PLY file: perhaps an element before the vertices, perhaps links of them after; `end` ends its lines."""
    header = f"ply\nformat {form} 1.0\ncomment made by a test\nobj_info none\n"
    data = b""
    if before is not None:
        header += ply_element("camera", before)
        data += ply_rows(before, form, end)
    header += ply_element("vertex", rows)
    data += ply_rows(rows, form, end)
    if links:
        header += f"element link {links}\nproperty list uchar int vertex_indices\n"
        order = ">" if form == "binary_big_endian" else "<"
        triangle = f"3 0 1 2{end}".encode() if form == "ascii" else struct.pack(f"{order}B3i", 3, 0, 1, 2)
        data += links * triangle
    return (header + "end_header\n").replace("\n", end).encode() + data


def read(folder: Path, content: bytes, name: str = "cloud", scale: float = 1.0) -> Cloud:
    """The one cloud of a file with this content; its name has no suffix, for content alone must tell what it is."""
    path = folder / name
    path.write_bytes(content)
    (cloud,) = read_clouds(path, scale)
    return cloud


def assert_same(cloud: Cloud, points: FloatArray = POINTS) -> None:
    """The cloud holds these points, all of them, in this order."""
    assert cloud.points.dtype == np.float64
    np.testing.assert_array_equal(cloud.points, points)
    assert cloud.dropped == 0


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


WRITERS = {
    **{f"pcd-{data}": (pcd, data) for data in PCD_DATA},
    **{f"ply-{form}": (ply, form) for form in PLY_FORMATS},
}


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


ROWS = table(XYZ)
HUGE = str(10**12)
ASCII, BINARY, PACKED = (pcd(ROWS, data) for data in PCD_DATA)
BODY = len(pcd_header(ROWS, "binary_compressed"))
COUNTED = {"WIDTH": "300", "POINTS": "300"}
ENDLESS = {"WIDTH": HUGE, "POINTS": HUGE}


def with_row(row: bytes, content: bytes = ASCII, at: int = 5) -> bytes:
    """An ascii file whose row `at`, counted from its end, is another."""
    lines = content.splitlines()
    lines[-at] = row
    return b"\n".join(lines) + b"\n"


def with_sizes(packed: int, unpacked: int) -> bytes:
    """The compressed file with other words for its compressed and its unpacked size, of the two as they are."""
    sizes = struct.unpack_from("<II", PACKED, BODY)
    return PACKED[:BODY] + struct.pack("<II", sizes[0] + packed, sizes[1] + unpacked) + PACKED[BODY + 8 :]


BROKEN: dict[str, tuple[bytes, str]] = {
    "empty": (b"", "empty"),
    "random-bytes": (np.random.default_rng(3).bytes(4096), "neither"),
    "text": (b"hello, this is no cloud\n", "neither"),
    "pcd-magic-alone": (b"# .PCD v0.7 - Point Cloud Data file format\n", "neither"),
    "pcd-magic-random": (b"# .PCD v0.7\nFIELDS x y z\n" + np.random.default_rng(3).bytes(4096), "header"),
    "pcd-header-cut": (pcd_header(ROWS, "binary")[:-14], "DATA"),
    "pcd-ascii-declares-more": (pcd(ROWS, "ascii", **COUNTED), "300"),
    "pcd-binary-declares-more": (pcd(ROWS, "binary", **COUNTED), "300"),
    "pcd-compressed-declares-more": (pcd(ROWS, "binary_compressed", **COUNTED), "300"),
    "pcd-binary-cut": (BINARY[:-1], "truncated"),
    "pcd-binary-no-data": (pcd_header(ROWS, "binary"), "truncated"),
    "pcd-compressed-cut": (PACKED[:-1], "truncated"),
    "pcd-compressed-no-sizes": (PACKED[: BODY + 5], "truncated"),
    "pcd-no-x": (pcd(table([("y", "<f4"), ("z", "<f4")])), "x, y and z"),
    "pcd-two-x": (pcd(ROWS, FIELDS="x x z"), "x, y and z"),
    "pcd-x-of-count-2": (pcd(ROWS, COUNT="2 1 1"), "COUNT"),
    "pcd-few-sizes": (pcd(ROWS, SIZE="4 4"), "SIZE"),
    "pcd-many-types": (pcd(ROWS, TYPE="F F F F"), "TYPE"),
    "pcd-few-counts": (pcd(ROWS, COUNT="1 1"), "COUNT"),
    "pcd-size-3": (pcd(ROWS, SIZE="3 3 3"), "SIZE"),
    "pcd-type-q": (pcd(ROWS, TYPE="Q Q Q"), "TYPE"),
    "pcd-count-negative": (pcd(ROWS, COUNT="1 1 -1"), "COUNT"),
    "pcd-size-word": (pcd(ROWS, COUNT="1 1 one"), "one"),
    "pcd-width-word": (pcd(ROWS, WIDTH="wide"), "wide"),
    "pcd-width-negative": (pcd(ROWS, WIDTH="-208", HEIGHT="-1"), "WIDTH"),
    "pcd-shape-is-not-points": (pcd(ROWS, WIDTH="16", HEIGHT="16"), "POINTS"),
    "pcd-no-width": (pcd(ROWS, WIDTH="", POINTS=""), "WIDTH"),
    "pcd-viewpoint-short": (pcd(ROWS, VIEWPOINT="0 0 0"), "VIEWPOINT"),
    "pcd-viewpoint-nan": (pcd(ROWS, VIEWPOINT="0 nan 0 1 0 0 0"), "VIEWPOINT"),
    "pcd-unknown-data": (pcd(ROWS, "binary", DATA="binary_zstd"), "binary_zstd"),
    "pcd-zero-points": (pcd(ROWS[:0], "binary"), "no points"),
    "pcd-zero-points-ascii": (pcd(ROWS[:0], "ascii"), "no points"),
    "pcd-row-short": (with_row(b"0.5 0.25"), "0.5 0.25"),
    "pcd-row-long": (with_row(b"0.5 0.25 1 2"), "0.5 0.25 1 2"),
    "pcd-row-word": (with_row(b"0.5 broken 0.25"), "broken"),
    "pcd-row-word-of-number-letters": (with_row(b"0.5 fine 0.25"), "fine"),
    "pcd-row-two-points": (with_row(b"0.5 1.2.3 0.25"), "1.2.3"),
    "pcd-row-dash": (with_row(b"0.5 - 0.25"), "0.5 - 0.25"),
    "pcd-row-comma": (with_row(b"0,5 0,1 0,25"), "0,5"),
    "pcd-row-binary": (with_row(b"\x00\x01 \xff\xfe \x00"), "row"),
    "pcd-packed-size-more": (with_sizes(1, 0), "truncated"),
    "pcd-packed-size-less": (with_sizes(-40, 0), "points"),
    "pcd-unpacked-size-more": (with_sizes(0, 4), "unpack"),
    "pcd-unpacked-size-less": (with_sizes(0, -4), "unpack"),
    "pcd-packed-garbage": (PACKED[: BODY + 8] + b"\xff" * (len(PACKED) - BODY - 8), "points"),
    "ply-magic-alone": (b"ply\n", "header"),
    "ply-header-cut": (ply(ROWS)[:60], "header"),
    "ply-no-format": (ply(ROWS).replace(b"format ascii 1.0\n", b""), "format"),
    "ply-unknown-format": (ply(ROWS).replace(b"ascii", b"zstd"), "zstd"),
    "ply-unknown-type": (ply(ROWS).replace(b"float x", b"half x"), "half"),
    "ply-unknown-line": (ply(ROWS).replace(b"obj_info", b"garbage"), "garbage"),
    "ply-property-first": (b"ply\nformat ascii 1.0\nproperty float x\nend_header\n", "header"),
    "ply-count-word": (ply(ROWS).replace(b"vertex 208", b"vertex many"), "many"),
    "ply-count-negative": (ply(ROWS).replace(b"vertex 208", b"vertex -208"), "negative"),
    "ply-no-vertex": (ply(ROWS).replace(b"vertex 208", b"vortex 208"), "vertices"),
    "ply-no-x": (ply(table([("y", "<f4"), ("z", "<f4")])), "x, y and z"),
    "ply-two-x": (ply(ROWS).replace(b"float y", b"float x"), "x, y and z"),
    "ply-zero-points": (ply(ROWS[:0]), "no points"),
    "ply-zero-points-binary": (ply(ROWS[:0], PLY_FORMATS[1]), "no points"),
    "ply-ascii-cut": (ply(ROWS)[:-500], "row"),
    "ply-little-cut": (ply(ROWS, PLY_FORMATS[1])[:-1], "truncated"),
    "ply-big-cut": (ply(ROWS, PLY_FORMATS[2])[:-500], "truncated"),
    "ply-row-short": (with_row(b"0.5 0.25", ply(ROWS)), "0.5 0.25"),
    "ply-row-word": (with_row(b"0.5 broken 0.25", ply(ROWS)), "broken"),
    "ply-row-word-of-number-letters": (with_row(b"0.5 fine 0.25", ply(ROWS)), "fine"),
    "ply-list-in-vertex": (ply(ROWS).replace(b"property float z", b"property list uchar float z"), "x, y and z"),
    "mcap": (b"\x89MCAP0\r\n" + bytes(64), "MCAP"),
    "ros-1-bag": (b"#ROSBAG V2.0\n" + bytes(64), "ROS 1"),
}


def refusal(path: Path) -> str:
    """The text of the error that reading the path raises; it names the path and fits two lines."""
    with pytest.raises(SourceError) as caught:
        list(read_clouds(path))
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert len(text.splitlines()) <= 2
    return text.removeprefix(f"{path}: ")


@pytest.mark.parametrize(("content", "word"), BROKEN.values(), ids=BROKEN)
def test_a_broken_file_is_an_error_that_says_why(content: bytes, word: str, tmp_path: Path) -> None:
    path = tmp_path / "broken"
    path.write_bytes(content)
    assert word in refusal(path)


IMMENSE = {
    **{f"pcd-{data}": pcd(ROWS, data, **ENDLESS) for data in PCD_DATA},
    "pcd-count": pcd(table([*XYZ, ("ids", "u1")]), COUNT=f"1 1 1 {HUGE}"),
    "pcd-unpacked": with_sizes(0, 2**31),
    **{f"ply-{form}": ply(ROWS, form).replace(b"vertex 208", f"vertex {HUGE}".encode()) for form in PLY_FORMATS},
}


@pytest.mark.parametrize("content", IMMENSE.values(), ids=IMMENSE)
def test_an_immense_count_is_refused_before_anything_is_read(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("flatgrasp_cli.sources.pcd_compressed.load_open3d", lambda: opened.append("open3d"))
    path = tmp_path / "broken"
    path.write_bytes(content)
    assert "the header declares" in refusal(path) or "should be" in refusal(path)
    assert opened == []


PLACES = {
    "missing": ("missing.pcd", "No such file"),
    "below-a-file": ("file/cloud.pcd", "Not a directory"),
    "a-folder": ("folder", "folder"),
    "name-too-long": ("a" * 300 + ".pcd", "too long"),
}


@pytest.mark.parametrize(("name", "word"), PLACES.values(), ids=PLACES)
def test_a_place_without_a_file_is_an_error(name: str, word: str, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_bytes(ASCII)
    assert word in refusal(tmp_path / name)


NUMBERS = st.sampled_from(("i1", "u1", "<i2", "<u2", "<i4", "<u4", "<f4", "<f8"))
NAMES = st.one_of(st.sampled_from((*SPECIAL, "_")), st.from_regex(r"[a-zA-Z_]{1,9}", fullmatch=True))


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
