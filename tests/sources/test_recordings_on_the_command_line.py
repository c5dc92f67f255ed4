"""Recordings on the command line: documents by frame, names of files, wrong options, and `inspect`."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import CompressionType
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import Writer as Ros2Writer

from tests.conftest import SAMPLES, Run
from tests.recordings.writing import (
    CLOUD_TYPE,
    POINTS,
    ROS1,
    ROS2,
    START_NS,
    raw_cloud,
    write_mcap,
)
from tests.sources.recordings import PAN, STAMPS, cloud_message


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
