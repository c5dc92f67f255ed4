"""Recordings as RealSense's SDK writes them: numbered frames, the camera beside, units in an option or an image."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import lz4.frame  # type: ignore[import-untyped,unused-ignore]
import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Ros1Writer

from flatgrasp_cli import read_clouds
from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.recordings.containers.bounded import inflate, inflate_lz4_unchecked
from flatgrasp_cli.sources.selection import Selection
from flatgrasp_cli.sources.summary import summarize
from tests.recordings.writing import ROS1, START_NS

IMAGE, INFO, UNIT = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo", "std_msgs/msg/Float32"
SENSOR = "/device_0/sensor_0"
WIDTH, HEIGHT = 4, 3
COUNTS = np.full((HEIGHT, WIDTH), 8000, "<u2")
F, CX, CY = 100.0, 1.5, 1.0


def header(frame: str) -> Any:
    types = ROS1.types
    return types["std_msgs/msg/Header"](stamp=types["builtin_interfaces/msg/Time"](360, 0), frame_id=frame, seq=0)


def raw_image(extra: bytes = b"", encoding: str = "mono16", counts: Any = COUNTS) -> bytes:
    data = np.asarray(counts).view(np.uint8).reshape(-1)
    message = ROS1.types[IMAGE](header("0"), HEIGHT, WIDTH, encoding, 0, 2 * WIDTH, data)
    return bytes(ROS1.serialize_ros1(message, IMAGE)) + extra


def raw_info() -> bytes:
    roi = ROS1.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, do_rectify=False)
    k = np.array([F, 0, CX, 0, F, CY, 0, 0, 1])
    message = ROS1.types[INFO](
        header(""), HEIGHT, WIDTH, "Brown Conrady", np.zeros(5), k, np.zeros(9), np.zeros(12), 0, 0, roi
    )
    return bytes(ROS1.serialize_ros1(message, INFO))


def sdk_bag(path: Path, unit: float | None, images: list[bytes], info: str = "Depth_0/info/camera_info") -> Path:
    """A depth sensor's stream, and an infrared camera's info that must not be taken for the depth's."""
    with Ros1Writer(path) as writer:
        stream = writer.add_connection(f"{SENSOR}/Depth_0/image/data", IMAGE, typestore=ROS1)
        for k, data in enumerate(images):  # before all else
            writer.write(stream, START_NS + k, data)
        writer.write(writer.add_connection(f"{SENSOR}/{info}", INFO, typestore=ROS1), START_NS + 9, raw_info())
        if unit is not None:
            option = writer.add_connection(f"{SENSOR}/option/Depth Units/value", UNIT, typestore=ROS1)
            writer.write(option, START_NS + 9, struct.pack("<f", unit))
        other = writer.add_connection("/device_0/sensor_1/option/Depth Units/value", UNIT, typestore=ROS1)
        writer.write(other, START_NS + 9, struct.pack("<f", 0.5))
    return path


def clouds(path: Path, **wanted: Any) -> list[Cloud]:
    return list(read_clouds(path, selection=Selection(**wanted)))


@pytest.mark.parametrize(
    ("option", "after", "stated", "unit"),
    [
        (1e-4, b"", None, 1e-4),
        (None, struct.pack("<f", 1e-4), None, 1e-4),
        (1e-3, struct.pack("<f", 1e-4), None, 1e-4),  # it is that image's own
        (2e-4, struct.pack("<f", 0.0), None, 2e-4),
        (1e-3, b"", 1e-4, 1e-4),
    ],
)
def test_where_a_count_of_depth_is_told(
    option: float | None, after: bytes, stated: float | None, unit: float, tmp_path: Path
) -> None:
    path = sdk_bag(tmp_path / "a.bag", option, [raw_image(after)] * 2)
    first, second = clouds(path, depth_unit_m=stated)
    np.testing.assert_allclose(first.points[:, 2], 8000 * unit, rtol=1e-6)
    np.testing.assert_allclose(first.points[0, :2], first.points[0, 2] * np.array([-CX, -CY]) / F, rtol=1e-6)
    np.testing.assert_array_equal(first.points, second.points)
    assert (first.frame_id, first.warnings, len(first.points)) == ("0", (), WIDTH * HEIGHT)
    assert summarize(str(path)).problems == {}


def test_a_unit_that_nobody_tells_is_hinted_at_until_it_is_stated(tmp_path: Path) -> None:
    path = sdk_bag(tmp_path / "a.bag", None, [raw_image()])
    (cloud,) = clouds(path)
    assert [warning.code for warning in cloud.warnings] == ["depth_unit_assumed"]
    (scaled,) = read_clouds(path, 0.1)
    (stated,) = clouds(path, depth_unit_m=1e-4)
    assert scaled.warnings == stated.warnings == ()
    np.testing.assert_allclose(scaled.points, stated.points, rtol=1e-12)


def test_bytes_after_a_message_are_an_error_but_for_the_sdks(tmp_path: Path) -> None:
    for extra in (b"\0", bytes(3), bytes(5), bytes(8)):
        path = sdk_bag(tmp_path / f"{len(extra)}.bag", 1e-4, [raw_image(extra)])
        with pytest.raises(SourceError, match=r"no message on .* could be read: .* size mismatch"):
            clouds(path)
        (problem,) = summarize(str(path)).problems
        assert problem.endswith("could not be decoded (ROS1 message size mismatch for 'sensor_msgs/msg/Image'.)")


def test_without_an_info_the_error_names_the_option(tmp_path: Path) -> None:
    path = sdk_bag(tmp_path / "a.bag", 1e-4, [raw_image()], info="Infrared_1/camera")
    told = f"expected on {SENSOR}/Depth_0/info/camera_info, .*--intrinsics fx,fy,cx,cy"
    with pytest.raises(SourceError, match=told):  # its info is for images of this size, but of another frame
        clouds(path)


# lz4


def test_an_lz4_frame_with_a_wrong_checksum_is_whole_or_it_is_not() -> None:
    content = bytes(range(256)) * 3000
    for options in ({"store_size": False}, {"store_size": True}, {"store_size": False, "block_linked": False}):
        good = lz4.frame.compress(content, content_checksum=True, **options)
        wrong = good[:-1] + bytes([good[-1] ^ 1])
        assert inflate("lz4", wrong, len(content))[1]
        whole = inflate_lz4_unchecked(wrong, len(content))
        assert whole is not None
        assert bytes(whole) == content
        assert inflate_lz4_unchecked(wrong, len(content) - 1) is None
        assert inflate_lz4_unchecked(wrong[:-100], len(content)) is None
    assert inflate_lz4_unchecked(b"nonsense", 8) is None
    assert inflate_lz4_unchecked(lz4.frame.compress(content), len(content)) is None


def test_a_chunk_with_a_wrong_checksum_is_used_and_told(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    writer = Ros1Writer(path)
    writer.set_compression(Ros1Writer.CompressionFormat.LZ4)
    with writer:
        stream = writer.add_connection(f"{SENSOR}/Depth_0/image/data", IMAGE, typestore=ROS1)
        writer.write(stream, START_NS, raw_image())
    data = bytearray(path.read_bytes())
    start = data.index(b"\x04\x22\x4d\x18")
    (size,) = struct.unpack_from("<I", data, start - 4)
    packed = bytes(data[start : start + size])
    content = lz4.frame.decompress(packed)
    checked = bytearray(lz4.frame.compress(content, content_checksum=True))
    checked[-1] ^= 1
    data[start - 4 : start + size] = struct.pack("<I", len(checked)) + checked
    path.write_bytes(data)
    told = summarize(str(path)).problems
    assert any("used, though its checksum is wrong" in problem for problem in told)
    assert not any("skipped" in problem for problem in told)
