"""Tables for people: 80 columns, no number cut; progress on a terminal only."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from mcap.writer import Writer

from flatgrasp_cli import load_gripper, load_robot, load_settings, plan, read_clouds
from flatgrasp_cli.results.table import grasp_table
from tests.conftest import SAMPLES, Run

SCENE = SAMPLES / "table_scene.pcd"
POSE = "0.4,-0.5,0.7,1,0,0,0"
COMMANDS = {
    "plan": ("plan", SCENE, "--plots", "none"),
    "robot": ("plan", SCENE, "--plots", "none", "--robot", "ur5e", "--camera-pose", POSE, "--gripper", "pr2"),
    "cage": ("cage", SAMPLES / "pan.pcd"),
    "compare": ("compare", SAMPLES / "pan.pcd", SAMPLES / "juice_box.pcd"),
    "inspect": ("inspect", SAMPLES / "pan_ros1.bag", SAMPLES / "pan_ros2", SAMPLES / "pan.pcd"),
    "profiles": ("profiles", "list"),
    "doctor": ("doctor",),
}
NUMBER = re.compile(r"-?\d+\.\d+")


@pytest.fixture(autouse=True)
def no_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a pipe, whatever the developer's terminal says."""
    monkeypatch.delenv("COLUMNS", raising=False)


@pytest.mark.parametrize("arguments", COMMANDS.values(), ids=COMMANDS)
def test_in_a_pipe_tables_have_80_columns(arguments: tuple[str, ...], run: Run) -> None:
    done = run(*arguments)
    assert done.code == 0
    assert max(map(len, done.out.splitlines())) <= 80


@pytest.mark.parametrize("arguments", COMMANDS.values(), ids=COMMANDS)
def test_no_number_is_cut_however_narrow_it_is(
    arguments: tuple[str, ...], run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    wide = run(*arguments)
    monkeypatch.setenv("COLUMNS", "30")
    narrow = run(*arguments)
    assert NUMBER.findall(narrow.out) == NUMBER.findall(wide.out)


def test_a_sources_name_is_broken_only_where_it_takes_too_much_room(run: Run, tmp_path: Path) -> None:
    long = tmp_path / f"{'a_long_name_' * 4}.pcd"
    long.write_bytes((SAMPLES / "juice_box.pcd").read_bytes())
    assert any(
        line.startswith("electric_drill.pcd ")
        for line in run("compare", SAMPLES / "electric_drill.pcd").out.splitlines()
    )
    assert max(map(len, run("compare", long).out.splitlines())) <= 80


def test_long_names_of_topics_are_broken_in_80_columns(tmp_path: Path, run: Run) -> None:
    long = "/a_camera/depth_and_colour/registered/of_all_points/at_once"
    path = tmp_path / "long.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("a_package_of_ours/msg/WithAQuiteLongName", "jsonschema", b"{}")
        channel = writer.register_channel(long, "json", schema)
        writer.add_message(channel, log_time=1, data=b"{}", publish_time=1)
        writer.finish()  # type: ignore[no-untyped-call]
    lines = run("inspect", path).out.splitlines()
    assert max(map(len, lines)) <= 80
    head = next(line for line in lines if line.startswith("topic"))
    assert long in "".join(line[: head.index("type")].strip() for line in lines)


def test_a_grasp_is_one_line_of_what_the_document_says(run: Run) -> None:
    aloof = "hand.clearance_m=0.025"
    done = run("plan", SCENE, "--plots", "none", "--gripper", "pr2", "--approach", "top", "--set", aloof)
    settings = load_settings("default", ("approach.directions=top", aloof))
    (result,) = [plan(cloud, load_gripper("pr2"), settings) for cloud in read_clouds(SCENE)]
    first, item, grasp = done.out.splitlines(), result.objects[0], result.objects[0].grasps[0]
    assert first[0] == f"{SCENE} · pr2: two fingers on an arc" or first[0] == str(SCENE)
    best = next(line for line in first if line.split()[:2] == [str(item.object.id), "1"])
    assert grasp.success is not None
    holds, *words = best.split()[2:]
    assert holds == f"{100 * grasp.success.probability:.0f}"
    numbers = [1e3 * grasp.width_m, 1e3 * grasp.opening_m, *grasp.position]
    assert [float(word) for word in words] == pytest.approx(numbers, abs=0.051)
    refused = result.objects[-1]
    assert refused.rejection is not None
    assert f"object {refused.object.id}: no grasp: {refused.rejection.reason[:20]}" in done.out


def test_the_default_hand_is_named_first(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(SAMPLES)
    done = run("plan", "juice_box.pcd", "--plots", "none", "--out", tmp_path)
    assert done.out.splitlines()[0] == "juice_box.pcd · lacquey: thumb and finger pair"


def test_joints_are_in_the_table_in_degrees() -> None:
    (cloud,) = read_clouds(SCENE)
    table = grasp_table(plan(cloud, load_gripper("pr2"), robot=load_robot("ur10e")), wide=True)
    assert str(table.columns[-1].header).startswith("joints")


def test_seven_joints_have_room(run: Run) -> None:
    pytest.importorskip("eaik")
    done = run("plan", SCENE, "--plots", "none", "--robot", "franka_fr3", "--camera-pose", POSE, "--object", "largest")
    lines = done.out.splitlines()
    assert max(map(len, lines)) <= 80
    assert len(next(line for line in lines if line.split()[1:2] == ["1"]).split()) == 4 + 3 + 7
    assert not any("needs" in line for line in lines)


def test_wide_tables_say_the_rest(run: Run) -> None:
    done = run("plan", SCENE, "--plots", "none", "--wide")
    assert "force balance" in done.out
    assert max(map(len, done.out.splitlines())) > 80


class TestProgress:
    @pytest.fixture
    def terminal(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """stderr takes itself for a terminal, also while rich stands in for it."""
        monkeypatch.setattr("flatgrasp_cli.cli.progress.on_terminal", lambda: True)
        monkeypatch.setenv("TTY_COMPATIBLE", "1")

    @pytest.mark.usefixtures("terminal")
    def test_many_frames_show_where_it_is(self, run: Run) -> None:
        done = run("plan", SAMPLES / "pan_ros2", "--json", "--gripper", "pr2")
        assert "frame 3" in done.err
        assert len(done.out.splitlines()) == 3
        assert "\x1b" not in done.out

    @pytest.mark.usefixtures("terminal")
    def test_many_sources_are_counted(self, run: Run) -> None:
        done = run("plan", SAMPLES / "pan.pcd", SAMPLES / "juice_box.pcd", "--json")
        assert "source 2 of 2" in done.err

    @pytest.mark.usefixtures("terminal")
    def test_one_frame_shows_none(self, run: Run) -> None:
        assert "frame" not in run("plan", SAMPLES / "juice_box.pcd", "--json").err

    def test_a_pipe_sees_none(self, run: Run) -> None:
        assert not sys.stderr.isatty()
        assert "\x1b" not in run("plan", SAMPLES / "pan_ros2", "--json").err
