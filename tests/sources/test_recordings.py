"""Recordings give the same clouds, and grasps, as files; which of their frames, topics and transforms."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import Writer as Ros2Writer

from flatgrasp_cli import plan, read_clouds
from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.sensor import located
from flatgrasp_cli.sources.selection import Every, Moment, Selection, parse_every, parse_moment
from flatgrasp_cli.sources.summary import summarize
from tests.conftest import MM, SAMPLES
from tests.recordings.writing import (
    CLOUD_TYPE,
    POINTS,
    ROS1,
    ROS2,
    START_NS,
)
from tests.sources.recordings import PAN, PAN_X_M, STAMPS, WRITERS, cloud_message, frames, json_mcap


@pytest.fixture(scope="module")
def pan() -> Cloud:
    """The pan alone, as the PCD file gives it; an even number of points, for two rows."""
    (cloud,) = read_clouds(SAMPLES / "pan.pcd")
    return replace(cloud, points=cloud.points[: len(cloud.points) // 2 * 2])


@pytest.fixture(scope="module")
def answer(pan: Cloud, pr2: Gripper) -> list[Any]:
    """The grasps that PCD gives."""
    return grasps(pan, pr2)


def grasps(cloud: Cloud, gripper: Gripper) -> list[Any]:
    found = [grasp for item in plan(cloud, gripper).objects for grasp in item.grasps]
    assert found
    return [(*grasp.position, *grasp.orientation, grasp.width_m, grasp.opening_m) for grasp in found]


@pytest.mark.parametrize("layout", ["packed", "double", "big_endian", "padded"])
@pytest.mark.parametrize("container", WRITERS)
def test_round_trip(container: str, layout: str, pan: Cloud, answer: list[Any], pr2: Gripper, tmp_path: Path) -> None:
    path = WRITERS[container](tmp_path / "pan", pan.points.astype(np.float32), layout)
    (cloud,) = read_clouds(path)
    np.testing.assert_array_equal(cloud.points, pan.points)
    assert (cloud.frame_id, cloud.source.topic, cloud.source.stamp_ns) == ("camera", POINTS, START_NS)
    if layout == "packed":
        assert grasps(cloud, pr2) == answer


def test_round_trip_without_ros(pan: Cloud, answer: list[Any], pr2: Gripper, tmp_path: Path) -> None:
    (cloud,) = read_clouds(json_mcap(tmp_path / "pan.mcap", pan.points.astype(np.float32), "packed"))
    assert grasps(cloud, pr2) == answer


HERE = {"orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
UNUSABLE: dict[str, tuple[dict[str, Any], str]] = {
    "frame": ({"frame_id": "cam\udcf6ra"}, r"its frame cam\\xf6ra is no text in UTF-8"),
    "pose": ({"pose": {"position": {"x": 1e308, "y": 0, "z": 0}, **HERE}}, "its pose is not finite in units of 10 m"),
}


@pytest.mark.parametrize(("more", "words"), UNUSABLE.values(), ids=UNUSABLE)
def test_what_json_can_hold_and_no_document_is_left_out(more: dict[str, Any], words: str, tmp_path: Path) -> None:
    path = json_mcap(tmp_path / "odd.mcap", np.ones((4, 3), np.float32), "packed", **more)
    with pytest.raises(SourceError, match=words):
        list(read_clouds(path, scale=10.0))
    assert all(name.isascii() for name in summarize(str(path)).frames)


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        ({"count": 0}, "count is a whole number, one or more, not 0"),
        ({"count": 1.5}, "not 1.5"),
        ({"at": Moment(0, absolute=False), "count": 1}, "at names one frame"),
        ({"at": Moment(0, absolute=False), "every": Every(frames=2)}, "at names one frame"),
        ({"depth_unit_m": -0.001}, "not -0.001"),
        ({"depth_unit_m": np.nan}, "not nan"),
        ({"depth_unit_m": 1.5}, "not 1.5"),
        ({"depth_axes": "camera"}, "depth_axes are optical or body, not 'camera'"),
    ],
)
def test_a_selection_that_the_command_line_refuses_is_none(wanted: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Selection(**wanted)


@pytest.mark.parametrize("wanted", [{"frames": 0}, {"frames": 2.5}, {"period_ns": 0}])
def test_every_is_one_or_more(wanted: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(wanted))} is a whole number, one or more"):
        Every(**wanted)


def sensor_of(cloud: Cloud) -> FloatArray:
    """Where the sensor was, as `plan` finds it."""
    sensor = located(cloud, None, 0).sensor
    assert sensor is not None
    assert sensor.position is not None
    return sensor.position


def test_the_sample_recordings_hold_the_same_frames() -> None:
    base = {"base_frame": "base_link"}
    ros2, ros1, foxglove = (frames(path, **base) for path in PAN.values())
    assert [cloud.source.stamp_ns for cloud in ros2] == STAMPS
    for a, b, c in zip(ros2, ros1, foxglove, strict=True):
        assert a.source.stamp_ns == b.source.stamp_ns == c.source.stamp_ns
        np.testing.assert_allclose(a.points, c.points, atol=1e-9)
        np.testing.assert_allclose(a.points, b.points, atol=0.6 * MM)  # depth images are in whole millimetres
        np.testing.assert_allclose(sensor_of(a), sensor_of(b), atol=2 * MM)


def test_depth_images_without_their_camera_say_so(tmp_path: Path) -> None:
    path = tmp_path / "image.bag"
    image = ROS1.types["sensor_msgs/msg/Image"]
    stamp = ROS1.types["builtin_interfaces/msg/Time"](1, 0)
    header = ROS1.types["std_msgs/msg/Header"](0, stamp, "camera")
    with Ros1Writer(path) as writer:
        connection = writer.add_connection("/depth/image", "sensor_msgs/msg/Image", typestore=ROS1)
        message = image(header, 2, 2, "16UC1", 0, 4, np.ones(8, np.uint8))
        writer.write(connection, START_NS, ROS1.serialize_ros1(message, "sensor_msgs/msg/Image"))
    with pytest.raises(SourceError, match=r"the only frame on /depth/image left out: no CameraInfo"):
        frames(path)


@pytest.mark.parametrize("name", PAN)
@pytest.mark.parametrize(
    ("wanted", "kept"),
    [
        ({}, [0, 1, 2]),
        ({"every": Every(frames=2)}, [0, 2]),
        ({"every": Every(period_ns=300_000_000)}, [0, 2]),
        ({"every": Every(period_ns=200_000_000)}, [0, 1, 2]),
        ({"count": 2}, [0, 1]),
        ({"start": Moment(60_000_000, absolute=False)}, [1, 2]),  # the transforms begin 50 ms before the frames
        ({"end": Moment(450_000_000, absolute=False)}, [0, 1]),
        ({"start": Moment(STAMPS[1], absolute=True), "end": Moment(STAMPS[2], absolute=True)}, [1]),
        ({"at": Moment(STAMPS[1], absolute=True)}, [1]),
        ({"at": Moment(STAMPS[1] + 1, absolute=True)}, [2]),
    ],
)
def test_the_frames_that_were_asked_for(name: str, wanted: dict[str, Any], kept: list[int]) -> None:
    assert [cloud.source.stamp_ns for cloud in frames(PAN[name], **wanted)] == [STAMPS[k] for k in kept]
    assert [cloud.source.index for cloud in frames(PAN[name], **wanted)] == list(range(len(kept)))


def test_nothing_at_that_time_says_how_long_the_recording_is() -> None:
    with pytest.raises(SourceError, match=r"no message on /points from 9\.000 s on; the recording lasts 0\.500 s"):
        frames(PAN["pan_foxglove.mcap"], at=parse_moment("9"))


@pytest.mark.parametrize(
    ("text", "moment"),
    [
        ("0", Moment(0, absolute=False)),
        ("2.5", Moment(2_500_000_000, absolute=False)),
        ("1700000000.123456789", Moment(1_700_000_000_123_456_789, absolute=True)),
        ("2023-11-14T22:13:20Z", Moment(1_700_000_000 * 10**9, absolute=True)),
        ("2023-11-14T22:13:20", Moment(1_700_000_000 * 10**9, absolute=True)),
        ("2023-11-14T23:13:20.25+01:00", Moment(1_700_000_000_250_000_000, absolute=True)),
    ],
)
def test_moments(text: str, moment: Moment) -> None:
    assert parse_moment(text) == moment


@pytest.mark.parametrize("text", ["", "-1", "nan", "inf", "yesterday", "1e40"])
def test_what_is_no_moment(text: str) -> None:
    with pytest.raises(UsageError, match="is no time"):
        parse_moment(text)


def test_every() -> None:
    assert parse_every("5") == Every(frames=5)
    assert parse_every("0.5s") == Every(period_ns=500_000_000)
    for text in ("0", "-1", "0s", "nans", "half", "1.5", "99999999999999999999"):
        with pytest.raises(UsageError, match="--every"):
            parse_every(text)


def test_a_wrong_topic_lists_what_there_is() -> None:
    with pytest.raises(SourceError) as error:
        frames(PAN["pan_ros2"], topic="/camera/points")
    assert "has no topic /camera/points" in str(error.value)
    assert "/camera/depth/points  sensor_msgs/msg/PointCloud2  3 messages" in str(error.value)
    with pytest.raises(SourceError, match=r"topic /tf holds tf2_msgs/msg/TFMessage, no point clouds"):
        frames(PAN["pan_ros2"], topic="/tf")
    assert len(frames(PAN["pan_ros2"], topic="camera/depth/points")) == 3  # without the leading slash, too


def test_of_several_cloud_topics_one_must_be_chosen(tmp_path: Path) -> None:
    path = tmp_path / "two"
    with Ros2Writer(path, version=9) as writer:
        message = ROS2.serialize_cdr(cloud_message(ROS2, np.ones((4, 3), np.float32), "packed"), CLOUD_TYPE)
        for topic in ("/left", "/right"):
            writer.write(writer.add_connection(topic, CLOUD_TYPE, typestore=ROS2), START_NS, message)
    with pytest.raises(SourceError, match="choose one with --topic") as error:
        frames(path)
    assert "/left" in str(error.value)
    assert "/right" in str(error.value)
    (cloud,) = frames(path, topic="/right")
    assert cloud.source.topic == "/right"


def test_transforms_bring_the_pan_to_the_robot(pr2: Gripper) -> None:
    for cloud in frames(PAN["pan_ros1.bag"], base_frame="base_link"):
        assert cloud.frame_id == "base_link"
        assert sensor_of(cloud)[2] == pytest.approx(0.9 * np.cos(np.radians(20)), abs=1 * MM)
        best = plan(cloud, pr2).best
        assert best is not None
        assert abs(best.position[0] - PAN_X_M) < 0.2
        assert 0 < best.position[2] < 0.05  # over the table, which is at the base's height


def test_a_missing_link_is_named() -> None:
    with pytest.raises(SourceError, match="all 3 frames") as error:
        frames(PAN["pan_ros2"], base_frame="torso")
    assert "torso" in str(error.value)
    assert "base_link" in str(error.value)
