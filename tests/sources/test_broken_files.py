"""PCD and PLY files that are broken: each is an error that names it and says why."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from tests.sources.pcd_ply import PCD_DATA, PLY_FORMATS, XYZ, pcd, pcd_header, ply, refusal, table

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
