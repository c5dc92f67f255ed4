"""What a recording or a file holds, without a plan."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Ros1Writer

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sources.summary import summarize
from tests.conftest import SAMPLES
from tests.recordings.writing import (
    CLOUD_TYPE,
    POINTS,
    ROS1,
    START_NS,
    TEXT_TYPE,
    raw_cloud,
    write_other_mcap,
)
from tests.sources.recordings import NO_INFO, PAN, STAMPS, cloud_message, frames


def test_summary_of_a_recording() -> None:
    summary = summarize(str(PAN["pan_ros2"]))
    assert summary.duration_s == pytest.approx(0.5)
    assert {topic.name: topic.count for topic in summary.topics} == {
        "/camera/depth/points": 3,
        "/tf": 11,
        "/tf_static": 1,
    }
    assert next(topic.rate_hz for topic in summary.topics if topic.name == "/tf") == pytest.approx(20)
    assert summary.frames == ("base_link", "camera_depth_optical_frame", "camera_link")
    (cloud,) = summary.clouds
    assert (cloud.points, cloud.shape, cloud.fields) == (19_200, (120, 160), ("x", "y", "z"))
    assert cloud.stamp_ns == STAMPS[0]
    first = frames(PAN["pan_ros2"], count=1)[0]
    assert cloud.nan_share == first.dropped / 19_200
    assert cloud.low_m == tuple(first.points.min(axis=0))


def test_summary_of_one_topic_of_two_types(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "a.bag"
    with Ros1Writer(path) as writer:
        text = writer.add_connection(POINTS, TEXT_TYPE, typestore=ROS1)
        writer.write(text, START_NS, ROS1.serialize_ros1(ROS1.types[TEXT_TYPE]("x"), TEXT_TYPE))
        clouds = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS1)
        writer.write(clouds, START_NS, raw_cloud(0, "ros1"))
    summary = summarize(str(path))
    assert [(cloud.topic, cloud.points, cloud.fields) for cloud in summary.clouds] == [(POINTS, 100, ("x", "y", "z"))]
    assert summary.problems == {}
    assert not caplog.records


def test_what_is_read_ahead_is_counted_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "a.bag"
    image, info = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
    header = cloud_message(ROS1, np.ones((1, 3), np.float32), "packed").header
    pixels = ROS1.types[image](header, 2, 2, "16UC1", 0, 4, np.ones(8, np.uint8))
    with Ros1Writer(path) as writer:
        infos = writer.add_connection("/depth/camera_info", info, typestore=ROS1)
        images = writer.add_connection("/depth/image", image, typestore=ROS1)
        writer.write(infos, START_NS, b"x")
        writer.write(images, START_NS + 1, b"x")
        writer.write(images, START_NS + 2, ROS1.serialize_ros1(pixels, image))
    counts = summarize(str(path)).problems
    assert [(name.split(" that ")[0], count) for name, count in counts.items()] == [
        ("message on /depth/camera_info", 1),
        ("message on /depth/image", 1),
        (f"the only frame on /depth/image left out: no CameraInfo for /depth/image: {NO_INFO}", 1),
    ]
    with caplog.at_level(logging.WARNING), pytest.raises(SourceError, match="the only frame"):
        frames(path)
    assert len(caplog.records) == 2
    assert not any("times)" in record.getMessage() for record in caplog.records)


def test_summary_tells_all_problems_itself(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write_other_mcap(tmp_path / "a", "cbor", ("foxglove.PointCloud", "", b""), [b"x"])
    (problem,) = summarize(str(path)).problems
    assert problem.endswith("the encoding 'cbor' is not supported")
    assert not caplog.records


def test_summary_of_a_file() -> None:
    summary = summarize(str(SAMPLES / "pan.pcd"))
    assert (summary.container, summary.topics, summary.duration_s) == ("PCD", (), None)
    assert summary.clouds[0].fields == ("x", "y", "z")
