"""From a recording to grasps: the same answers from every container, the frames that were asked for, honest damage."""

from __future__ import annotations

import base64
import json
import logging
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from numpy.typing import NDArray
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer

from flatgrasp_cli import plan, read_clouds
from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.sensor import located
from flatgrasp_cli.sources.selection import Every, Moment, Selection, parse_every, parse_moment
from flatgrasp_cli.sources.summary import summarize
from tests.conftest import MM, SAMPLES, Run
from tests.recordings.writing import (
    CLOUD_TYPE,
    POINTS,
    ROS1,
    ROS2,
    START_NS,
    TEXT_TYPE,
    raw_cloud,
    write_mcap,
    write_other_mcap,
)

PAN = {name: SAMPLES / name for name in ("pan_ros2", "pan_ros1.bag", "pan_foxglove.mcap")}
PERIOD_NS = 200_000_000
STAMPS = [START_NS + k * PERIOD_NS for k in range(3)]
PAN_X_M = 0.5
"""Where make_recordings.py puts the pan in base_link."""
FLOATS = {"f4": 7, "f8": 8}
NO_INFO = (
    "expected on /depth/camera_info, or one for frame 'camera' and 2 × 2 pixels; CameraInfos seen so far: none; "
    "or give --intrinsics fx,fy,cx,cy"
)


def frames(path: Path, **wanted: Any) -> list[Cloud]:
    return list(read_clouds(path, selection=Selection(**wanted)))


# --- the same grasps from everywhere ----------------------------------------------------------------------------------


def cloud_message(store: Any, points: NDArray[np.float32], layout: str) -> Any:
    """A PointCloud2 of `points` in a layout: packed, double, big_endian or padded rows."""
    kind = "f8" if layout == "double" else "f4"
    order = ">" if layout == "big_endian" else "<"
    step, row_rest = (48, 16) if layout == "padded" else (3 * int(kind[1]), 0)
    height, width = (2, len(points) // 2) if layout == "padded" else (1, len(points))
    names = ["z", "y", "x"] if layout == "padded" else ["x", "y", "z"]
    offsets = [step - int(kind[1]) * (k + 1) for k in range(3)] if layout == "padded" else None
    offsets = offsets or [int(kind[1]) * k for k in range(3)]
    row = np.dtype({"names": names, "formats": [order + kind] * 3, "offsets": offsets, "itemsize": step})
    table = np.zeros((height, width), row)
    for k, axis in enumerate("xyz"):
        table[axis] = points[: height * width, k].reshape(height, width)
    rows = np.zeros((height, width * step + row_rest), np.uint8)
    rows[:, : width * step] = table.view(np.uint8).reshape(height, -1)
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](START_NS // 10**9, 0)
    sequence = {"seq": 0} if "seq" in types["std_msgs/msg/Header"].__annotations__ else {}
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera", **sequence)
    fields = [
        types["sensor_msgs/msg/PointField"](name, offset, FLOATS[kind], 1)
        for name, offset in zip(names, offsets, strict=True)
    ]
    return types[CLOUD_TYPE](
        header, height, width, fields, order == ">", step, rows.shape[1], rows.reshape(-1), layout != "padded"
    )


def ros1_bag(path: Path, points: NDArray[np.float32], layout: str) -> Path:
    with Ros1Writer(path) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS1)
        writer.write(connection, START_NS, ROS1.serialize_ros1(cloud_message(ROS1, points, layout), CLOUD_TYPE))
    return path


def rosbag2(path: Path, points: NDArray[np.float32], layout: str, storage: StoragePlugin) -> Path:
    with Ros2Writer(path, version=9, storage_plugin=storage) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        writer.write(connection, START_NS, ROS2.serialize_cdr(cloud_message(ROS2, points, layout), CLOUD_TYPE))
    return path


def json_mcap(path: Path, points: NDArray[np.float32], _layout: str) -> Path:
    message = {
        "timestamp": {"sec": START_NS // 10**9, "nsec": 0},
        "frame_id": "camera",
        "point_stride": 12,
        "fields": [{"name": axis, "offset": 4 * k, "type": 7} for k, axis in enumerate("xyz")],
        "data": base64.b64encode(points.astype("<f4").tobytes()).decode(),
    }
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        channel = writer.register_channel(
            POINTS, "json", writer.register_schema("foxglove.PointCloud", "jsonschema", b"{}")
        )
        writer.add_message(channel, START_NS, json.dumps(message).encode(), START_NS)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


WRITERS: dict[str, Callable[[Path, NDArray[np.float32], str], Path]] = {
    "ROS 1 bag": ros1_bag,
    "rosbag2 sqlite3": lambda path, points, layout: rosbag2(path, points, layout, StoragePlugin.SQLITE3),
    "rosbag2 mcap": lambda path, points, layout: rosbag2(path, points, layout, StoragePlugin.MCAP),
}


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


# --- which frames -----------------------------------------------------------------------------------------------------


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


# --- the frame asked for ----------------------------------------------------------------------------------------------


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


# --- damage -----------------------------------------------------------------------------------------------------------


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


# --- inspect ----------------------------------------------------------------------------------------------------------


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


# --- the command line -------------------------------------------------------------------------------------------------


def test_one_line_of_json_for_each_frame(run: Run) -> None:
    ended = run("plan", PAN["pan_foxglove.mcap"], "--json", "--gripper", "pr2", "--base-frame", "base_link")
    assert ended.code == 0
    lines = [json.loads(line) for line in ended.out.splitlines()]
    assert [line["source"]["stamp_ns"] for line in lines] == STAMPS
    assert [line["source"]["index"] for line in lines] == [0, 1, 2]
    assert {line["frame_id"] for line in lines} == {"base_link"}
    assert {line["source"]["topic"] for line in lines} == {"/points"}


def test_files_are_named_by_stamp(run: Run) -> None:
    ended = run("plan", PAN["pan_ros2"], "--gripper", "pr2", "--every", "2", "--plots", "none")
    assert ended.code == 0
    names = [f"pan_ros2.{stamp // 10**9}.{stamp % 10**9:09d}.grasps.json" for stamp in STAMPS[::2]]
    assert sorted(path.name for path in Path.cwd().iterdir()) == names


def test_frames_of_one_stamp_do_not_overwrite_each_other(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "same"
    message = cloud_message(ROS2, np.ones((5, 3), np.float32), "packed")
    with Ros2Writer(path, version=9) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        for k in range(2):
            writer.write(connection, START_NS + k, ROS2.serialize_cdr(message, CLOUD_TYPE))
    assert run("plan", path, "--out", tmp_path / "out", "--plots", "none").code == 1
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["same.1700000000.000000000-2.grasps.json", "same.1700000000.000000000.grasps.json"]


def test_mcap_from_a_pipe(run: Run) -> None:
    ended = run("plan", "-", "--json", "--count", "1", stdin=PAN["pan_foxglove.mcap"].read_bytes())
    assert ended.code == 0
    assert json.loads(ended.out)["source"]["path"] == "stdin"


def test_a_robot_finds_its_base_frame_in_the_recording(run: Run) -> None:
    ended = run("plan", PAN["pan_ros2"], "--robot", "ur5e", "--base-frame", "base_link", "--json", "--gripper", "pr2")
    assert ended.code == 0
    for line in ended.out.splitlines():
        document = json.loads(line)
        assert document["frame_id"] == "base_link"
        assert all(grasp["reach"]["ok"] for item in document["objects"] for grasp in item["grasps"])


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--at", "1", "--count", "2"), "--at"),
        (("--every", "0"), "--every"),
        (("--start", "soon"), "soon"),
    ],
)
def test_wrong_options(run: Run, options: tuple[str, ...], word: str) -> None:
    ended = run("plan", PAN["pan_ros2"], *options)
    assert (ended.code, ended.out) == (2, "")
    assert word in ended.err
    assert len(ended.err.splitlines()) <= 2


def test_damage_is_a_warning_or_with_strict_an_error(
    run: Run, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = write_mcap(tmp_path / "damaged.mcap", 5, CompressionType.NONE)
    content = bytearray(path.read_bytes())
    content[content.index(raw_cloud(2)[40:]) + 500] ^= 0xFF  # in the second of three chunks
    path.write_bytes(content)
    ended = run("plan", path, "--json")
    assert (ended.code, len(ended.out.splitlines())) == (1, 3)
    (warning,) = caplog.records
    assert warning.getMessage().startswith(f"{path}: chunk at byte ")
    ended = run("plan", path, "--json", "--strict")
    assert ended.code == 3
    assert len(ended.err.splitlines()) <= 4


def test_inspect_prints_tables_and_json(run: Run, tmp_path: Path) -> None:
    ended = run("inspect", PAN["pan_ros1.bag"], SAMPLES / "pan.pcd")
    assert ended.code == 0
    for text in ("/camera/depth/image_rect_raw", "points: 160 × 120, ", "16UC1", "PCD", "base_link"):
        assert text in ended.out
    ended = run("inspect", PAN["pan_ros1.bag"], tmp_path / "gone.bag", "--json")
    assert ended.code == 3
    assert "gone.bag" in ended.err
    (line,) = ended.out.splitlines()
    assert json.loads(line)["schema"] == "flatgrasp.inspect/1"
    assert json.loads(line)["clouds"][0]["points"] == 19_200


def test_inspect_calls_the_frame_of_a_file_as_documents_do(run: Run) -> None:
    summary = json.loads(run("inspect", SAMPLES / "pan.pcd", "--json").out)
    assert (summary["clouds"][0]["frame_id"], summary["frames"]) == ("cloud", [])
    assert run("inspect", SAMPLES / "pan.pcd").out.splitlines()[1] == "cloud"


def test_inspect_obeys_no_name_and_lists_no_end_of_problems(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    path = tmp_path / "a.bag"
    good = cloud_message(ROS1, np.ones((100, 3), np.float32), "packed")
    with Ros1Writer(path) as writer:
        connection = writer.add_connection("/a\x1b[31m", CLOUD_TYPE, typestore=ROS1)
        for k in range(15):
            message = replace(good, data=good.data[: 500 + k])
            writer.write(connection, START_NS + k, ROS1.serialize_ros1(message, CLOUD_TYPE))
    ended = run("inspect", path)
    assert ended.code == 0
    assert "/a\\x1b[31m" in ended.out
    assert "\x1b" not in ended.out + ended.err
    problems = ended.out.splitlines()[-11:]
    assert all(line.startswith("problem: frame on /a\\x1b[31m left out: ") for line in problems[:-1])
    assert problems[-1] == "and 5 more kinds of problems; --json lists them"


def test_a_base_frame_may_have_tfs_slash(run: Run) -> None:
    ended = run("plan", PAN["pan_ros2"], "--base-frame", "/base_link", "--count", "1", "--json", "--gripper", "pr2")
    assert ended.code == 0
    assert json.loads(ended.out)["frame_id"] == "base_link"
