"""Recordings of which nothing can be read: the error says what is lost, where, and why."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer

from flatgrasp_cli.errors import SourceError
from tests.recordings.containers import CONTAINERS
from tests.recordings.writing import POINTS, ROS1, ROS2, START_NS, header2
from tests.sources.recordings import frames

IMAGE, IMAGE_TYPE = "/camera/depth/image", "sensor_msgs/msg/Image"
PIXELS = np.arange(5000, dtype=np.uint16).view(np.uint8)


def image(types: Any, header: Any) -> Any:
    return types[IMAGE_TYPE](header, 50, 100, "16UC1", 0, 200, PIXELS)


def ros1_images(path: Path) -> Path:
    types = ROS1.types
    header: Any = types["std_msgs/msg/Header"](
        0, types["builtin_interfaces/msg/Time"](*divmod(START_NS, 10**9)), "lens"
    )
    writer = Ros1Writer(path)
    writer.set_compression(Ros1Writer.CompressionFormat.BZ2)
    with writer:
        connection = writer.add_connection(IMAGE, IMAGE_TYPE, typestore=ROS1)
        writer.write(connection, START_NS, ROS1.serialize_ros1(image(types, header), IMAGE_TYPE))
    return damaged(path, path.read_bytes().index(b"BZh") + 200)


def mcap_images(path: Path) -> Path:
    with path.open("wb") as file:
        writer = McapWriter(file, compression=CompressionType.ZSTD)
        writer.start()
        text = ROS2.generate_msgdef(IMAGE_TYPE, ros_version=2)[0].encode()
        channel = writer.register_channel(IMAGE, "cdr", writer.register_schema(IMAGE_TYPE, "ros2msg", text))
        data = bytes(ROS2.serialize_cdr(image(ROS2.types, header2("lens")), IMAGE_TYPE))
        writer.add_message(channel, START_NS, data, START_NS)
        writer.finish()  # type: ignore[no-untyped-call]
    return damaged(path, path.read_bytes().index(b"\x28\xb5\x2f\xfd") + 200)


def sqlite_images(path: Path) -> Path:
    with Ros2Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection(IMAGE, IMAGE_TYPE, typestore=ROS2)
        data = ROS2.serialize_cdr(image(ROS2.types, header2("lens")), IMAGE_TYPE)
        writer.write(connection, START_NS, bytes(data)[:500])
    return path


def damaged(path: Path, at: int) -> Path:
    data = bytearray(path.read_bytes())
    for k in range(at, at + 20):
        data[k] ^= 0xFF
    path.write_bytes(data)
    return path


@pytest.mark.parametrize(
    ("write", "why"),
    [
        (ros1_images, r"chunk at byte 4109 skipped: "),
        (mcap_images, r"chunk at byte \d+ skipped: "),
        (sqlite_images, rf"images\.db3: message on {IMAGE} that could not be decoded "),
    ],
)
def test_images_that_are_there_and_lost_are_not_said_to_be_missing(
    write: Callable[[Path], Path], why: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = write(tmp_path / "images")
    with caplog.at_level(logging.WARNING), pytest.raises(SourceError) as caught:
        frames(path)
    assert str(caught.value).startswith(f"{path}: no message on {IMAGE} could be read: ")
    assert len(str(caught.value).splitlines()) == 1
    assert caplog.records == []  # the error says it
    with pytest.raises(SourceError, match=why):
        frames(path, strict=True)


@pytest.mark.parametrize("container", ["ros1", "mcap none", "mcap without chunks"])
def test_clouds_of_which_none_is_whole_may_have_been_there(container: str, tmp_path: Path) -> None:
    path = CONTAINERS[container](tmp_path)
    path.write_bytes(path.read_bytes()[: 5000 if container == "ros1" else 1000])
    with pytest.raises(SourceError) as caught:
        frames(path)
    first, *rest = str(caught.value).splitlines()
    assert first.startswith(
        f"{path}: holds no point clouds and no depth images, as far as it can be read (truncated at"
    )
    assert rest == [f"  {POINTS}  sensor_msgs/msg/PointCloud2  0 messages"]


@pytest.mark.parametrize("container", ["mcap zstd", "mcap none", "mcap without chunks", "ros1", "ros1 bz2"])
def test_a_recording_cut_at_its_beginning_says_where(
    container: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = CONTAINERS[container](tmp_path)
    data = path.read_bytes()
    for size in range(9 if "ros1" in container else 8, 130):
        path.write_bytes(data[:size])
        with caplog.at_level(logging.WARNING), pytest.raises(
            SourceError, match=r"(truncated|ends without a footer).* at byte \d+"
        ):  # fmt: skip
            frames(path)
    assert caplog.records == []


def test_a_compressed_file_cut_at_its_beginning_says_so(tmp_path: Path) -> None:
    path = CONTAINERS["mcap zstd file"](tmp_path)
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(SourceError, match="is compressed with zstd, and is damaged or cut short where it begins, or"):
        frames(path)
