"""Bags of plans, read back by rosbags and by mcap: the poses, stamps and frames of the source."""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability
from rosbags.typesys import Stores, get_typestore

from flatgrasp_cli import load_gripper
from flatgrasp_cli.cli.bag_options import DISTROS
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.results.document import to_document, to_json
from flatgrasp_cli.results.exports.bag import CLOUD, DOCUMENT, GRASPS, MARKERS, PRE_GRASPS, TF_STATIC, Bag
from flatgrasp_cli.results.saved import SavedDocument
from tests.conftest import SAMPLES, Run, planned_sample

EXACT = 1e-9
RECORDING = SAMPLES / "pan_ros2"
REAL = Path(__file__).resolve().parents[3] / "shared" / "data" / "recordings" / "pct_three_clouds.mcap"
BAGS = ("out.mcap", "out", "out.bag")
TOPICS = {CLOUD, GRASPS, PRE_GRASPS, MARKERS, DOCUMENT, TF_STATIC}


@dataclass(frozen=True)
class Logged:
    """A message and when it was logged."""

    topic: str
    logged_ns: int
    message: Any


def read(path: Path) -> list[Logged]:
    """What rosbags reads, by the definitions in the bag itself."""
    with AnyReader([path]) as reader:
        return [
            Logged(connection.topic, logged, reader.deserialize(raw, connection.msgtype))
            for connection, logged, raw in reader.messages()
        ]


def of(topic: str, found: list[Logged]) -> list[Logged]:
    return [each for each in found if each.topic == topic]


def numbers(pose: Any) -> list[float]:
    place, turn = pose.position, pose.orientation
    return [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w]


def stamp_of(header: Any) -> int:
    return int(header.stamp.sec * 10**9 + header.stamp.nanosec)


def poses_of(document: dict[str, Any], name: str) -> list[list[float]]:
    grasps = [grasp for item in document["objects"] for grasp in item["grasps"]]
    return [grasp[name]["position"] + grasp[name]["orientation"] for grasp in grasps]


def check_poses(path: Path, documents: list[dict[str, Any]]) -> None:
    """Hold the poses, stamps and frames of a bag against the documents."""
    found = read(path)
    assert {each.topic for each in found} == TOPICS
    for topic, name in ((GRASPS, "pose"), (PRE_GRASPS, "pre_grasp")):
        arrays = [each.message for each in of(topic, found)]
        assert [stamp_of(array.header) for array in arrays] == [each["source"]["stamp_ns"] for each in documents]
        for array, document in zip(arrays, documents, strict=True):
            assert array.header.frame_id == document["frame_id"]
            expected = np.array(poses_of(document, name))
            assert len(expected) > 0
            assert np.array([numbers(pose) for pose in array.poses]) == pytest.approx(expected, abs=EXACT)
    assert [json.loads(each.message.data) for each in of(DOCUMENT, found)] == documents


@pytest.mark.parametrize("name", BAGS)
def test_a_bag_has_the_poses_of_the_recording_it_was_made_of(name: str, run: Run) -> None:
    done = run("plan", RECORDING, "--json", "--bag", name)
    assert (done.code, done.err) == (0, f"flatgrasp: wrote {name}\n")
    check_poses(Path(name), [json.loads(line) for line in done.out.splitlines()])
    assert [path.name for path in Path().iterdir()] == [name]


@pytest.mark.skipif(not REAL.exists(), reason="needs the shared recordings")
@pytest.mark.parametrize("name", BAGS)
def test_a_real_recording_plays_beside_its_bag(name: str, run: Run) -> None:
    done = run("plan", REAL, "--json", "-g", "robotiq_2f_85", "--approach", "top", "--bag", name)
    documents = [json.loads(line) for line in done.out.splitlines()]
    check_poses(Path(name), documents)
    original = [each.logged_ns for each in read(REAL) if each.topic == "/point_cloud"]
    assert [each.logged_ns for each in of(CLOUD, read(Path(name)))] == original
    assert original[0] != documents[0]["source"]["stamp_ns"]  # the messages' own clock is another


def test_mcap_with_ros_2_reads_the_same(run: Run) -> None:
    done = run("plan", RECORDING, "--json", "--bag", "out.mcap", "--ros-distro", "humble")
    documents = [json.loads(line) for line in done.out.splitlines()]
    with Path("out.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = [
            Logged(channel.topic, message.log_time, decoded)
            for _, channel, message, decoded in reader.iter_decoded_messages()
        ]
    assert {each.topic for each in found} == TOPICS
    for topic, name in ((GRASPS, "pose"), (PRE_GRASPS, "pre_grasp")):
        arrays = of(topic, found)
        assert [each.logged_ns for each in arrays] == [document["source"]["stamp_ns"] for document in documents]
        for each, document in zip(arrays, documents, strict=True):
            back = [numbers(pose) for pose in each.message.poses]
            assert np.array(back) == pytest.approx(np.array(poses_of(document, name)), abs=EXACT)


def write(path: Path, distro: str = "jazzy") -> SavedDocument:
    """A bag of the table's scene, with colours."""
    plan = planned_sample("table_scene", "robotiq_2f_85")
    cloud = plan.cloud
    shade = np.arange(len(cloud.points)) % 256
    colors = np.column_stack([shade, 255 - shade, np.full(len(shade), 7)]).astype(np.uint8)
    text = to_json(to_document(plan))
    document = SavedDocument.model_validate_json(text)
    with Bag.open(path, distro) as bag:
        bag.add(document, text, type(cloud)(cloud.points, colors=colors))
    return document


@pytest.fixture(scope="session")
def colored(tmp_path_factory: pytest.TempPathFactory) -> tuple[SavedDocument, dict[str, Any]]:
    """The document of a scene, and its messages by topic."""
    path = tmp_path_factory.mktemp("bags") / "scene.mcap"
    document = write(path)
    return document, {each.topic: each.message for each in read(path)}


def test_the_cloud_has_a_point_each_three_millimetres_and_its_colors(
    colored: tuple[SavedDocument, dict[str, Any]],
) -> None:
    cloud = colored[1][CLOUD]
    values = cloud.data.view("<f4").reshape(-1, 4)
    points = planned_sample("table_scene", "robotiq_2f_85").cloud.points
    original = points.astype(np.float32)
    rows = {point.tobytes(): k for k, point in enumerate(original)}
    taken = [rows[point.tobytes()] for point in values[:, :3].copy()]
    cubes = [tuple(cube) for cube in np.floor(points / 3e-3).tolist()]
    assert sorted(cubes[k] for k in taken) == sorted(set(cubes))
    shade = np.array(taken) % 256
    assert np.array_equal(values[:, 3].copy().view("<u4"), (shade << 16) | ((255 - shade) << 8) | 7)
    assert [field.name for field in cloud.fields] == ["x", "y", "z", "rgb"]
    assert (cloud.width, cloud.row_step) == (len(values), cloud.data.size)


def test_markers_draw_the_open_hand_the_outlines_and_the_numbers(
    colored: tuple[SavedDocument, dict[str, Any]],
) -> None:
    document, messages = colored
    first, *drawn = messages[MARKERS].markers
    assert first.action == 3  # whatever was drawn of the frame before goes
    assert len({(marker.ns, marker.id) for marker in drawn}) == len(drawn)
    for item in document.objects:
        assert item.silhouette is not None
        hand = [marker for marker in drawn if marker.ns == f"object {item.id}: hand"]
        assert len(hand) == (3 if item.grasps else 0)
        lines = [marker for marker in drawn if marker.ns == f"object {item.id}: outline"]
        assert [len(line.points) for line in lines] == [len(loop) + 1 for loop in item.silhouette.loops]
        assert [marker.text for marker in drawn if marker.ns == f"object {item.id}: number"] == [str(item.id)]
        if item.grasps:
            minus, plus, _palm = (np.array(numbers(marker.pose)[:3]) for marker in hand)
            grasp = item.grasps[0]
            apart = grasp.opening_m + load_gripper("robotiq_2f_85").finger_thickness_m
            assert np.linalg.norm(plus - minus) == pytest.approx(apart)


def test_the_best_grasps_frames_are_looked_up_by_name(colored: tuple[SavedDocument, dict[str, Any]]) -> None:
    document, messages = colored
    best = document.objects[0].grasps[0]
    transforms = {each.child_frame_id: each for each in messages[TF_STATIC].transforms}
    assert set(transforms) == {f"flatgrasp/{name}" for name in ("pre_grasp", "grasp", "lift", "flange")}
    place = transforms["flatgrasp/grasp"].transform.translation
    assert [place.x, place.y, place.z] == list(best.pose.position)
    assert {each.header.frame_id for each in transforms.values()} == {"cloud"}


def test_frames_without_a_time_come_in_order(colored: tuple[SavedDocument, dict[str, Any]]) -> None:
    header = colored[1][GRASPS].header
    assert (header.stamp.sec, header.stamp.nanosec, header.frame_id) == (1, 0, "cloud")


def test_transforms_are_kept_for_whoever_comes_later(tmp_path: Path) -> None:
    write(tmp_path / "two")
    write(tmp_path / "one.bag", distro="noetic")
    for path in (tmp_path / "two", tmp_path / "one.bag"):
        with AnyReader([path]) as reader:
            kept = {each.topic for each in reader.connections if is_kept(each.ext)}
        assert kept == {TF_STATIC}


def is_kept(ext: Any) -> bool:
    if hasattr(ext, "latching"):
        return bool(ext.latching)
    return any(qos.durability == QosDurability.TRANSIENT_LOCAL for qos in ext.offered_qos_profiles)


@pytest.mark.parametrize("distro", [name for name in DISTROS if name != "noetic"])
def test_every_distributions_definitions_are_written(distro: str, tmp_path: Path) -> None:
    write(tmp_path / "out", distro=distro)
    store = get_typestore(getattr(Stores, f"ROS2_{distro.upper()}"))
    with AnyReader([tmp_path / "out"], default_typestore=store) as reader:
        (connection,) = (each for each in reader.connections if each.topic == MARKERS)
        (raw,) = (raw for _, _, raw in reader.messages([connection]))
    message: Any = store.deserialize_cdr(raw, "visualization_msgs/msg/MarkerArray")
    assert len(message.markers) > 4


def test_what_is_there_already_is_never_overwritten(tmp_path: Path, run: Run) -> None:
    shutil.copytree(RECORDING, tmp_path / "recording")
    before = sorted((path.name, path.stat().st_size) for path in (tmp_path / "recording").iterdir())
    for command in (("plan",), ("batch", "--out", tmp_path / "out")):
        done = run(*command, RECORDING, "--bag", tmp_path / "recording")
        assert (done.code, done.out) == (2, "")
        assert "is there already" in done.err
    assert sorted((path.name, path.stat().st_size) for path in (tmp_path / "recording").iterdir()) == before
    with pytest.raises(UsageError, match="is there already"):
        leave_empty(tmp_path / "recording", "jazzy")


def leave_open(path: Path, distro: str) -> None:
    with Bag.open(path, distro) as bag:
        bag.add(SavedDocument.model_validate_json(to_json(to_document(planned_sample("pan")))), "{}", None)
        raise KeyError


def leave_empty(path: Path, distro: str) -> None:
    with Bag.open(path, distro):
        pass


@pytest.mark.parametrize("name", BAGS)
def test_a_bag_is_whole_or_not_there(name: str, tmp_path: Path) -> None:
    distro = "noetic" if name.endswith(".bag") else "jazzy"
    with pytest.raises(KeyError):
        leave_open(tmp_path / name, distro)
    assert list(tmp_path.iterdir()) == []
    leave_empty(tmp_path / name, distro)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(UsageError, match="cannot be written"):
        leave_empty(Path("/proc/nowhere") / name, distro)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--bag", "out.bag", "--ros-distro", "humble"), "is a ROS 1 bag"),
        (("--bag", "out.mcap", "--ros-distro", "noetic"), "is a bag of ROS 2"),
        (("--ros-distro", "humble"), "give --bag OUT"),
    ],
)
def test_options_that_contradict_each_other_are_refused(options: tuple[str, ...], words: str, run: Run) -> None:
    done = run("plan", SAMPLES / "pan.pcd", *options)
    assert (done.code, done.out) == (2, "")
    assert words in done.err


def test_a_batch_writes_one_bag_of_all_its_inputs(run: Run) -> None:
    call = ("batch", RECORDING, SAMPLES / "pan.pcd", "--out", "results", "--bag", "out.mcap", "--jobs", "1")
    done = run(*call)
    assert (done.code, "wrote out.mcap" in done.err) == (0, True)
    paths = sorted(Path("results").glob("pan*.jsonl"))
    lines = [line for path in paths for line in path.read_text(encoding="utf-8").splitlines()]
    found = read(Path("out.mcap"))
    back = [json.loads(each.message.data) for each in of(DOCUMENT, found)]
    assert sorted(map(str, back)) == sorted(str(json.loads(line)) for line in lines)
    assert len(of(CLOUD, found)) == 4
    state = Path("out.mcap").stat()
    assert run(*call).code == 0
    assert Path("out.mcap").stat() == state
