"""Where a recording's clouds and their sensor are, by its transforms."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli import read_clouds
from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources.selection import Moment, Selection
from tests.conftest import SAMPLES, Run
from tests.recordings.writing import ROS2, START_NS, header2, transform2, write_messages

S = 1_000_000_000
DOWN = (1.0, 0.0, 0.0, 0.0)
"""An optical frame that looks down on a base whose z points up."""
BODY_DOWN = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))
"""The body frame of a camera that looks down."""
OPTICAL = (-0.5, 0.5, -0.5, 0.5)
"""An optical frame in its body, as URDFs have it: rpy −90° 0 −90°."""
CLOUD, IMAGE, INFO = (f"sensor_msgs/msg/{name}" for name in ("PointCloud2", "Image", "CameraInfo"))
Logged = tuple[str, str, int, Any]


def cloud(frame_id: str, after_s: float = 0.0) -> Logged:
    """One point, half a metre along z, and one beside it."""
    types: Any = ROS2.types
    fields = [types["sensor_msgs/msg/PointField"](axis, 4 * k, 7, 1) for k, axis in enumerate("xyz")]
    data = np.array([[0, 0, 0.5], [0.1, 0, 0.5]], "<f4").view(np.uint8).reshape(-1)
    stamp = START_NS + int(after_s * S)
    return "/points", CLOUD, stamp, types[CLOUD](header2(frame_id, stamp), 1, 2, fields, False, 12, 24, data, True)


def depth(frame_id: str) -> list[Logged]:
    """Three by three pixels at 0.5 m, and their camera."""
    types: Any = ROS2.types
    raw = np.full((3, 3), 500, "<u2").view(np.uint8).reshape(-1)
    roi = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    k = np.array([10.0, 0, 1, 0, 10, 1, 0, 0, 1])
    info = types[INFO](header2(frame_id), 3, 3, "plumb_bob", np.zeros(5), k, np.eye(3).ravel(), np.zeros(12), 0, 0, roi)
    return [
        ("/depth/camera_info", INFO, START_NS, info),
        ("/depth/image", IMAGE, START_NS, types[IMAGE](header2(frame_id), 3, 3, "16UC1", 0, 6, raw)),
    ]


def static(parent: str, child: str, xyz: Any, quaternion: Any = (0, 0, 0, 1), after_s: float = 0.0) -> Logged:
    kind, message = transform2(parent, child, xyz, quaternion)
    return "/tf_static", kind, START_NS + int(after_s * S), message


def clouds(path: Path, **wanted: Any) -> list[Cloud]:
    return list(read_clouds(path, selection=Selection(**wanted)))


def codes(cloud: Cloud) -> list[str]:
    return [warning.code for warning in cloud.warnings]


def sensor_of(cloud: Cloud) -> tuple[str, Any]:
    """How the sensor's place is known, and the place (3,)."""
    assert cloud.sensor is not None
    return cloud.sensor.known_from, cloud.sensor.position


# static transforms


def test_each_frame_gets_the_static_transform_of_its_time(tmp_path: Path) -> None:
    moves = [static("base_link", "cam", (0, 0, height), DOWN, after) for after, height in ((1, 1), (3, 2), (9, 3))]
    frames = [cloud("cam", after) for after in (0, 2, 4, 20)]
    path = write_messages(tmp_path / "a", sorted([*moves, *frames], key=lambda logged: logged[2]))
    placed = clouds(path, base_frame="base_link")
    np.testing.assert_allclose([each.points[0, 2] for each in placed], [0.5, 0.5, 1.5, 2.5])
    assert codes(placed[-1]) == ["transform_changed"]
    (at,) = clouds(path, base_frame="base_link", at=Moment(15 * S, absolute=False))
    np.testing.assert_allclose(at.points[0], [0, 0, 2.5])


def test_a_frame_that_is_there_is_not_said_to_be_missing(tmp_path: Path) -> None:
    path = write_messages(tmp_path / "a", [static("base_link", "other", (0, 0, 1)), cloud("cam")])
    with pytest.raises(SourceError, match=r"none names 'cam', the frame of the clouds; .*: base_link, other; --cam"):
        clouds(path, base_frame="base_link")
    path = write_messages(tmp_path / "b", [static("base_link", "cam", (0, 0, 1), (0, 0, 0, 0)), cloud("cam")])
    with pytest.raises(SourceError, match="from base_link to cam was ignored, for its quaternion is 0 0 0 0"):
        clouds(path, base_frame="base_link")


# the axes of a depth image's frame


@pytest.mark.parametrize("base", [None, "base_link"])
@pytest.mark.parametrize("axes", ["optical", "body", None])
def test_depth_in_a_body_frame_is_as_stated_or_a_warning(base: str | None, axes: Any, tmp_path: Path) -> None:
    mount = static("base_link", "camera_link", (0, 0, 1), BODY_DOWN if axes == "body" else DOWN)
    path = write_messages(tmp_path / "a", [mount, *depth("camera_link")])
    (found,) = clouds(path, base_frame=base, depth_axes=axes)
    middle = found.points[4]  # half a metre before the camera, which looks down
    ahead = [0.5, 0, 0] if axes == "body" else [0, 0, 0.5]
    np.testing.assert_allclose(middle, [0, 0, 0.5] if base else ahead, atol=1e-12)
    np.testing.assert_allclose(sensor_of(found)[1], [0, 0, 1] if base else [0, 0, 0], atol=1e-12)
    assert codes(found) == ([] if axes else ["depth_axes_assumed"])
    assert all("--depth-axes" in warning.text for warning in found.warnings)


@pytest.mark.parametrize(
    ("turn", "place", "told"),
    [
        (OPTICAL, (0, 0, 0), [0, 0, 0.5]),  # an optical frame at the same place, turned as REP 103 says
        ((0, 0, 0, 1), (0, 0, 0), [0.5, 0, 1]),  # one that is not turned: the frame itself is optical
        (OPTICAL, (0, 0.05, 0), None),  # that of another lens
        ((0, 0, 1, 0), (0, 0, 0), None),  # neither
    ],
)
def test_an_optical_frame_at_the_same_place_tells_the_axes(turn: Any, place: Any, told: Any, tmp_path: Path) -> None:
    mount = static("base_link", "camera_link", (0, 0, 1), BODY_DOWN)
    lens = static("camera_link", "camera_optical_frame", place, turn)
    path = write_messages(tmp_path / "a", [mount, lens, *depth("camera_link")])
    (found,) = clouds(path, base_frame="base_link")
    assert codes(found) == ([] if told else ["depth_axes_assumed"])
    np.testing.assert_allclose(found.points[4], told or [0.5, 0, 1], atol=1e-12)


def test_optical_names_and_frames_that_are_not_placed_are_no_question(tmp_path: Path) -> None:
    mount = static("base_link", "depth_optical_frame", (0, 0, 1), DOWN)
    path = write_messages(tmp_path / "a", [mount, *depth("depth_optical_frame")])
    assert codes(clouds(path, base_frame="base_link")[0]) == []
    assert codes(clouds(write_messages(tmp_path / "b", depth("camera")))[0]) == []


def test_the_command_line_states_the_axes_and_the_unit(run: Run, tmp_path: Path) -> None:
    mount = static("base_link", "camera_link", (0, 0, 1), BODY_DOWN)
    path = write_messages(tmp_path / "a", [mount, *depth("camera_link")])
    for options, told in (
        ((), ["depth_axes_assumed"]),
        (("--depth-axes", "body"), []),
        (("--depth-axes", "body", "--scale", "9"), []),
    ):
        ended = run("plan", path, "--json", "--base-frame", "base_link", *options)
        said = {warning["code"] for warning in json.loads(ended.out)["warnings"]}
        assert said - {"doubtful_grasp", "sparse_cloud"} == set(told)  # wrong axes are worth no good grasp


# where the sensor was


def test_the_sensor_is_the_frame_that_was_named(tmp_path: Path) -> None:
    mounts = [static("base_link", "gripper", (0, 0, 0.3)), static("gripper", "eye", (0.1, 0, 0))]
    path = write_messages(tmp_path / "a", [*mounts, cloud("base_link")])
    for base, height in ((None, 0.3), ("gripper", 0.0)):
        (found,) = clouds(path, sensor_frame="/eye", base_frame=base)
        known_from, position = sensor_of(found)
        assert known_from == "option"
        np.testing.assert_allclose(position, np.array([0.1, 0, height]))
        assert codes(found) == []
    with pytest.raises(SourceError, match=r"^.*--sensor ear: no frame 'ear' in .*: base_link, eye, gripper$"):
        clouds(path, sensor_frame="ear")


def test_only_a_recording_knows_the_sensors_frame(run: Run) -> None:
    ended = run("plan", SAMPLES / "pan.pcd", "--sensor", "camera")
    assert ended.code == 2
    assert "--sensor camera: is the name of a frame, and only a recording can say where that is" in ended.err


@pytest.mark.parametrize(
    ("optical", "taken"),
    [
        (["cam_optical_frame"], True),
        (["cam_color_optical_frame", "cam_depth_optical_frame"], True),
        (["left_optical_frame", "right_optical_frame"], False),
        (["left_depth_optical_frame", "right_depth_optical_frame"], False),
        ([], False),
    ],
)
def test_the_only_optical_frame_is_the_likely_sensor(optical: list[str], taken: bool, tmp_path: Path) -> None:
    mounts = [static("base_link", frame, (k, 0, 1), DOWN) for k, frame in enumerate(optical)]
    path = write_messages(tmp_path / "a", [*mounts, static("base_link", "arm", (0, 0, 1)), cloud("base_link")])
    (found,) = clouds(path)
    assert (found.sensor is not None) == taken
    if taken:
        known_from, position = sensor_of(found)
        assert known_from == "transforms"
        np.testing.assert_allclose(position, [len(optical) - 1, 0, 1])
        (told,) = found.warnings
        assert told.code == "sensor_from_tf"
        assert optical[-1] in told.text
        assert "--sensor" in told.text


def test_an_optical_frame_that_leads_nowhere_is_none(tmp_path: Path) -> None:
    path = write_messages(tmp_path / "a", [static("map", "cam_optical_frame", (0, 0, 1)), cloud("base_link")])
    assert clouds(path)[0].sensor is None


def test_transforms_are_read_only_when_needed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_messages(tmp_path / "a", [static("base", "cam_optical_frame", (0, 0, 1)), cloud("cam_optical_frame")])
    monkeypatch.setattr("flatgrasp_cli.sources.frames.RecordedTransforms", None)
    (found,) = clouds(path)
    assert sensor_of(found)[0] == "frame"


# topics


@pytest.mark.parametrize("name", ["/camera/ir/image_raw", "/zed/confidence/confidence_map", "/Infrared_1/image/data"])
def test_images_that_are_no_depth_by_their_topic_are_not_taken_for_it(name: str, tmp_path: Path) -> None:
    info, image = depth("cam")
    path = write_messages(tmp_path / "a", [info, image, (name, *image[1:])])
    assert clouds(path)[0].source.topic == "/depth/image"
    assert clouds(path, topic=name)[0].source.topic == name


def test_depth_in_jpeg_alone_says_what_is_wrong(tmp_path: Path) -> None:
    kind = "sensor_msgs/msg/CompressedImage"
    jpeg = ROS2.types[kind](header2("cam"), "16UC1; jpeg compressed mono8", np.array([255, 216], np.uint8))
    path = write_messages(tmp_path / "a", [("/depth/image/compressed", kind, START_NS, jpeg)])
    with pytest.raises(SourceError, match="the depth images on /depth/image/compressed are JPEG, which destroys depth"):
        clouds(path)
