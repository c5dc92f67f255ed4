"""The scripts of docs/examples drive a robot to the flange's poses; ROS's modules are stood in for."""

from __future__ import annotations

import json
import re
import runpy
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_robot, load_settings, plan, to_document
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.job import Job
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.placing import Workcell
from flatgrasp_cli.robot import forward
from flatgrasp_cli.serving import Answerer
from tests.conftest import Box, Camera
from tests.robot.arms import rows

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "docs" / "examples"
UR5 = load_robot("ur5")
Example = Callable[[str], None]


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    cloud = Camera(tilt_deg=20, target=(0.45, -0.1, 0.0)).sees(
        Box((0.45, 0.0, -0.01), (0.9, 0.7, 0.02)), Box((0.45, -0.1, 0.02), (0.10, 0.04, 0.04), 30)
    )
    return to_document(plan(Cloud(cloud.points, cloud.viewpoint, frame_id="base"), load_gripper("pr2"), robot=UR5))


@pytest.fixture
def example(document: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Example:
    """Runs an example on the document."""
    path = tmp_path / "table.grasps.json"
    path.write_text(json.dumps(document), encoding="utf-8")

    def run(name: str) -> None:
        monkeypatch.setattr(sys, "argv", [name, str(path)])
        runpy.run_path(str(EXAMPLES / name))

    return run


def turned_by(vector: FloatArray) -> FloatArray:
    """Rotation (3, 3) about an axis by its length in radians: Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def test_the_ur_script_goes_where_the_joints_of_the_plan_go(
    example: Example, document: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    example("ur_script.py")
    lines = capsys.readouterr().out.splitlines()
    commands = [re.split(r"\W", line.strip())[0] for line in lines]
    assert commands == ["def", "set_tcp", "movej", "movel", "movel", "movel", "end"]
    joints = document["objects"][0]["grasps"][0]["reach"]["joints_rad"]
    assert f"movej({joints['pre_grasp']})" in lines[2]
    for line, name in zip(lines[3:6], ("grasp", "pre_grasp", "lift"), strict=True):
        found = re.search(r"movel\(p(\[.*?\]), a=", line)
        assert found is not None
        numbers = np.array(json.loads(found.group(1)))
        flange = forward(rows(UR5), np.array(joints[name]))[5]
        assert numbers[:3] == pytest.approx(flange[:3, 3], abs=1e-6)
        assert turned_by(numbers[3:]) == pytest.approx(flange[:3, :3], abs=1e-6)
        assert np.linalg.norm(numbers[3:]) <= np.pi + 1e-9


@pytest.mark.parametrize("change", [{"frame_id": "base_link"}, {"robot": None}])
def test_the_ur_script_refuses_poses_in_another_frame(
    change: dict[str, Any], document: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "other.json"
    path.write_text(json.dumps(document | change), encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["ur_script.py", str(path)])
    with pytest.raises(SystemExit, match="--base-frame base"):
        runpy.run_path(str(EXAMPLES / "ur_script.py"))


@pytest.mark.parametrize("name", ["ur_script.py", "ros2_publisher.py", "moveit_goal.py"])
def test_without_a_grasp_an_example_says_so(
    name: str, document: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ros: Recorder
) -> None:
    path = tmp_path / "none.json"
    path.write_text(
        json.dumps(document | {"status": "no_grasp", "reason": "too wide", "objects": []}), encoding="utf-8"
    )
    monkeypatch.setattr(sys, "argv", [name, str(path)])
    with pytest.raises(SystemExit, match="no grasp: too wide"):
        runpy.run_path(str(EXAMPLES / name))
    assert ros.calls == {}


class Message(SimpleNamespace):
    """A ROS message made of its fields; an array of poses begins empty."""

    poses: list[Any]

    def __init__(self, **fields: Any) -> None:
        super().__init__(**({"poses": []} | fields))


class Recorder:
    """Takes any call on anything, and keeps its arguments by the name of what was called."""

    def __init__(self) -> None:
        self.calls: dict[str, tuple[tuple[Any, ...], dict[str, Any]]] = {}
        self.trajectory = "the trajectory"

    def __getattr__(self, name: str) -> Any:
        def call(*arguments: Any, **named: Any) -> Recorder:
            self.calls[name] = (arguments, named)
            return self

        return call


@pytest.fixture
def ros(monkeypatch: pytest.MonkeyPatch) -> Recorder:
    """ROS's modules as far as the examples use them; all their objects are one recorder."""
    recorder = Recorder()
    messages = dict.fromkeys(("Point", "Pose", "PoseArray", "PoseStamped", "Quaternion", "Header"), Message)
    contents: dict[str, dict[str, Any]] = {
        "geometry_msgs": {},
        "geometry_msgs.msg": messages,
        "std_msgs": {},
        "std_msgs.msg": messages,
        "rclpy": {name: getattr(recorder, name) for name in ("init", "create_node", "spin")},
        "rclpy.qos": {
            "QoSProfile": Message,
            "DurabilityPolicy": SimpleNamespace(TRANSIENT_LOCAL=1),
            "ReliabilityPolicy": SimpleNamespace(BEST_EFFORT=1),
        },
        "sensor_msgs": {},
        "sensor_msgs.msg": {"PointCloud2": Message},
        "sensor_msgs_py": {},
        "sensor_msgs_py.point_cloud2": {"read_points_numpy": lambda cloud, _: cloud.points},
        "moveit": {},
        "moveit.planning": {"MoveItPy": lambda **_: recorder},
    }
    for name, values in contents.items():
        module = ModuleType(name)
        vars(module).update(values)
        monkeypatch.setitem(sys.modules, name, module)
    return recorder


def check(message: Any, expected: dict[str, Any]) -> None:
    """A ROS pose is that of the document."""
    place, turn = message.position, message.orientation
    assert [place.x, place.y, place.z] == expected["position"]
    assert axes_from_quaternion(np.array([turn.x, turn.y, turn.z, turn.w])) == pytest.approx(
        axes_from_quaternion(np.array(expected["orientation"]))
    )


def test_ros_2_gets_the_three_poses(example: Example, document: dict[str, Any], ros: Recorder) -> None:
    example("ros2_publisher.py")
    (message,), _ = ros.calls["publish"]
    assert message.header.frame_id == "base"
    flange = document["objects"][0]["grasps"][0]["flange"]
    assert len(message.poses) == 3
    for pose, name in zip(message.poses, ("pre_grasp", "pose", "lift"), strict=True):
        check(pose, flange[name])


def test_moveit_gets_the_pose_before_the_grasp_for_the_flange(
    example: Example, document: dict[str, Any], ros: Recorder
) -> None:
    example("moveit_goal.py")
    _, goal = ros.calls["set_goal_state"]
    assert goal["pose_link"] == "tool0"
    assert goal["pose_stamped_msg"].header.frame_id == "base"
    check(goal["pose_stamped_msg"].pose, document["objects"][0]["grasps"][0]["flange"]["pre_grasp"])
    assert ros.calls["execute"] == (("the trajectory",), {"controllers": []})


class Lines:
    """A socket's file at whose other end a process plans; it keeps what came last."""

    def __init__(self) -> None:
        self._answerer = Answerer(lambda _: Job(load_gripper("pr2"), load_settings(), Workcell()))
        self.asked = self.said = ""

    def makefile(self, mode: str) -> Lines:
        assert mode == "rw"
        return self

    def write(self, text: str) -> None:
        self.asked += text

    def flush(self) -> None:
        self.said, self.asked = self._answerer.answer(self.asked.encode()), ""

    def readline(self) -> str:
        return self.said


def test_a_ros_2_node_asks_a_process_that_stays(ros: Recorder, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = Lines()
    monkeypatch.setattr("socket.create_connection", lambda _: lines)
    runpy.run_path(str(EXAMPLES / "ros2_node.py"))
    ros.calls.pop("publish", None)
    (_, topic, plan_on, _), _ = ros.calls["create_subscription"]
    cloud = Camera(tilt_deg=20, target=(0.45, -0.1, 0.0)).sees(
        Box((0.45, 0.0, -0.01), (0.9, 0.7, 0.02)), Box((0.45, -0.1, 0.02), (0.10, 0.04, 0.04), 30)
    )
    plan_on(SimpleNamespace(header="header", width=len(cloud.points), height=1, points=cloud.points))
    (message,), _ = ros.calls["publish"]
    assert (topic, message.header) == ("points", "header")
    check(message.pose, json.loads(lines.said)["documents"][0]["objects"][0]["grasps"][0]["flange"]["pose"])
    nothing = SimpleNamespace(header="header", width=1, height=1, points=np.full((1, 3), np.nan))
    plan_on(nothing)
    assert "no point of the cloud" in ros.calls["warn"][0][0]


def test_what_the_readme_shows_of_them_is_theirs() -> None:
    blocks = re.findall(r"```py\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), flags=re.DOTALL)
    texts = [path.read_text(encoding="utf-8") for path in EXAMPLES.glob("*.py")]
    assert [block for block in blocks if not any(block in text for text in texts)] == []
