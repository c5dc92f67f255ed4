"""Defaults: the command line beats the environment, the environment a file, a file what is built in."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import EACH, SAMPLES, Ended, Run

BOX = SAMPLES / "juice_box.pcd"


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder of settings."""
    folder = tmp_path / "config"
    folder.mkdir()
    monkeypatch.setenv("XDG_CONFIG_HOME", str(folder))
    return folder


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def document(done: Ended) -> dict[str, Any]:
    assert done.code == 0
    answer: dict[str, Any] = json.loads(done.out)
    return answer


def test_the_command_line_beats_the_environment_and_that_the_file(
    home: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def found(*options: str) -> tuple[str, int]:
        answer = document(run("plan", BOX, "--json", "--set", EACH[0], *options))
        return answer["gripper"]["name"], len(answer["objects"][0]["grasps"])

    assert found() == ("lacquey", 10)
    written(home / "flatgrasp.yaml", "gripper: pr2\ntop: 3\n")
    assert found() == ("pr2", 3)
    monkeypatch.setenv("FLATGRASP_TOP", "2")
    assert found() == ("pr2", 2)
    assert found("--top", "1") == ("pr2", 1)
    assert found("--gripper", "wsg_50") == ("wsg_50", 2)


def test_a_named_file_stands_in_for_the_users_own(home: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    written(home / "flatgrasp.yaml", "gripper: pr2\ntop: 3\n")
    lab = written(home / "lab.yaml", "gripper: wsg_50\n")
    answer = document(run("plan", BOX, "--json", "--config", lab, "--set", EACH[0]))
    assert (answer["gripper"]["name"], len(answer["objects"][0]["grasps"])) == ("wsg_50", 10)
    monkeypatch.setenv("FLATGRASP_CONFIG", str(lab))
    assert document(run("plan", BOX, "--json"))["gripper"]["name"] == "wsg_50"
    assert document(run("plan", BOX, "--json", "--config", os.devnull))["gripper"]["name"] == "lacquey"


def test_settings_add_up_and_the_nearest_word_wins(home: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    written(
        home / "flatgrasp.yaml",
        "set:\n  fingers: {step_m: 0.004}\n  depth.approach_m: 0.05\n  ranking: {prefer: cage}\n  seed: 7\n",
    )
    monkeypatch.setenv("FLATGRASP_SET", "seed=8 balance.friction=0.4")
    settings = document(run("plan", BOX, "--json", "--prefer", "success", "--set", "balance.friction=0.3"))["settings"]
    assert (settings["fingers"]["step_m"], settings["depth"]["approach_m"]) == (0.004, 0.05)
    assert (settings["seed"], settings["balance"]["friction"], settings["ranking"]["prefer"]) == (8, 0.3, "success")


def test_any_option_may_be_in_the_file(home: Path, run: Run) -> None:
    written(home / "mine.yaml", (SAMPLES.parent / "configs/grippers/pr2.yaml").read_text(encoding="utf-8"))
    written(home / "cell.yaml", "position_m: [0.4, -0.5, 0.7]\norientation_xyzw: [1.0, 0.0, 0.0, 0.0]\n")
    written(
        home / "flatgrasp.yaml",
        "gripper: ./mine.yaml\nrobot: ur10e\ncamera_pose: cell.yaml\nscene: table\nup: [0, 0.64, 0.77]\n"
        "every: 1\ncrop: null\nplan:\n  json: true\n  top: 2\nbatch: {jobs: 1, plots: true}\ncage:\n",
    )
    answer = document(run("plan", SAMPLES / "table_scene.pcd", "--count", "1"))
    assert (answer["gripper"]["name"], answer["robot"]["name"], answer["frame_id"]) == ("pr2", "ur10e", "base")
    assert answer["settings"]["scene"] | {"mode": "table", "up": [0, 0.64, 0.77]} == answer["settings"]["scene"]
    assert len(answer["objects"][0]["grasps"]) == 2


def test_what_one_command_has_has_a_variable_of_its_own(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FLATGRASP_PLAN_PLOTS", "none")
    assert run("plan", BOX, "--out", "out").code == 0
    assert [path.name for path in Path("out").iterdir()] == ["juice_box.grasps.json"]


FAULTS = {
    "griper: pr2": "griper: unknown key; did you mean 'gripper'?",
    "camera-pose: x": "camera-pose: unknown key; did you mean 'camera_pose'?",
    "top: zero": "top: 'zero' is not a valid integer range",
    "top: 0": "top: 0 is not in the range x>=1",
    "scale: -1": "scale: -1.0 is not a positive number",
    "scene: tables": "scene: 'tables' is not one of",
    "plots: none": "plots: not all commands have it; put it below batch or plan or simulate:",
    "plan: {plot: none}": "plan: plot: unknown key; did you mean 'plots'?",
    "plan: none": "plan: wants options of that command",
    "top: {a: 1}": "top: is a single value",
    "top: 1\ntop: 2": "key 'top' is given twice",
    "gripper: &a pr2\nrobot: *a": "aliases are not allowed",
    "- gripper": "a file of defaults is a list of `key: value` lines",
    "set: [a]": "set: wants keys as in a planner profile",
    "set: {fingers: {stepm: 1}}": "fingers.stepm: unknown key; did you mean 'step_m'?",
    "[" * 50: "nested more than 20 levels deep",
    "#" * 2_000_000: "are too many for a file of defaults",
}


@pytest.mark.parametrize(("text", "words"), FAULTS.items(), ids=[text[:20] for text in FAULTS])
def test_faults_name_the_file_the_key_and_the_cure(text: str, words: str, tmp_path: Path, run: Run) -> None:
    path = written(tmp_path / "lab.yaml", text)
    done = run("plan", BOX, "--config", path)
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"flatgrasp: {path}")
    assert words in done.err


def test_a_file_that_is_named_must_be_there(run: Run) -> None:
    done = run("plan", BOX, "--config", "nowhere.yaml")
    assert (done.code, done.err) == (
        2,
        "flatgrasp: nowhere.yaml: cannot read the file of defaults: No such file or directory\n",
    )


def test_verbose_says_where_each_value_comes_from(home: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(home / "flatgrasp.yaml", "gripper: pr2\nset: {seed: 7}\n")
    monkeypatch.setenv("FLATGRASP_TOP", "2")
    done = run("plan", BOX, "--json", "--verbose", "--scene", "object", "--set", "seed=8")
    said = done.err.splitlines()
    for line in (
        f"gripper: pr2 ({path})",
        "top: 2 (environment)",
        "scene: object (command line)",
        "method: default (default)",
        f"set seed=7 ({path})",
        "set seed=8 (command line)",
    ):
        assert f"flatgrasp: {line}" in said
    assert said.index(f"flatgrasp: set seed=7 ({path})") < said.index("flatgrasp: set seed=8 (command line)")


@pytest.mark.parametrize("command", ["cage", "compare", "batch"])
def test_every_planning_command_reads_it(command: str, home: Path, run: Run) -> None:
    written(home / "flatgrasp.yaml", "gripper: nowhere\nplan: {plots: none}\n")
    out = ("--out", "out") if command == "batch" else ()
    done = run(command, BOX, *out)
    assert done.code == 2
    assert "no gripper profile named 'nowhere'" in done.err


def test_help_needs_no_sound_file(home: Path, run: Run) -> None:
    written(home / "flatgrasp.yaml", "griper: pr2\n")
    assert run("plan", "--help").code == 0


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("FLATGRASP_GRIPER", "did you mean FLATGRASP_GRIPPER?"),
        ("FLATGRASP_PLAN_PLOT", "did you mean FLATGRASP_PLAN_PLOTS?"),
        ("flatgrasp_robot", "did you mean FLATGRASP_ROBOT?"),
        ("FLATGRASP_XYZZY", "they are named like FLATGRASP_GRIPPER"),
    ],
)
def test_a_misspelt_variable_is_a_warning_that_names_the_nearest(
    wrong: str, right: str, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(wrong, "pr2")
    done = run("plan", BOX, "--json")
    assert document(done)["gripper"]["name"] == "lacquey"
    (line,) = done.err.splitlines()
    assert line == f"flatgrasp: warning: {wrong}: no option has this variable, it changes nothing; {right}"


def test_variables_of_any_command_are_known(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {
        "CONFIG": os.devnull,
        "GRIPPER": "pr2",
        "SET": "fingers.step_m=0.004",
        "BATCH_JOBS": "1",
    }.items():
        monkeypatch.setenv(f"FLATGRASP_{name}", value)
    done = run("plan", BOX, "--json")
    assert document(done)["gripper"]["name"] == "pr2"
    assert done.err == ""
