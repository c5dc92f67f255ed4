"""PCD, PLY and folders as people really have them: read, with a warning where something was assumed, or refused."""

from __future__ import annotations

import os
import struct
import threading
import tracemalloc
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.sources import read_clouds
from tests.conftest import SAMPLES, Run
from tests.sources.pcd_ply import (
    PCD_DATA,
    PLY_FORMATS,
    POINTS,
    XYZ,
    Dtype,
    N,
    assert_same,
    pcd,
    pcd_data,
    pcd_header,
    ply,
    read,
    refusal,
    table,
    text_rows,
)

ROWS = table(XYZ)
MARK = b"\xef\xbb\xbf"
MIXED: Dtype = [("x", "<f4"), ("t", "<f8"), ("y", "<f8"), ("z", "<i2"), ("ring", "u1")]


@pytest.mark.parametrize("data", PCD_DATA)
@pytest.mark.parametrize(
    "lines",
    [
        {"TYPE": "f f f"},
        {"VERSION": ".5", "COUNT": "", "WIDTH": "", "HEIGHT": "", "VIEWPOINT": ""},
        {"WIDTH": "", "HEIGHT": ""},
        {"FIELDS": "X Y Z"},
    ],
    ids=["lower-case-type", "version-.5", "points-alone", "upper-case-fields"],
)
def test_pcd_headers_that_people_have(lines: dict[str, str], data: str, tmp_path: Path) -> None:
    content = pcd(ROWS, data, **lines)
    assert_same(read(tmp_path, content))
    if lines.get("VERSION"):
        assert_same(read(tmp_path, content.replace(b"FIELDS", b"COLUMNS")))


@pytest.mark.parametrize("data", PCD_DATA)
def test_pcd_header_lines_in_any_case(data: str, tmp_path: Path) -> None:
    header = pcd_header(ROWS, data)
    assert_same(read(tmp_path, header.lower() + pcd_data(ROWS, data)))
    assert_same(read(tmp_path, header.replace(data.encode(), data.upper().encode()) + pcd_data(ROWS, data)))


@pytest.mark.parametrize("data", PCD_DATA)
@pytest.mark.parametrize("points", [np.round(100 * POINTS)], ids=["mixed"])
def test_pcd_fields_x_y_z_may_have_types_of_their_own(points: FloatArray, data: str, tmp_path: Path) -> None:
    assert_same(read(tmp_path, pcd(table(MIXED, points), data)), points)


@pytest.mark.parametrize("data", PCD_DATA)
@pytest.mark.parametrize("counts", ["1 1 1 0 1", "0 0 0 0 0"], ids=["one", "all"])
def test_pcd_count_0_is_padding_of_no_bytes_or_a_single_value_as_the_data_say(
    counts: str, data: str, tmp_path: Path
) -> None:
    fields: Dtype = [*XYZ, ("ring", "<u2"), ("t", "<f8")]
    assert_same(read(tmp_path, pcd(table(fields), data, COUNT=counts)))
    empty = {"FIELDS": "x y z _ t", "SIZE": "4 4 4 1 8", "TYPE": "F F F U F"}
    if counts.startswith("1"):
        assert_same(read(tmp_path, pcd(table([*XYZ, ("t", "<f8")]), data, COUNT=counts, **empty)))


NOT_MEASURED = ["nan", "-nan", "NaN", "nan(ind)", "-nan(ind)", "-nan(snan)", "1.#QNAN", "-1.#IND", "-1.#IND00"]
NOT_MEASURED += ["1.#INF", "-1.#INF00", "1.#J", "inf", "-Infinity", "1e999"]


@pytest.mark.parametrize("word", NOT_MEASURED)
@pytest.mark.parametrize("write", [pcd, ply], ids=["pcd", "ply"])
def test_what_c_libraries_write_for_no_number_is_not_measured(write: Any, word: str, tmp_path: Path) -> None:
    lines = write(ROWS, "ascii").splitlines()
    lines[-1] = b"0.5 " + word.encode() + b" 0.25"
    cloud = read(tmp_path, b"\n".join(lines) + b"\n")
    np.testing.assert_array_equal(cloud.points, POINTS[:-1])
    assert cloud.dropped == 1


MORE = "more_points_than_declared"
FEWER = {"WIDTH": str(N - 8), "POINTS": str(N - 8)}


@pytest.mark.parametrize("content", [pcd(ROWS, "ascii", **FEWER), pcd(ROWS, "binary", **FEWER)], ids=PCD_DATA[:2])
def test_pcd_with_more_points_than_declared_is_read_and_told(content: bytes, tmp_path: Path) -> None:
    cloud = read(tmp_path, content)
    assert_same(cloud, POINTS[:-8])
    assert [item.code for item in cloud.warnings] == [MORE]


@pytest.mark.parametrize("form", PLY_FORMATS)
def test_ply_with_more_points_than_declared_is_read_and_told(form: str, tmp_path: Path) -> None:
    cloud = read(tmp_path, ply(ROWS, form).replace(b"vertex 208", b"vertex 200"))
    assert_same(cloud, POINTS[:-8])
    assert [item.code for item in cloud.warnings] == [MORE]


@pytest.mark.parametrize("content", [pcd(ROWS, "ascii"), pcd(ROWS), ply(ROWS), ply(ROWS, PLY_FORMATS[1])])
def test_a_line_end_behind_the_last_point_is_no_further_point(content: bytes, tmp_path: Path) -> None:
    cloud = read(tmp_path, content + b"\n \n")
    assert_same(cloud)
    assert cloud.warnings == ()


FORMS = {
    **{f"pcd-{data}": (pcd_header(ROWS, data), pcd_data(ROWS, data)) for data in PCD_DATA},
    **{f"ply-{form}": tuple(ply(ROWS, form).partition(b"end_header\n")[::2]) for form in PLY_FORMATS},
}


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"], ids=["lf", "crlf", "cr"])
@pytest.mark.parametrize("mark", [b"", MARK], ids=["", "byte-order-mark"])
@pytest.mark.parametrize("name", FORMS)
def test_line_ends_and_byte_order_marks(name: str, mark: bytes, end: bytes, tmp_path: Path) -> None:
    header, data = FORMS[name]
    if name.startswith("ply"):
        header += b"end_header\n"
    if name.endswith("ascii"):
        data = data.replace(b"\n", end)
    assert_same(read(tmp_path, mark + header.replace(b"\n", end) + data))


def test_binary_data_may_begin_like_a_line_end(tmp_path: Path) -> None:
    points = POINTS.copy()
    points[0, 0] = np.frombuffer(b"\n\r\n\x3d", "<f4")[0]
    for end in (b"\n", b"\r\n", b"\r"):
        content = pcd_header(ROWS, "binary").replace(b"\n", end) + pcd_data(table(XYZ, points), "binary")
        assert_same(read(tmp_path, content), points)


@pytest.mark.parametrize("row", [b"0.5\r0.125 0.25", b"0.5 0.125 0.25\r", b"\r0.5 0.125 0.25"])
@pytest.mark.parametrize("write", [pcd, ply], ids=["pcd", "ply"])
def test_a_stray_carriage_return_is_white_space(write: Any, row: bytes, tmp_path: Path) -> None:
    lines = write(ROWS, "ascii").splitlines()
    lines[-1] = row
    assert_same(read(tmp_path, b"\n".join(lines)), np.vstack([POINTS[:-1], [0.5, 0.125, 0.25]]))


def test_utf_16_is_named(tmp_path: Path) -> None:
    path = tmp_path / "cloud.pcd"
    path.write_bytes(pcd(ROWS, "ascii").decode().encode("utf-16"))
    assert "UTF-16" in refusal(path)


# PLY with lists


def with_lists(form: str, lengths: Sequence[int], *, before: bool) -> bytes:
    """A PLY file with lists of such lengths within its vertices, or in an element before them."""
    order = ">" if "big" in form else "<"
    text = form == "ascii"

    def packed(values: Sequence[int]) -> bytes:
        if text:
            return (" ".join(map(str, (len(values), *values))) + " ").encode()
        return struct.pack(f"{order}H{len(values)}h", len(values), *values)

    lists = [packed(range(length)) for length in lengths]
    rows = [
        text_rows(ROWS[k : k + 1], " ") if text else np.array(POINTS[k]).astype(order + "f4").tobytes()
        for k in range(N)
    ]
    end = b"\n" if text else b""
    header = f"ply\nformat {form} 1.0\n"
    axes = "property float x\nproperty float y\n"
    if before:
        header += (
            f"element view {len(lists)}\nproperty list ushort short i\nelement vertex {N}\n{axes}property float z\n"
        )
        data = b"".join(each + end for each in lists) + b"".join(row + end for row in rows)
    else:
        header += f"element vertex {N}\nproperty list ushort short i\n{axes}property float z\n"
        data = b"".join(lists[k % len(lists)] + row + end for k, row in enumerate(rows))
    return (header + "end_header\n").encode() + data


LENGTHS = {"none": [0], "alike": [3, 3, 3], "first-differs": [1, 2, 2], "last-differs": [2, 2, 7], "all": range(9)}


@pytest.mark.parametrize("before", [True, False], ids=["before", "within"])
@pytest.mark.parametrize("lengths", LENGTHS.values(), ids=LENGTHS)
@pytest.mark.parametrize("form", PLY_FORMATS)
def test_ply_lists_before_and_within_the_vertices(
    form: str, lengths: Sequence[int], before: bool, tmp_path: Path
) -> None:
    assert_same(read(tmp_path, with_lists(form, lengths, before=before)))


@pytest.mark.parametrize("cut", [1, 9, 30, 500])
@pytest.mark.parametrize("lengths", [[3, 3], [1, 2]], ids=["alike", "all"])
@pytest.mark.parametrize("form", PLY_FORMATS[1:])
def test_ply_lists_that_are_cut_off(form: str, lengths: Sequence[int], cut: int, tmp_path: Path) -> None:
    path = tmp_path / "broken"
    path.write_bytes(with_lists(form, lengths, before=False)[:-cut])
    assert "truncated" in refusal(path)


LISTED = with_lists(PLY_FORMATS[1], [3, 3], before=False)
VARIED = with_lists(PLY_FORMATS[1], [1, 2], before=False)
NEGATIVE = LISTED.replace(b"list ushort short", b"list short short").replace(b"\x03\0\0\0\x01\0\x02\0", b"\xff\xff" * 4)


CLAIMS: dict[str, tuple[bytes, str]] = {
    "alike": (LISTED.replace(b"vertex 208", b"vertex 1000000000000"), "truncated"),
    "varied": (VARIED.replace(b"vertex 208", b"vertex 1000000000000"), "truncated"),
    "long-list": (LISTED.replace(b"list ushort", b"list uint"), "truncated"),
    "negative": (NEGATIVE, "malformed"),
    "count-of-float": (LISTED.replace(b"list ushort", b"list float"), "malformed"),
    "nothing-in-it": (
        ply(ROWS, PLY_FORMATS[1]).replace(b"element vertex", b"element empty 1000000000000\nelement vertex"),
        "",
    ),
}


@pytest.mark.parametrize(("content", "word"), CLAIMS.values(), ids=CLAIMS)
def test_what_a_ply_claims_takes_no_memory(content: bytes, word: str, tmp_path: Path) -> None:
    path = tmp_path / "broken"
    path.write_bytes(content)
    list(read_clouds(SAMPLES / "pan.pcd"))  # what is imported is not counted
    tracemalloc.start()
    try:
        if word:
            assert word in refusal(path)
        else:
            assert_same(next(read_clouds(path)))
        assert tracemalloc.get_traced_memory()[1] < 2_000_000
    finally:
        tracemalloc.stop()


# PLY's camera, as PCL writes it


def with_camera(form: str, place: Sequence[float], image: tuple[int, int] | None = None) -> bytes:
    """A PLY file with the camera element behind the vertices."""
    order = ">" if "big" in form else "<"
    names = ["view_px", "view_py", "view_pz", "focal"]
    values: list[float] = [*place, 1.0]
    header = "element camera 1\n" + "".join(f"property float {name}\n" for name in names)
    data = " ".join(map(repr, values)).encode() if form == "ascii" else struct.pack(f"{order}4f", *values)
    if image:
        header += "property int viewportx\nproperty int viewporty\n"
        data += f" {image[0]} {image[1]}".encode() if form == "ascii" else struct.pack(f"{order}2i", *image)
    return ply(ROWS, form).replace(b"end_header", header.encode() + b"end_header") + data


@pytest.mark.parametrize("form", PLY_FORMATS)
def test_ply_camera_is_the_sensors_place(form: str, tmp_path: Path) -> None:
    cloud = read(tmp_path, with_camera(form, [0.5, -1.0, 2.25]), scale=2.0)
    assert cloud.viewpoint == pytest.approx([1.0, -2.0, 4.5])
    assert cloud.pixels is None
    unset = read(tmp_path, with_camera(form, [0.0, 0.0, 0.0], (16, 13)))
    assert unset.viewpoint is None
    assert unset.pixels is not None
    assert unset.pixels.shape == (13, 16)
    assert read(tmp_path, with_camera(form, [0.0, 0.0, 0.0], (N, 1))).pixels is None
    assert read(tmp_path, with_camera(form, [np.nan, 0.0, 0.0], (7, 7))).viewpoint is None


# Folders, devices and pipes


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with two clouds."""
    place = tmp_path / "clouds"
    place.mkdir()
    for name in ("a.pcd", "b.pcd"):
        (place / name).write_bytes(pcd(ROWS))
    return place


def test_a_folder_of_clouds_says_how_to_plan_them(folder: Path, run: Run) -> None:
    ended = run("plan", folder)
    assert ended.code == 3
    assert f"{folder}/*.pcd" in ended.err
    assert f"flatgrasp batch {folder}" in ended.err
    assert len(ended.err.splitlines()) == 1


def test_a_folder_with_a_recording_among_clouds_is_not_that_recording(folder: Path, run: Run) -> None:
    recording = next((SAMPLES / "pan_ros2").glob("*.mcap"))
    (folder / "pan.mcap").write_bytes(recording.read_bytes())
    ended = run("plan", folder)
    assert ended.code == 3
    assert "2 clouds, 1 recordings" in ended.err


def test_a_folder_of_recordings_alone_is_a_recording(tmp_path: Path) -> None:
    recording = next((SAMPLES / "pan_ros2").glob("*.mcap"))
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "bag_0.mcap").write_bytes(recording.read_bytes())
    (tmp_path / "bag" / "notes.txt").write_text("a test's")
    assert len(next(read_clouds(tmp_path / "bag")).points) > 1000


def test_an_empty_folder_is_an_error(tmp_path: Path) -> None:
    assert "without recordings" in refusal(tmp_path)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="needs a device that is no file")
@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null"])
def test_a_device_is_no_source(device: str) -> None:
    assert "device" in refusal(Path(device))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_a_pipe_is_read_to_its_end_but_not_for_ever(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)

    def write(content: bytes) -> None:
        with suppress(BrokenPipeError):  # the reader has seen enough
            path.write_bytes(content)

    for content, most in ((pcd(ROWS), 2**20), (bytes(5_000_000), 2**20)):
        monkeypatch.setattr("flatgrasp_cli.sources.open.MOST_SPOOLED", most)
        writer = threading.Thread(target=write, args=(content,))
        writer.start()
        if len(content) < most:
            assert_same(next(read_clouds(path)))
        else:
            with pytest.raises(SourceError, match="does not end"):
                next(read_clouds(path))
        writer.join()
