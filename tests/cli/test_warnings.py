"""What had to be assumed is in every document, and on stderr once a source."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer

from flatgrasp_cli.geometry.arrays import FloatArray
from tests.conftest import SAMPLES, Box, Camera, Run
from tests.recordings.writing import CLOUD_TYPE, POINTS, ROS1, cloud_message, stamps

UPSIDE = "the hand comes from above, as the frame's name or --up says"


@pytest.fixture(scope="module")
def sheet() -> FloatArray:
    """A thin plate in a robot's frame, which can have been seen from either side."""
    points = Camera().sees(Box((0, 0, 0), (0.12, 0.05, 0.001))).points
    return np.asarray(points + np.array([0.1, 0.1, 0.6]))


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory, sheet: FloatArray) -> Path:
    """Three frames of the plate, in `base_link`."""
    path = tmp_path_factory.mktemp("bags") / "plate.bag"
    data = np.ascontiguousarray(sheet, dtype=np.float32).view(np.uint8).reshape(-1)
    writer = Writer(path)
    with writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS1)
        for k, stamp in enumerate(stamps(3)):
            message = cloud_message(ROS1, k)
            message = replace(
                message,
                header=replace(message.header, frame_id="base_link"),
                width=len(sheet),
                row_step=12 * len(sheet),
                data=data,
            )
            writer.write(connection, stamp, ROS1.serialize_ros1(message, CLOUD_TYPE))
    return path


def test_a_warning_is_in_each_document_and_said_once_a_source(bag: Path, run: Run) -> None:
    done = run("plan", bag, bag, "--json", "-g", "pr2")
    documents = [json.loads(line) for line in done.out.splitlines()]
    assert len(documents) == 6
    for document in documents:
        assert document["sensor"] == {"position": None, "direction": [0, 0, 1], "known_from": "up"}
        assert [warning["code"] for warning in document["warnings"]] == ["sensor_unknown"]
        assert "--sensor" in document["warnings"][0]["text"]
    assert done.err.count(UPSIDE) == 1
    assert str(bag) in done.err


@pytest.mark.parametrize("command", [("cage", "--json"), ("compare", "--json")])
def test_other_commands_say_it_too(command: tuple[str, str], bag: Path, run: Run) -> None:
    name, form = command
    assert run(name, bag, form, "-g", "pr2").err.count(UPSIDE) == 1


def test_a_batch_says_it_once_and_keeps_it(bag: Path, run: Run) -> None:
    done = run("batch", bag, "--out", "results", "-j", "1", "-g", "pr2")
    assert done.err.count(UPSIDE) == 1
    documents = [json.loads(line) for line in next(Path("results").glob("plate*.jsonl")).read_text().splitlines()]
    assert [len(document["warnings"]) for document in documents] == [1, 1, 1]


@pytest.mark.parametrize(
    ("stated", "known_from", "side"),
    [("above", "option", -1), ("0.1,0.1,-0.4", "option", 1), ("none", "all_sides", -1)],
)
def test_what_is_stated_is_no_assumption(stated: str, known_from: str, side: int, bag: Path, run: Run) -> None:
    done = run("plan", bag, "--json", "-g", "pr2", "--count", "1", "--sensor", stated)
    document = json.loads(done.out)
    assert (done.code, done.err, document["warnings"]) == (0, "", [])
    assert document["sensor"]["known_from"] == known_from
    (position, pre_grasp) = (document["objects"][0]["grasps"][0][key]["position"] for key in ("pose", "pre_grasp"))
    assert np.sign(position[2] - pre_grasp[2]) == side


def test_inspect_says_what_is_known_of_the_sensor(bag: Path, run: Run) -> None:
    (cloud,) = json.loads(run("inspect", bag, "--json").out)["clouds"]
    assert cloud["sensor"]["known_from"] == "up"
    assert UPSIDE in cloud["warnings"][0]
    text = run("inspect", bag).out
    assert "sensor: toward 0.00 0.00 1.00, only the way up is known" in text
    assert "warning:" in text


CLOUD = SAMPLES / "juice_box.pcd"
OF_A_RECORDING = ("--topic", "/x", "--start", "5", "--end", "6")
OF_AN_IMAGE = ("--intrinsics", "525,525,319.5,239.5", "--depth-unit", "0.001", "--depth-axes", "optical")
ELSEWHERE = "only a recording has topics and times"
NO_IMAGE = "only depth images need a camera's intrinsics, unit and axes"


def ignored(document: dict[str, Any]) -> list[str]:
    """What a document says of options that changed nothing."""
    return [each["text"] for each in document["warnings"] if each["code"] == "option_ignored"]


def depth_image(path: Path) -> Path:
    np.save(path, np.full((480, 640), 500, dtype=np.uint16))
    return path


def test_options_that_are_nothing_to_a_source_are_told(bag: Path, tmp_path: Path, run: Run) -> None:
    nothing = "changed nothing: "
    image = depth_image(tmp_path / "image.npy")
    for source, options, said in (
        (CLOUD, OF_A_RECORDING, [f"--topic, --start, --end {nothing}{ELSEWHERE}"]),
        (CLOUD, ("--at", "5"), [f"--at {nothing}{ELSEWHERE}"]),
        (CLOUD, OF_AN_IMAGE, [f"--intrinsics, --depth-unit, --depth-axes {nothing}{NO_IMAGE}"]),
        (CLOUD, ("--count", "5", "--every", "2", "--strict"), []),  # hold of one cloud, too
        (bag, OF_AN_IMAGE, [f"--intrinsics, --depth-unit, --depth-axes {nothing}{NO_IMAGE}"]),
        (bag, ("--start", "0", "--topic", POINTS), []),
        (image, (*OF_AN_IMAGE, "--topic", "/x"), [f"--topic {nothing}{ELSEWHERE}"]),
        (image.parent, (*OF_AN_IMAGE, "--topic", "/x"), [f"--topic {nothing}{ELSEWHERE}"]),
    ):
        done = run("plan", source, "--json", "-g", "pr2", *options)
        assert done.out, done.err
        assert ignored(json.loads(done.out.splitlines()[0])) == said
        assert done.err.count("changed nothing") == len(said)


def test_defaults_and_options_of_a_batch_may_be_nothing_to_a_source(bag: Path, run: Run) -> None:
    Path("defaults.yaml").write_text("topic: /points\nintrinsics: [525, 525, 319.5, 239.5]\n", encoding="utf-8")
    assert ignored(json.loads(run("plan", CLOUD, "--json", "--config", "defaults.yaml").out)) == []
    done = run("batch", bag, CLOUD, "--out", "results", "-j", "1", "-g", "pr2", "--topic", POINTS)
    assert "changed nothing" not in done.err
    for path in Path("results").glob("*.jsonl"):
        assert [ignored(json.loads(line)) for line in path.read_text().splitlines()] in ([[]], [[]] * 3)


def test_options_of_a_request_are_told_and_those_of_its_process_are_not(run: Run) -> None:
    request = {"source": str(CLOUD), "options": {"start": 5}}
    done = run("serve", "--topic", "/x", stdin=(json.dumps(request) + "\n").encode())
    (answer,) = map(json.loads, done.out.splitlines())
    assert ignored(answer["documents"][0]) == [f"--start changed nothing: {ELSEWHERE}"]
