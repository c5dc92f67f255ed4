"""`flatgrasp plan` on scenes and with a robot: options, frames, refusals, and errors of one or two lines."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from flatgrasp_cli import load_camera_pose, load_robot, load_settings, read_clouds
from flatgrasp_cli.cli import run as run_here
from flatgrasp_cli.errors import ProfileError, UsageError
from flatgrasp_cli.geometry.frames import Frame, quaternion_from_axes
from flatgrasp_cli.model import CloudWarning
from flatgrasp_cli.placing import Route, Workcell, placed, workcell
from flatgrasp_cli.profiles import profile_path
from flatgrasp_cli.results.contracts import json_schema
from flatgrasp_cli.sources import Selection
from tests.conftest import MM, TABLE, Box, Camera, Solid

TABLE_AHEAD = Box((0.45, 0.0, -0.01), (0.9, 0.7, 0.02))
CAMERA = Camera(tilt_deg=20, target=(0.45, -0.1, 0.0), pixels=(260, 195), focal=340.0)
LEFT, RIGHT = Box((0.37, -0.10, 0.02), (0.10, 0.04, 0.04), 30), Box((0.53, -0.10, 0.03), (0.05, 0.15, 0.06))
FAR = replace(CAMERA, target=(1.6, 0.0, 0.0))


class Ended(NamedTuple):
    code: int
    out: str
    err: str

    @property
    def document(self) -> dict[str, Any]:
        """The one document on stdout, valid."""
        (line,) = self.out.splitlines()
        document: dict[str, Any] = json.loads(line, parse_constant=pytest.fail)
        Draft202012Validator(json_schema()).validate(document)
        return document


Run = Callable[..., Ended]


def recorded(path: Path, camera: Camera, *solids: Solid) -> Path:
    """A binary PCD in the camera's own optical frame."""
    points = camera.frame.to_local(camera.sees(*solids).points)
    header = (
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
        f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n"
    )
    path.write_bytes(header.encode() + points.astype("<f4").tobytes())
    return path


def pose_text(camera: Camera, *, in_base_link: bool = False) -> str:
    """`--camera-pose` of a camera whose frame is known in the robot's base."""
    frame = camera.frame
    turn = np.array([-1.0, -1.0, 1.0]) if in_base_link else np.ones(3)
    numbers = [*(frame.origin * turn), *quaternion_from_axes(frame.axes * turn)]
    return ",".join(f"{number:.9f}" for number in numbers)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("clouds")


@pytest.fixture(scope="module")
def scene(folder: Path) -> Path:
    """Two boxes on a table that a UR5 reaches."""
    return recorded(folder / "scene.pcd", CAMERA, TABLE_AHEAD, LEFT, RIGHT)


@pytest.fixture(scope="module")
def far(folder: Path) -> Path:
    """A box on a table, out of every arm's reach."""
    return recorded(
        folder / "far.pcd", FAR, Box((1.6, 0.0, -0.01), (0.9, 0.7, 0.02)), Box((1.6, 0.0, 0.02), (0.10, 0.04, 0.04))
    )


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Call `flatgrasp plan … --json --gripper pr2` in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: str | Path) -> Ended:
        monkeypatch.setattr(sys, "argv", ["flatgrasp", "plan", *map(str, arguments), "--json", "--gripper", "pr2"])
        capsys.readouterr()
        code = run_here()
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        assert list(tmp_path.iterdir()) == before
        return Ended(code, printed.out, printed.err)

    before = list(tmp_path.iterdir())
    return call


def best(document: dict[str, Any]) -> dict[str, Any]:
    grasp: dict[str, Any] = document["objects"][0]["grasps"][0]
    return grasp


class TestSceneOptions:
    def test_scene_object_plans_the_whole_cloud(self, scene: Path, run: Run) -> None:
        document = run(scene, "--scene", "object").document
        assert document["support_plane"] is None
        assert [item["points"] for item in document["objects"]] == [document["source"]["points"]]

    def test_scene_table_and_auto_find_both_boxes(self, scene: Path, run: Run) -> None:
        for mode in ("table", "auto"):
            done = run(scene, "--scene", mode)
            assert (done.code, done.err) == (0, "")
            assert len(done.document["objects"]) == 2
            assert done.document["settings"]["scene"]["mode"] == mode

    @pytest.mark.parametrize(("wanted", "x"), [("largest", 0.53), ("nearest", 0.53), ("0.36,-0.1", 0.37)])
    def test_object_plans_one(self, wanted: str, x: float, scene: Path, run: Run) -> None:
        document = run(scene, "--camera-pose", pose_text(CAMERA), "--object", wanted).document
        (item,) = document["objects"]
        assert item["obb"]["center"][0] == pytest.approx(x, abs=6 * MM)

    def test_a_place_on_no_object_is_no_grasp_and_told(self, scene: Path, run: Run) -> None:
        done = run(scene, "--camera-pose", pose_text(CAMERA), "--object", "360,-100")  # millimetres
        assert (done.code, done.document["objects"]) == (1, [])
        *_, reason, remedy = done.err.splitlines()
        assert "no grasp: no object lies at 360, -100: the nearest, object " in reason
        assert "--object X,Y is in metres" in remedy

    def test_crop_is_in_the_frame_of_the_answer(self, scene: Path, run: Run) -> None:
        document = run(scene, "--camera-pose", pose_text(CAMERA), "--crop", "0.1,0.46,-0.4,0.3,-0.1,0.3").document
        (item,) = document["objects"]
        assert item["obb"]["center"] == pytest.approx([0.37, -0.10, 0.02], abs=6 * MM)
        assert document["settings"]["scene"]["crop"] == [0.1, 0.46, -0.4, 0.3, -0.1, 0.3]

    def test_up_that_fits_no_plane_leaves_no_table(self, scene: Path, run: Run) -> None:
        done = run(scene, "--camera-pose", pose_text(CAMERA), "--scene", "table", "--up", "1,0,0")
        assert (done.code, done.document["reason"]) == (1, "no support plane was found")
        assert run(scene, "--camera-pose", pose_text(CAMERA), "--scene", "table", "--up", "0,0,1").code == 0

    def test_an_empty_table_is_exit_1_with_the_reason(self, folder: Path, run: Run) -> None:
        done = run(recorded(folder / "empty.pcd", CAMERA, TABLE), "--scene", "table")
        assert done.code == 1
        warning, reason, remedy = done.err.splitlines()
        assert "nothing says where the sensor was" in warning
        assert "nothing stands on the support plane" in reason
        assert "--up X,Y,Z" in remedy
        assert done.document["objects"] == []

    def test_the_same_run_gives_the_same_bytes(self, scene: Path, run: Run) -> None:
        texts = []
        for _ in range(2):
            document = run(scene, "--robot", "ur5", "--camera-pose", pose_text(CAMERA)).document
            assert set(document.pop("timing_ms")) == {"read", "scene", "plan", "total"}
            texts.append(json.dumps(document))
        assert texts[0] == texts[1]


class TestFrames:
    def test_a_camera_pose_gives_answers_in_the_base_frame(self, scene: Path, run: Run) -> None:
        document = run(scene, "--camera-pose", pose_text(CAMERA), "--object", "0.36,-0.1").document
        assert document["frame_id"] == "base"
        assert document["support_plane"]["normal"] == pytest.approx([0, 0, 1], abs=0.005)
        assert document["support_plane"]["offset_m"] == pytest.approx(0, abs=1 * MM)
        assert best(document)["pose"]["position"][2] == pytest.approx(
            load_settings().depth.table_clearance_m, abs=2 * MM
        )

    def test_a_file_that_names_no_frame_has_one_all_the_same(self, scene: Path, run: Run) -> None:
        document = run(scene).document
        assert document["frame_id"] == document["source"]["frame_id"] == "cloud"

    def test_the_base_frame_has_the_name_it_is_given(self, scene: Path, run: Run) -> None:
        document = run(scene, "--camera-pose", pose_text(CAMERA), "--base-frame", "world").document
        assert document["frame_id"] == document["source"]["frame_id"] == "world"

    def test_a_pose_from_a_file_is_the_same_pose(self, tmp_path: Path) -> None:
        text = pose_text(CAMERA)
        numbers = [float(number) for number in text.split(",")]
        file = tmp_path / "pose.yaml"
        file.write_text(f"position_m: {numbers[:3]}\norientation_xyzw: {numbers[3:]}\n", encoding="utf-8")
        assert load_camera_pose(str(file)) == load_camera_pose(text)

    def test_base_and_base_link_give_the_same_joints(self, scene: Path, run: Run) -> None:
        joints = []
        for frame in ("base", "base_link"):
            pose = pose_text(CAMERA, in_base_link=frame == "base_link")
            done = run(
                scene,
                "--robot",
                "ur5",
                "--camera-pose",
                pose,
                "--base-frame",
                frame,
                "--object",
                "0.53,-0.1" if frame == "base" else "-0.53,0.1",
            )
            assert (done.code, done.document["frame_id"], done.document["robot"]["base_frame"]) == (0, frame, frame)
            joints.append(best(done.document)["reach"]["joints_rad"]["grasp"])
        difference = np.abs(np.sin(np.array(joints[0]) - joints[1]))
        assert difference.max() < np.radians(2)

    def test_a_robots_own_camera_pose_counts_and_follows_the_base_frame(self, tmp_path: Path) -> None:
        x, y, z, *turn = (float(number) for number in pose_text(CAMERA).split(","))
        own = tmp_path / "mine.yaml"
        lines = profile_path("robot", "ur5").read_text(encoding="utf-8")
        pose = f"camera_pose: {{position_m: [{x}, {y}, {z}], orientation_xyzw: {turn}}}"
        own.write_text(lines.replace("camera_pose: null", pose), encoding="utf-8")
        arm = load_robot(str(own))
        base, linked = workcell(arm, None, None), workcell(arm, None, "base_link")
        assert base.camera is not None
        assert linked.camera is not None
        assert base.camera.position_m == (x, y, z)
        assert linked.camera.position_m == (-x, -y, z)
        assert linked.robot is not None
        assert linked.robot.base_frame == linked.base_frame == "base_link"
        given = workcell(arm, load_camera_pose("1,2,3,0,0,0,1"), None).camera
        assert given is not None
        assert given.position_m == (1, 2, 3)


class TestRobot:
    def test_a_reachable_scene_has_joints(self, scene: Path, run: Run) -> None:
        done = run(scene, "--robot", "ur5", "--camera-pose", pose_text(CAMERA))
        assert (done.code, done.err) == (0, "")
        reach = best(done.document)["reach"]
        assert reach["ok"]
        assert all(len(angles) == 6 for angles in reach["joints_rad"].values())

    def test_an_unreachable_scene_is_exit_1_and_names_the_limit(self, far: Path, run: Run) -> None:
        done = run(far, "--robot", "ur5", "--camera-pose", pose_text(FAR), "--approach", "top")
        assert done.code == 1
        document = done.document
        assert [line.split(": ")[2] for line in done.err.splitlines()] == ["no grasp", "remedy"]
        assert "ur5 reaches 0.85 m: is --camera-pose right?" in document["remedy"]
        (item,) = document["objects"]
        assert (document["status"], item["status"], item["grasps"]) == ("no_grasp", "no_grasp", [])
        assert item["refused"]
        assert {grasp["reach"]["limit"] for grasp in item["refused"]} == {"out of reach"}
        assert {grasp["reach"]["waypoint"] for grasp in item["refused"]} == {"pre_grasp"}
        assert "out of reach" in document["reason"]
        assert document["reason"] in done.err
        assert item["nearest_miss"]["stage"] == "reach"

    def test_a_camera_pose_that_tilts_the_table_is_told_in_a_sentence(self, scene: Path, run: Run) -> None:
        wrong = replace(CAMERA, tilt_deg=CAMERA.tilt_deg + 40)
        done = run(scene, "--robot", "ur5", "--camera-pose", pose_text(wrong))
        (warning,) = done.document["warnings"]
        assert warning["code"] == "table_tilted"
        assert "--camera-pose" in warning["text"]
        assert done.err.count(warning["text"]) == 1

    def test_without_a_camera_pose_it_asks_for_one(self, scene: Path, run: Run) -> None:
        done = run(scene, "--robot", "ur5")
        assert (done.code, done.out) == (2, "")
        assert len(done.err.splitlines()) <= 2
        assert "--camera-pose" in done.err
        assert "scene.pcd" in done.err

    def test_an_unknown_robot_lists_the_known(self, scene: Path, run: Run) -> None:
        done = run(scene, "--robot", "ur55")
        assert (done.code, done.out) == (2, "")
        assert "ur5" in done.err


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--crop", "1,2"], "scene.crop"),
        (["--crop", "a,b,c,d,e,f"], "scene.crop"),
        (["--crop", "1,0,0,1,0,1"], "scene.crop"),
        (["--crop", "0,1,0,1,0,.nan"], "scene.crop"),
        (["--crop", "0,1,0,1,0,1,5"], "scene.crop"),
        (["--crop", "none"], "scene.crop"),
        (["--crop", ""], "scene.crop"),
        (["--crop", "0,1,[0,1,0,1"], "scene.crop"),
        (["--up", "0,0,0"], "scene.up"),
        (["--up", "0,0"], "scene.up"),
        (["--up", "z"], "scene.up"),
        (["--up", "0,0,.inf"], "scene.up"),
        (["--object", "middle"], "scene.select"),
        (["--object", "1,b"], "scene.select"),
        (["--object", "1,2,3"], "scene.select"),
        (["--scene", "room"], "--scene"),
        (["--camera-pose", "1,2,3"], "camera pose"),
        (["--camera-pose", "0,0,a,0,0,0,1"], "camera pose"),
        (["--camera-pose", "0,0,0,0,0,0,2"], "camera pose"),
        (["--camera-pose", "0,0,nan,0,0,0,1"], "camera pose"),
        (["--camera-pose", "0,0,0,0,0,0,nan"], "camera pose"),
        (["--camera-pose", "nowhere.yaml"], "camera pose"),
        (["--camera-pose", ""], "camera pose"),
        (["--base-frame", "base"], "--camera-pose"),
        (["--robot", "ur5", "--camera-pose", "0,0,1,1,0,0,0", "--base-frame", "world"], "--base-frame"),
    ],
    ids=str,
)
def test_a_malformed_option_is_exit_2_and_a_line_or_two(options: list[str], word: str, scene: Path, run: Run) -> None:
    done = run(scene, *options)
    assert (done.code, done.out) == (2, "")
    assert word in done.err
    own = [line for line in done.err.splitlines() if not line.startswith(("Usage:", "Try ")) and line]
    assert 1 <= len(own) <= 2


class TestTheDoor:
    def test_nothing_named_leaves_the_cloud_as_it_is(self) -> None:
        cloud = CAMERA.sees(TABLE_AHEAD)
        assert workcell(None, None, None) == Workcell()
        assert placed(cloud, None, None) is cloud

    def test_a_robot_takes_a_cloud_in_its_own_base_frame(self) -> None:
        cloud = replace(CAMERA.sees(TABLE_AHEAD), frame_id="base")
        own, linked = workcell(load_robot("ur5"), None, None), workcell(load_robot("ur5"), None, "/base_link")
        assert placed(cloud, own.base_frame, own.camera) is cloud
        with pytest.raises(UsageError, match="base_link"):
            placed(cloud, linked.base_frame, linked.camera)

    def test_a_frame_without_a_name_is_called_as_in_the_document(self) -> None:
        cloud = CAMERA.sees(TABLE_AHEAD)
        with pytest.raises(UsageError, match="in frame 'cloud', the answer is wanted in 'base'"):
            placed(cloud, "base", None)
        assert placed(cloud, "cloud", None) is cloud

    def test_a_camera_pose_without_a_robot_is_one_in_base(self) -> None:
        pose = load_camera_pose("1,2,3,0,0,0,1")
        assert workcell(None, pose, None) == Workcell(None, pose, "base")
        assert workcell(None, pose, "world").base_frame == "world"

    def test_transforms_are_asked_only_where_no_pose_is_stated(self) -> None:
        cloud = replace(CAMERA.sees(TABLE_AHEAD), frame_id="eye")
        doubt = CloudWarning("transform_changed", "it moved")
        asked = []

        def lookup(target: str, source: str) -> Route:
            asked.append((target, source))
            return Route(Frame(np.array([1.0, 2.0, 3.0]), np.eye(3)), (doubt,))

        pose = load_camera_pose("4,5,6,0,0,0,1")
        np.testing.assert_allclose(placed(cloud, "base", pose, lookup).points, cloud.points + np.array([4, 5, 6]))
        assert asked == []
        moved = placed(cloud, "base", None, lookup)
        assert asked == [("base", "eye")]
        assert (moved.frame_id, moved.warnings[-1]) == ("base", doubt)
        np.testing.assert_allclose(moved.points, cloud.points + np.array([1, 2, 3]))

    def test_files_go_through_it_too(self, scene: Path) -> None:
        (own,) = read_clouds(scene)
        pose = load_camera_pose("0,0,1,0,0,0,1")
        (raised,) = read_clouds(scene, selection=Selection(base_frame="base", camera_pose=pose))
        np.testing.assert_allclose(raised.points, own.points + np.array([0, 0, 1]))
        with pytest.raises(UsageError, match="--camera-pose"):
            next(read_clouds(scene, selection=Selection(base_frame="base")))

    def test_a_quaternion_must_be_one(self) -> None:
        with pytest.raises(ProfileError, match="unit quaternion"):
            load_camera_pose("0,0,0,1,1,0,0")
