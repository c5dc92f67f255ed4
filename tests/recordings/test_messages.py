"""PointCloud2 and PointCloud become the points that were recorded, and broken ones an error that says how."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.recordings.messages import (
    CLOUD_TYPES,
    MessageError,
)
from flatgrasp_cli.recordings.messages.packed import BLOCK
from flatgrasp_cli.recordings.messages.pointcloud2 import decode_pointcloud, decode_pointcloud2
from tests.recordings.clouds import FINITE, HEADER, INF, NAN, PIXEL, POINTS, XYZ, cloud2, record
from tests.recordings.depth_images import patched

RECORDINGS = Path(__file__).resolve().parents[3] / "shared" / "data" / "recordings"


@pytest.mark.parametrize(
    ("fields", "step"),
    [
        (XYZ, 12),
        (XYZ, 16),
        (XYZ, 32),
        ({"z": (0, "f4"), "y": (4, "f4"), "x": (8, "f4")}, 16),
        ({"x": (8, "f4"), "y": (12, "f4"), "z": (16, "f4")}, 20),
        ({"x": (1, "f4"), "y": (5, "f4"), "z": (9, "f4")}, 17),
        ({"x": (3, "f8"), "y": (11, "f4"), "z": (20, "f8")}, 31),
        ({"x": (0, "f8"), "y": (8, "f8"), "z": (16, "f8")}, 24),
    ],
)
@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("padding", [0, 5])
def test_layouts(fields: dict[str, tuple[int, str]], step: int, big: bool, padding: int) -> None:
    decoded = decode_pointcloud2(cloud2(POINTS, fields, step, (3, 2), padding, big=big))
    np.testing.assert_array_equal(decoded.points, FINITE)
    assert decoded.points.dtype == np.float64
    assert (decoded.dropped, decoded.shape) == (2, (3, 2))
    assert (decoded.frame_id, decoded.stamp_ns) == ("camera", 3_000_000_007)
    assert decoded.colors is None


@st.composite
def layouts(draw: st.DrawFn) -> tuple[dict[str, tuple[int, str]], int]:
    """x, y, z and rgb in any order, of any type, with gaps."""
    fields, end = {}, 0
    for name in draw(st.permutations(["x", "y", "z", "rgb"])):
        offset = end + draw(st.integers(0, 9))
        kind = draw(st.sampled_from(["f4", "f8"])) if name != "rgb" else "u4"
        fields[name] = (offset, kind)
        end = offset + np.dtype(kind).itemsize
    return fields, end + draw(st.integers(0, 20))


@given(layouts(), st.booleans(), st.sampled_from([(1, 6), (6, 1), (2, 3)]), st.integers(0, 40))
def test_any_legal_layout_holds_the_same_points(
    layout: tuple[dict[str, tuple[int, str]], int], big: bool, rows: tuple[int, int], padding: int
) -> None:
    fields, step = layout
    rgb = PIXEL + np.arange(len(POINTS))
    decoded = decode_pointcloud2(
        cloud2(POINTS, fields, step, rows, padding, big=big, columns={"rgb": rgb}), colors=True
    )
    np.testing.assert_array_equal(decoded.points, FINITE)
    np.testing.assert_array_equal(decoded.colors, [[171, 205, 239 + i] for i in range(4)])


def test_integer_coordinates() -> None:
    fields = {"x": (0, "i2"), "y": (2, "i1"), "z": (4, "u4")}
    points = np.array([[-300.0, -5, 70_000], [300, 5, 0]])
    np.testing.assert_array_equal(decode_pointcloud2(cloud2(points, fields, 8)).points, points)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("value", [NAN, INF, -INF])
def test_one_bad_coordinate_drops_the_point_and_its_colour_in_every_block(axis: int, value: float) -> None:
    n = 2 * BLOCK + 100
    rows = np.zeros((n, 8), np.float32)
    rows[:, :3] = np.arange(3 * n).reshape(n, 3)
    colors = np.arange(n, dtype=np.uint32) % 250
    rows.view(np.uint32)[:, 4] = colors
    bad = [5, BLOCK, n - 1]
    rows[bad, axis] = value
    message = cloud2(np.zeros((0, 3)), {**XYZ, "rgb": (16, "f4")}, 32)
    message.width, message.row_step, message.data = n, 32 * n, rows.view(np.uint8).reshape(-1)
    decoded = decode_pointcloud2(message, colors=True)
    good = np.delete(np.arange(n), bad)
    np.testing.assert_array_equal(decoded.points, rows[good, :3].astype(float))
    assert decoded.dropped == 3
    assert decoded.colors is not None
    np.testing.assert_array_equal(decoded.colors[:, 2], colors[good])


def test_numbers_near_the_largest_are_finite() -> None:
    points = np.full((2, 3), np.finfo(np.float32).max, dtype=float)
    np.testing.assert_array_equal(decode_pointcloud2(cloud2(points, XYZ, 32)).points, points)


@pytest.mark.parametrize("name", ["rgb", "rgba"])
@pytest.mark.parametrize("kind", ["f4", "u4"])
@pytest.mark.parametrize("big", [False, True])
def test_packed_colours(name: str, kind: str, big: bool) -> None:
    packed = np.full(6, PIXEL, np.uint32).view(kind)
    message = cloud2(POINTS, {**XYZ, name: (12, kind)}, 16, big=big, columns={name: packed})
    decoded = decode_pointcloud2(message, colors=True)
    np.testing.assert_array_equal(decoded.colors, [[171, 205, 239]] * 4)
    assert decode_pointcloud2(message).colors is None


def test_separate_colours() -> None:
    fields = {**XYZ, "b": (12, "u1"), "g": (13, "u1"), "r": (14, "u1")}
    columns = {"r": range(6), "g": range(10, 16), "b": range(20, 26)}
    decoded = decode_pointcloud2(cloud2(POINTS, fields, 15, columns=columns), colors=True)
    np.testing.assert_array_equal(decoded.colors, [[i, 10 + i, 20 + i] for i in range(4)])


def test_bytes_will_do_and_so_does_an_empty_cloud() -> None:
    message = cloud2(POINTS, XYZ, 16)
    message.data = message.data.tobytes()
    np.testing.assert_array_equal(decode_pointcloud2(message).points, FINITE)
    message.width, message.data = 0, b""
    assert decode_pointcloud2(message).points.shape == (0, 3)


def test_the_last_rows_padding_may_be_missing_and_one_rows_step_unset() -> None:
    message = cloud2(POINTS, XYZ, 16, (3, 2), padding=8)
    message.data = message.data[:-8]
    np.testing.assert_array_equal(decode_pointcloud2(message).points, FINITE)
    message = cloud2(POINTS, XYZ, 16)
    message.row_step = 0
    decoded = decode_pointcloud2(message)
    np.testing.assert_array_equal(decoded.points, FINITE)
    assert decoded.assumptions == ()


@pytest.mark.parametrize("row_step", [0, 2, 3 * 2, 96, 2**31])
def test_a_wrong_row_step_is_ignored_if_the_data_is_exact(row_step: int) -> None:
    message = patched(cloud2(POINTS, XYZ, 16, (3, 2)), row_step=row_step)
    decoded = decode_pointcloud2(message)
    np.testing.assert_array_equal(decoded.points, FINITE)
    assert [item.code for item in decoded.assumptions] == ["row_step_ignored"]
    with pytest.raises(MessageError):
        decode_pointcloud2(patched(message, data=message.data[:-1]))


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"data": bytes(1200), "height": 480, "width": 640, "row_step": 10240},
         "data has 1200 bytes, 640 × 480 points of 16 bytes need 4915200"),
        ({"height": 2**32 - 1, "width": 2**32 - 1, "row_step": 2**36}, "data has 96 bytes, 4294967295 × "),
        ({"point_step": 0}, "point_step is 0"),
        ({"point_step": 8, "row_step": 48}, "field z takes 4 bytes at offset 8, but a point has 8 bytes"),
        ({"height": 2, "width": 2, "row_step": 31}, "row_step is 31, but 2 points of 16 bytes need 32"),
        ({"fields": []}, "has no field x or y or z of a known type; its fields: none"),
        ({"fields": [record(name="x", offset=0, datatype=9)]}, "has no field x or y or z"),
        ({"fields": [record(name=n, offset=-4, datatype=7) for n in "xyz"]}, "at offset -4"),
        ({"data": None}, "is no PointCloud2"),
        ({"width": "wide"}, "is no PointCloud2"),
        ({"header": record(stamp=record(sec=2**64, nanosec=0), frame_id="")}, "18446744073709551616 s, is none"),
        ({"header": record()}, "is no PointCloud2: it has no field 'stamp'"),
        ({"height": -1, "width": -6}, "declares -6 × -1 points"),
    ],
)  # fmt: skip
def test_broken_clouds_say_how(changes: dict[str, Any], text: str) -> None:
    message = cloud2(POINTS, XYZ, 16)
    message.__dict__.update(changes)
    with pytest.raises(MessageError) as caught:
        decode_pointcloud2(message)
    assert text in str(caught.value)


def test_pointcloud_of_ros_1() -> None:
    points = [record(x=x, y=y, z=z) for x, y, z in POINTS]
    channel = record(name="rgb", values=np.full(6, PIXEL, np.uint32).view(np.float32))
    message = record(header=HEADER, points=points, channels=[channel])
    decoded = decode_pointcloud(message, colors=True)
    np.testing.assert_array_equal(decoded.points, FINITE)
    np.testing.assert_array_equal(decoded.colors, [[171, 205, 239]] * 4)
    assert decoded.dropped == 2
    channel.values = channel.values[1:]
    with pytest.raises(MessageError, match="channel rgb has 5 values for 6 points"):
        decode_pointcloud(message, colors=True)
    empty = decode_pointcloud(record(header=HEADER, points=[], channels=[]))
    assert empty.points.shape == (0, 3)


@pytest.mark.skipif(not (RECORDINGS / "kinect_table.bag").exists(), reason="the recording is not here")
def test_a_kinects_cloud() -> None:
    from rosbags.highlevel import AnyReader

    with AnyReader([RECORDINGS / "kinect_table.bag"]) as reader:
        connection, _, data = next(iter(reader.messages()))
        message: Any = reader.deserialize(data, connection.msgtype)
    decoded = CLOUD_TYPES[connection.msgtype](message, colors=True)
    table = np.frombuffer(message.data.tobytes(), np.dtype({"names": ["xyz", "bgra"], "formats": ["3<f4", "4u1"],
                                                            "offsets": [0, 16], "itemsize": 32}))  # fmt: skip
    finite = np.isfinite(table["xyz"]).all(axis=1)
    np.testing.assert_array_equal(decoded.points, table["xyz"][finite].astype(float))
    np.testing.assert_array_equal(decoded.colors, table["bgra"][finite][:, [2, 1, 0]])
    assert decoded.shape == (480, 640)
    assert decoded.frame_id == "camera_rgb_optical_frame"
    assert 0.2 < decoded.dropped / (480 * 640) < 0.3
