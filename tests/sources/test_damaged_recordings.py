"""Of a damaged recording what can be read is given, and the rest is counted and told."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import Writer as Ros2Writer

from flatgrasp_cli.errors import SourceError
from tests.recordings.writing import (
    CLOUD_TYPE,
    POINTS,
    ROS1,
    ROS2,
    START_NS,
    write_other_mcap,
)
from tests.sources.recordings import cloud_message, frames


def test_a_truncated_bag_gives_what_can_be_read(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "cut.bag"
    writer = Ros1Writer(path)
    writer.chunk_threshold = 1000
    message = ROS1.serialize_ros1(cloud_message(ROS1, np.ones((100, 3), np.float32), "packed"), CLOUD_TYPE)
    with writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS1)
        for k in range(10):
            writer.write(connection, START_NS + k, message)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with caplog.at_level(logging.WARNING):
        found = frames(path)
    assert 3 <= len(found) <= 5
    assert any("byte" in record.getMessage() and str(path) in record.getMessage() for record in caplog.records)
    with pytest.raises(SourceError, match=r"cut\.bag: "):
        frames(path, strict=True)


def test_frames_that_cannot_be_decoded_are_counted(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "short"
    good = cloud_message(ROS2, np.ones((100, 3), np.float32), "packed")
    short = replace(good, data=good.data[:500])
    with Ros2Writer(path, version=9) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        for k, message in enumerate((good, short, good, short)):
            writer.write(connection, START_NS + k, ROS2.serialize_cdr(message, CLOUD_TYPE))
    with caplog.at_level(logging.WARNING):
        assert len(frames(path)) == 2
    (record,) = caplog.records
    assert f"frame on {POINTS} left out" in record.getMessage()
    assert "(2 times)" in record.getMessage()
    with pytest.raises(SourceError, match="left out"):
        frames(path, strict=True)


def test_damage_that_is_never_twice_the_same_is_no_flood(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "short"
    good = cloud_message(ROS2, np.ones((100, 3), np.float32), "packed")
    with Ros2Writer(path, version=9) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        for k, length in enumerate((1200, *range(500, 530))):
            message = replace(good, data=good.data[:length])
            writer.write(connection, START_NS + k, ROS2.serialize_cdr(message, CLOUD_TYPE))
    with caplog.at_level(logging.WARNING):
        assert len(frames(path)) == 1
    told = [record.getMessage() for record in caplog.records]
    assert len(told) == 11
    assert told[-1] == f"{path}: and 20 more problems like these"


def write_ends_of_transforms(path: Path, definition: bytes | None = None) -> Path:
    """Ten clouds, and transforms that are known for the first three, or whose definition is wrong."""
    cloud, tf = "sensor_msgs/msg/PointCloud2", "tf2_msgs/msg/TFMessage"
    types = ROS2.types
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        channels = {}
        for topic, kind in ((POINTS, cloud), ("/tf", tf)):
            text = ROS2.generate_msgdef(kind, ros_version=2)[0].encode()
            schema = writer.register_schema(kind, "ros2msg", definition if definition and kind == tf else text)
            channels[kind] = writer.register_channel(topic, "cdr", schema)
        for k in range(10):
            second = START_NS // 10**9 + k
            header: Any = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](second, 0), "base")
            transform: Any = types["geometry_msgs/msg/Transform"](
                types["geometry_msgs/msg/Vector3"](1.0, 0.0, 0.0),
                types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
            )
            stamped: Any = types["geometry_msgs/msg/TransformStamped"](header, "camera", transform)
            points = cloud_message(ROS2, np.ones((4, 3), np.float32), "packed")
            points.header.stamp = header.stamp
            log = [(tf, types[tf]([stamped]))] if k < 3 else []
            for kind, message in [*log, (cloud, points)]:
                stamp_ns = second * 10**9
                writer.add_message(channels[kind], stamp_ns, bytes(ROS2.serialize_cdr(message, kind)), stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def test_frames_after_the_last_transform_are_counted(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write_ends_of_transforms(tmp_path / "a.mcap")
    with caplog.at_level(logging.WARNING):
        assert len(frames(path, base_frame="base")) == 3
    (record,) = caplog.records
    assert record.getMessage() == (
        f"{path}: frame on {POINTS} left out: no transform from camera to base: camera ← base is not known at that "
        "time, the nearest sample is earlier, at 1700000002.000 s (7 times)"
    )


def test_transforms_that_cannot_be_decoded_are_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write_ends_of_transforms(tmp_path / "a.mcap", b"@@@")
    told = "messages on /tf cannot be decoded: the definition of tf2_msgs/msg/TFMessage cannot be parsed"
    with (
        caplog.at_level(logging.WARNING),
        pytest.raises(SourceError, match="all 10 frames"),
    ):
        frames(path, base_frame="base")
    assert [record.getMessage() for record in caplog.records] == [f"{path}: {told}"]
    with pytest.raises(SourceError, match=f"{told}$"):
        frames(path, base_frame="base", strict=True)


def test_clouds_in_an_encoding_that_is_not_read_say_so(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write_other_mcap(tmp_path / "a", "cbor", ("foxglove.PointCloud", "", b""), [b"x", b"y"])
    with caplog.at_level(logging.WARNING), pytest.raises(SourceError) as error:
        frames(path)
    assert str(error.value) == (
        f"{path}: no message on {POINTS} could be read: messages on {POINTS} cannot be decoded: "
        "the encoding 'cbor' is not supported"
    )
    assert not caplog.records
