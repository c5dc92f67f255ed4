"""Recorded messages become the points that were recorded, and broken ones an error that says how."""

from __future__ import annotations

import base64
import struct
import zlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.recordings.messages import (
    CLOUD_TYPES,
    CameraInfo,
    DepthCameras,
    MessageError,
    MissingCameraInfo,
    info_topics_for,
    is_depth,
    is_lossy_depth,
)
from flatgrasp_cli.recordings.messages.foxglove import decode_foxglove
from flatgrasp_cli.recordings.messages.packed import BLOCK
from flatgrasp_cli.recordings.messages.pointcloud2 import decode_pointcloud, decode_pointcloud2
from tests.recordings.test_rvl import encode_rvl

RECORDINGS = Path(__file__).resolve().parents[3] / "shared" / "data" / "recordings"
ROS_TYPES = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}
FOXGLOVE_TYPES = {"u1": 1, "i1": 2, "u2": 3, "i2": 4, "u4": 5, "i4": 6, "f4": 7, "f8": 8}
NAN, INF = np.nan, np.inf
record = SimpleNamespace

POINTS = np.array([[1, 2, 3], [-4, 5, 0.5], [0, 0, 0], [7, -8, 9], [NAN, NAN, NAN], [1, INF, 2]], dtype=float)
FINITE = POINTS[:4]
PIXEL = 0x00_AB_CD_EF  # as R G B: 171 205 239
HEADER = record(stamp=record(sec=3, nanosec=7), frame_id="/camera")


def cloud2(
    points: FloatArray,
    fields: dict[str, tuple[int, str]],
    step: int,
    rows: tuple[int, int] | None = None,
    padding: int = 0,
    *,
    big: bool = False,
    columns: dict[str, Any] | None = None,
) -> Any:
    """A PointCloud2 written field by field, struct by struct: slow and plain."""
    height, width = rows or (1, len(points))
    row_step = width * step + padding
    data = bytearray(b"\xff" * (height * row_step))
    values = {**dict(zip("xyz", points.T, strict=True)), **(columns or {})}
    for i in range(len(points)):
        begin = (i // width) * row_step + (i % width) * step
        for name, (offset, kind) in fields.items():
            item = np.array([values[name][i]]).astype(np.dtype(kind).newbyteorder(">" if big else "<"))
            data[begin + offset : begin + offset + item.itemsize] = item.tobytes()
    return record(
        header=HEADER,
        height=height,
        width=width,
        fields=[record(name=n, offset=o, datatype=ROS_TYPES[k], count=1) for n, (o, k) in fields.items()],
        is_bigendian=big,
        point_step=step,
        row_step=row_step,
        data=np.frombuffer(bytes(data), np.uint8),
        is_dense=False,
    )


XYZ = {"x": (0, "f4"), "y": (4, "f4"), "z": (8, "f4")}


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


def foxglove(points: FloatArray = POINTS, **changes: Any) -> Any:
    fields = {"x": "f8", "y": "f4", "z": "f4", "red": "u1", "green": "u1", "blue": "u1", "alpha": "u1"}
    table = np.zeros(len(points), np.dtype(list(fields.items())))
    for axis, column in zip("xyz", points.T, strict=True):
        table[axis] = column
    table["red"], table["green"], table["blue"] = 1, 2, 3
    assert table.dtype.fields is not None
    message = record(
        timestamp=record(seconds=3, nanos=7),
        frame_id="map",
        pose=record(position=record(x=0, y=0, z=0), orientation=record(x=0, y=0, z=0, w=0)),
        point_stride=table.dtype.itemsize,
        fields=[
            record(name=name, offset=table.dtype.fields[name][1], type=FOXGLOVE_TYPES[kind])
            for name, kind in fields.items()
        ],
        data=table.tobytes(),
    )
    message.__dict__.update(changes)
    return message


def test_foxglove_protobuf_and_json() -> None:
    plain = foxglove()
    in_json = foxglove(data=base64.b64encode(plain.data).decode(), timestamp=record(sec=3, nsec=7))
    del in_json.pose
    for message in (plain, in_json):
        decoded = decode_foxglove(message, colors=True)
        np.testing.assert_array_equal(decoded.points, FINITE)
        np.testing.assert_array_equal(decoded.colors, [[1, 2, 3]] * 4)
        assert decoded.viewpoint is None
        assert (decoded.dropped, decoded.stamp_ns, decoded.frame_id) == (2, 3_000_000_007, "map")


def test_foxglove_pose_is_applied() -> None:
    turned = record(position=record(x=10, y=0, z=0), orientation=record(x=0, y=0, z=2, w=2))
    decoded = decode_foxglove(foxglove(pose=turned))
    np.testing.assert_allclose(decoded.points[0], [10 - 2, 1, 3], atol=1e-12)  # a quarter turn: (1, 2) → (−2, 1)
    assert decoded.viewpoint == pytest.approx([10, 0, 0])


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"data": "no base64!"}, "data is not base64"),
        ({"data": bytes(21)}, "data has 21 bytes, which is no whole number of points of 20 bytes"),
        ({"point_stride": 0}, "point_stride is 0"),
        ({"fields": [record(name="x", offset=0, type=7)]}, "has no field y or z"),
        ({"pose": record(position=record(x=NAN, y=0, z=0), orientation=None)}, "its pose is not finite"),
    ],
)
def test_broken_foxglove_says_how(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(MessageError, match=text):
        decode_foxglove(foxglove(**changes))


def test_every_cloud_type_has_its_decoder() -> None:
    assert CLOUD_TYPES["sensor_msgs/msg/PointCloud2"] is decode_pointcloud2
    assert CLOUD_TYPES["foxglove.PointCloud"] is CLOUD_TYPES["foxglove_msgs/msg/PointCloud"] is decode_foxglove


# depth images

WIDTH, HEIGHT, F, CX, CY = 8, 6, 10.0, 3.5, 2.5
NO_ROI = {"x_offset": 0, "y_offset": 0, "width": 0, "height": 0, "do_rectify": False}
IMAGE, INFO = "/camera/depth/image_raw", "/camera/depth/camera_info"
DEPTH_MM = (1000 + 10 * np.arange(WIDTH * HEIGHT)).reshape(HEIGHT, WIDTH)


def info(**changes: Any) -> Any:
    message = record(
        header=record(stamp=record(sec=3, nanosec=0), frame_id="camera"),
        width=WIDTH,
        height=HEIGHT,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=np.array([F, 0, CX, 0, F, CY, 0, 0, 1]),
        r=np.eye(3).ravel(),
        p=np.array([F, 0, CX, 0, 0, F, CY, 0, 0, 0, 1, 0]),
        binning_x=0,
        binning_y=0,
        roi=record(**NO_ROI),
    )
    message.__dict__.update(changes)
    return message


def image(raw: Any = DEPTH_MM, encoding: str = "16UC1", big: bool = False, padding: int = 0) -> Any:
    kind = np.dtype("f4" if encoding == "32FC1" else "u2").newbyteorder(">" if big else "<")
    rows = [row.astype(kind).tobytes() + b"\xff" * padding for row in np.asarray(raw)]
    height, width = np.shape(raw)
    return record(
        header=HEADER, height=height, width=width, encoding=encoding, is_bigendian=big,
        step=width * kind.itemsize + padding, data=np.frombuffer(b"".join(rows), np.uint8),
    )  # fmt: skip


def compressed(raw: Any, form: str = "16UC1; compressedDepth png", a: float = 0, b: float = 0) -> Any:
    png = cv2.imencode(".png", np.asarray(raw, np.uint16))[1].tobytes()
    return record(header=HEADER, format=form, data=struct.pack("<iff", 0, a, b) + png)


def decode(message: Any, calibration: Any = None, topic: str = IMAGE) -> Any:
    cameras = DepthCameras()
    cameras.add_info(INFO, calibration or info())
    return cameras.decode(topic, message)


def expected(depth_mm: Any = DEPTH_MM) -> FloatArray:
    """The pinhole equation, pixel by pixel."""
    return np.array(
        [
            [(u - CX) / F * z / 1000, (v - CY) / F * z / 1000, z / 1000]
            for v, row in enumerate(depth_mm)
            for u, z in enumerate(row)
            if z > 0
        ]
    )


@pytest.mark.parametrize("encoding", ["16UC1", "mono16", "32FC1"])
@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("padding", [0, 3])
def test_depth_images(encoding: str, big: bool, padding: int) -> None:
    raw = DEPTH_MM / 1000 if encoding == "32FC1" else DEPTH_MM
    decoded = decode(image(raw, encoding, big, padding))
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-6)
    assert (decoded.dropped, decoded.shape, decoded.frame_id) == (0, (HEIGHT, WIDTH), "camera")


def test_no_depth_is_dropped() -> None:
    raw = DEPTH_MM / 1000
    raw[0, :4] = [0, NAN, INF, -1]
    decoded = decode(image(raw, "32FC1"))
    np.testing.assert_allclose(decoded.points, expected()[4:], rtol=1e-6)
    assert decoded.dropped == 4


def test_compressed_millimetres() -> None:
    depth = DEPTH_MM.copy()
    depth[2, 3] = 0
    for form in ("16UC1; compressedDepth png", "16UC1; compressedDepth"):
        decoded = decode(compressed(depth, form), topic=IMAGE + "/compressedDepth")
        np.testing.assert_allclose(decoded.points, expected(depth), rtol=1e-12)
        assert decoded.dropped == 1


def test_compressed_inverse_depth() -> None:
    raw = np.full((HEIGHT, WIDTH), 1100)
    raw[0, :3] = [0, 100, 600]  # no data, infinitely far, 2 m
    decoded = decode(compressed(raw, "32FC1; compressedDepth png", a=1000.0, b=100.0))
    np.testing.assert_allclose(decoded.points[:2, 2], [2.0, 1.0], rtol=1e-12)
    assert decoded.dropped == 2


@pytest.mark.parametrize(("encoding", "quantisation"), [("16UC1", (0.0, 0.0)), ("32FC1", (1000.0, 100.0))])
def test_compressed_as_rvl(encoding: str, quantisation: tuple[float, float]) -> None:
    raw = np.full((HEIGHT, WIDTH), 1100)
    raw[0, :2] = 0
    data = struct.pack("<iff", 0, *quantisation) + encode_rvl(raw)
    decoded = decode(record(header=HEADER, format=f"{encoding}; compressedDepth rvl", data=data))
    assert decoded.dropped == 2
    np.testing.assert_allclose(decoded.points[:, 2], 1.1 if encoding == "16UC1" else 1.0, rtol=1e-12)


def test_jpeg_is_refused_with_the_reason() -> None:
    jpeg = record(header=HEADER, format="16UC1; jpeg compressed mono8", data=b"\xff\xd8" + bytes(50))
    assert not is_depth(jpeg)
    assert is_lossy_depth(jpeg)
    with pytest.raises(MessageError, match=r"^is JPEG, which destroys depth: record the image raw"):
        decode(jpeg)
    with pytest.raises(MessageError, match="is no PNG but JPEG, which destroys depth"):
        decode(record(header=HEADER, format="16UC1; png compressed", data=jpeg.data))


def test_which_images_are_depth() -> None:
    assert is_depth(image())
    assert is_depth(image(encoding="32FC1"))
    assert is_depth(record(format="32FC1; compressedDepth png"))
    for colour in (
        record(encoding="rgb8"),
        record(format="rgb8; jpeg compressed bgr8"),
        record(format="jpeg"),
        record(),
    ):
        assert not is_depth(colour)


def patched(message: Any, **changes: Any) -> Any:
    message.__dict__.update(changes)
    return message


def bomb() -> Any:
    message = compressed(DEPTH_MM)
    data = bytearray(message.data)
    data[12 + 16 : 12 + 24] = struct.pack(">II", 60_000, 60_000)
    return patched(message, data=bytes(data))


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (patched(image(), data=bytes(10)), "data has 10 bytes, 8 × 6 pixels in rows of 16 bytes need 96"),
        (patched(image(padding=1), step=15), "step is 15, but 8 pixels of 2 bytes need 16"),
        (patched(image(), encoding="rgb8"), "has encoding 'rgb8', which is no depth"),
        (patched(compressed(DEPTH_MM), format="jpeg"), "has format 'jpeg', which is no depth"),
        (patched(compressed(DEPTH_MM), data=bytes(4)), "data has 4 bytes, less than the header"),
        (patched(compressed(DEPTH_MM), data=bytes(100)), "is no PNG"),
        (patched(compressed(DEPTH_MM), data=compressed(DEPTH_MM).data[:-20]), "the PNG is cut off"),
        (bomb(), "cannot hold 60000 × 60000 pixels"),
        (record(header=HEADER), "is no image: it has no field"),
    ],
)
def test_broken_images_say_how(message: Any, text: str) -> None:
    with pytest.raises(MessageError, match=text):
        decode(message)


@pytest.mark.parametrize("chunk", [b"IHDR", b"IDAT", b"IEND"])
def test_an_altered_png_is_an_error(chunk: bytes) -> None:
    message = compressed(DEPTH_MM)
    data = bytearray(message.data)
    data[bytes(data).index(chunk) + (16 if chunk == b"IHDR" else 4)] ^= 1
    with pytest.raises(MessageError, match=r"a checksum does not match"):
        decode(patched(message, data=bytes(data)))


def test_a_png_with_a_wrong_inside_is_an_error() -> None:
    message = compressed(DEPTH_MM)
    data = bytearray(message.data)
    begin = bytes(data).index(b"IDAT")
    (size,) = struct.unpack_from(">I", data, begin - 4)
    data[begin + 6 : begin + 10] = bytes(4)
    struct.pack_into(">I", data, begin + 4 + size, zlib.crc32(data[begin : begin + 4 + size]))
    with pytest.raises(MessageError, match=r"the PNG is broken$"):
        decode(patched(message, data=bytes(data)))


# cameras


def test_ros_1_names_and_rectified_images() -> None:
    old = info(d=np.full(5, 0.1), p=np.array([2 * F, 0, CX, 0, 0, 2 * F, CY, 0, 0, 0, 1, 0]))
    for name in "kdrp":
        setattr(old, name.upper(), old.__dict__.pop(name))
    decoded = decode(image(), old, "/camera/depth/image_rect_raw")
    np.testing.assert_allclose(decoded.points[:, :2], expected()[:, :2] / 2, rtol=1e-12)


def test_binning_and_region_of_interest() -> None:
    """Pixel (1, 2) of a 2 × binned region that starts at (4, 6) is sensor pixel (6, 10)."""
    region = record(**{**NO_ROI, "x_offset": 4, "y_offset": 6, "width": 16, "height": 12})
    binned = info(width=64, height=48, binning_x=2, binning_y=2, roi=region)
    point = decode(image(), binned).points[2 * WIDTH + 1]
    z = DEPTH_MM[2, 1] / 1000
    np.testing.assert_allclose(point, [(6 - CX) / F * z, (10 - CY) / F * z, z], rtol=1e-12)


@pytest.mark.parametrize(
    ("model", "d"),
    [
        ("plumb_bob", [0.1, -0.05, 0.001, -0.002, 0.01]),
        ("rational_polynomial", [0.1, -0.05, 0.001, -0.002, 0.01, 0.02, 0.003, 0.001]),
        ("equidistant", [0.01, -0.02, 0.003, -0.001]),
        ("equidistant", [0, 0, 0, 0]),
    ],
)
def test_distortion_is_undone(model: str, d: list[float]) -> None:
    points = decode(image(), info(distortion_model=model, d=np.array(d))).points
    rays, k = points / points[:, 2:], np.array([[F, 0, CX], [0, F, CY], [0, 0, 1]])
    x, y = rays[:, :2].T
    r = np.hypot(x, y)
    if model == "equidistant":
        theta = np.arctan(r)
        bent = theta * (1 + sum(c * theta ** (2 * i + 2) for i, c in enumerate(d)))
        x, y = x * bent / r, y * bent / r
    else:
        k1, k2, p1, p2, k3, k4, k5, k6 = (*d, 0, 0, 0)[:8]
        radial = (1 + k1 * r**2 + k2 * r**4 + k3 * r**6) / (1 + k4 * r**2 + k5 * r**4 + k6 * r**6)
        x, y = (
            x * radial + 2 * p1 * x * y + p2 * (r**2 + 2 * x**2),
            y * radial + p1 * (r**2 + 2 * y**2) + 2 * p2 * x * y,
        )
    u, v, _ = k @ np.array([x, y, np.ones_like(x)])
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    np.testing.assert_allclose(u, columns.ravel(), atol=1e-6)
    np.testing.assert_allclose(v, rows.ravel(), atol=1e-6)


def test_pixels_whose_distortion_has_no_inverse_are_dropped() -> None:
    decoded = decode(image(), info(d=np.array([-5.0, 0, 0, 0, 0])))
    assert 0 < len(decoded.points) < WIDTH * HEIGHT
    assert len(decoded.points) + decoded.dropped == WIDTH * HEIGHT
    assert np.isfinite(decoded.points).all()


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"k": np.zeros(9), "p": np.zeros(12)}, "not calibrated; give --intrinsics fx,fy,cx,cy"),
        (
            {"width": 16, "height": 12},
            "its CameraInfo is for 16 × 12, 2 times as large, and names no binning",
        ),
        ({"width": 9}, "the image is 8 × 6, but its CameraInfo is for 9 × 6; .* --intrinsics$"),
        ({"distortion_model": "magic", "d": np.ones(5)}, "distortion model 'magic'"),
        (
            {"distortion_model": "Inverse Brown Conrady", "d": np.full(5, 0.1)},
            "'inverse brown conrady' .* --intrinsics",
        ),
        ({"distortion_model": "Ftheta"}, "distortion model 'ftheta'"),
        ({"d": np.ones(3)}, "plumb_bob takes 4 or 5 numbers"),
    ],
)
def test_cameras_that_do_not_fit_say_how(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(MessageError, match=text):
        decode(image(), info(**changes))


def test_infos_are_found_beside_the_image_or_by_frame_and_size() -> None:
    cameras = DepthCameras()
    with pytest.raises(MissingCameraInfo, match=f"no CameraInfo for {IMAGE}: expected on {INFO}"):
        cameras.decode(IMAGE, image())
    cameras.add_info("/other/camera_info", info(width=9))
    with pytest.raises(MissingCameraInfo, match="CameraInfos seen so far: /other/camera_info"):
        cameras.decode(IMAGE, image())
    cameras.add_info("/elsewhere/camera_info", info())
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, expected(), rtol=1e-12)


def test_the_info_nearest_in_time_counts() -> None:
    cameras = DepthCameras()
    for second, focal in ((3, F), (9, 2 * F)):
        late = info(k=np.array([focal, 0, CX, 0, focal, CY, 0, 0, 1]))
        late.header = record(stamp=record(sec=second, nanosec=0), frame_id="camera")
        cameras.add_info(INFO, late)
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, expected(), rtol=1e-12)


def test_topics_of_infos() -> None:
    topics = [INFO, "/camera/rgb/camera_info", "/sim/intrinsics"]
    assert info_topics_for(IMAGE, topics) == (INFO,)
    assert info_topics_for(IMAGE + "/compressedDepth", topics) == (INFO,)
    assert info_topics_for("/depth", topics) == tuple(topics)
    assert info_topics_for("/sim/depth", ["/sim/depth/camera_info"]) == ("/sim/depth/camera_info",)


@pytest.mark.parametrize("step", [0, 8, 500])
def test_a_wrong_step_of_an_image_is_ignored_if_the_data_is_exact(step: int) -> None:
    decoded = decode(patched(image(), step=step))
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-12)
    assert [item.code for item in decoded.assumptions] == ["row_step_ignored"]


@pytest.mark.parametrize(
    ("topic", "rectified"),
    [
        ("/camera/depth/image_raw", False),
        ("/camera/depth_registered/image_raw", False),  # in the raw colour image
        ("/camera/depth/correct", False),
        ("/camera/depth/image_unrectified", False),
        ("/camera/depth/image_rect", True),
        ("/camera/depth/image_rect_raw/compressedDepth", True),
        ("/stereo/depth_rect", True),
        ("/kinect/rect/depth", True),
        ("/camera/rectified_depth/image", True),
        ("/camera/aligned_depth_to_color/image_raw", True),
        ("/zed/zed_node/depth/depth_registered", True),
    ],
)
def test_what_is_rectified_is_not_undistorted(topic: str, rectified: bool) -> None:
    projection = np.array([2 * F, 0, CX, 0, 0, 2 * F, CY, 0, 0, 0, 1, 0])
    cameras = DepthCameras()
    cameras.add_info("/other/camera_info", info(d=np.full(5, 0.1), p=projection))
    points = cameras.decode(topic, image()).points
    halved = expected()[:, :2] / 2
    assert (len(points) == len(halved) and np.allclose(points[:, :2], halved)) == rectified


def test_a_camera_with_a_projection_alone_is_rectified() -> None:
    decoded = decode(image(), info(k=np.zeros(9), d=np.full(5, 0.1)))
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-12)


@pytest.mark.parametrize("model", ["", "None", "Brown Conrady", "Inverse Brown Conrady", "Modified Brown Conrady"])
def test_without_coefficients_the_sdks_models_are_pinholes(model: str) -> None:
    np.testing.assert_allclose(decode(image(), info(distortion_model=model)).points, expected(), rtol=1e-12)


@pytest.mark.parametrize(
    ("theirs", "ours", "d"),
    [
        ("Brown Conrady", "plumb_bob", [0.1, -0.05, 0.001, 0.002, 0.01]),
        ("Kannala Brandt4", "equidistant", [0.1, 0, 0, 0]),
    ],
)
def test_models_that_the_sdk_calls_otherwise(theirs: str, ours: str, d: list[float]) -> None:
    same = decode(image(), info(distortion_model=ours, d=np.array(d))).points
    np.testing.assert_array_equal(decode(image(), info(distortion_model=theirs, d=np.array(d))).points, same)
    fifth = info(distortion_model=theirs, d=np.array([*d, 0.0][:5]))
    np.testing.assert_array_equal(decode(image(), fifth).points, same)


def test_stated_intrinsics_count_before_all_others_and_without_any() -> None:
    stated = CameraInfo.from_message(info(k=np.array([2 * F, 0, CX, 0, 2 * F, CY, 0, 0, 1])))
    cameras = DepthCameras(stated)
    halved = expected() / [2, 2, 1]
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, halved, rtol=1e-12)
    cameras.add_info(INFO, info())
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, halved, rtol=1e-12)


# units


def test_the_unit_that_is_stated_recorded_or_written_after_the_image() -> None:
    cameras = DepthCameras()
    cameras.add_info(INFO, info())
    tenth = record(data=np.float32(1e-4))
    far = patched(image(10 * DEPTH_MM), depth_units=0.0)  # an SDK's image that is no depth says 0
    assert cameras.decode(IMAGE, far).assumed_unit_m == 1e-3
    cameras.add_unit(tenth)
    decoded = cameras.decode(IMAGE, far)
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-6)
    assert decoded.assumed_unit_m is None
    with pytest.raises(MessageError, match="says that a count of depth is nan m"):
        cameras.add_unit(record(data=NAN))
    written = patched(far, depth_units=2e-4)
    np.testing.assert_allclose(cameras.decode(IMAGE, written).points, 2 * expected(), rtol=1e-6)
    stated = DepthCameras(CameraInfo.from_message(info()), 3e-4)
    np.testing.assert_allclose(stated.decode(IMAGE, written).points, 3 * expected(), rtol=1e-6)


def test_an_encoding_that_nobody_confirms_is_an_assumed_unit() -> None:
    assert decode(image()).assumed_unit_m == 1e-3
    assert decode(image(encoding="32FC1")).assumed_unit_m == 1.0


def test_equal_calibrations_are_one_key() -> None:
    assert hash(CameraInfo.from_message(info())) == hash(CameraInfo.from_message(info()))


# a real one


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
