"""Whole trials, and `flatgrasp simulate`: what it prints, writes and ends with."""

from __future__ import annotations

import builtins
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, load_robot, load_settings
from flatgrasp_cli.job import Job
from flatgrasp_cli.placing import workcell
from flatgrasp_cli.results.contracts import json_schema
from flatgrasp_cli.simulation.document import trial_document
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.things import sample_thing
from flatgrasp_cli.simulation.trial import Cell, Conditions, Trial, attempt
from flatgrasp_cli.simulation.trials import heaps_of, trials_of
from tests.conftest import Run

VALIDATOR = Draft202012Validator(json_schema("trial"))


def cell(gripper: str = "robotiq_2f_85", robot: str | None = None, **conditions: Any) -> Cell:
    given = {"friction": 0.5, "force_n": 40.0, "tilt_deg": 20.0} | conditions
    arm = None if robot is None else load_robot(robot)
    return Cell(Job(load_gripper(gripper), load_settings(), workcell(arm, None, None)), Conditions(**given))


def documents(trials: Sequence[Trial], where: Cell) -> list[dict[str, Any]]:
    found = [trial_document(trial, where.conditions) for trial in trials]
    for each in found:
        VALIDATOR.validate(json.loads(json.dumps(each, allow_nan=False)))
    return found


@pytest.mark.parametrize("robot", [None, "ur5e"])
def test_a_juice_box_is_held(robot: str | None) -> None:
    where = cell(robot=robot)
    trials = list(trials_of(where, sample_thing("juice_box"), 2))
    assert [(trial.status, trial.reason) for trial in trials] == [("held", None)] * 2
    assert all(trial.execution is not None and trial.execution.clean for trial in trials)
    places = np.array([trial.place.position[:2] for trial in trials])
    assert len(np.unique(places.round(4), axis=0)) == 2  # each trial has its own
    assert np.abs(places - where.spot[:2]).max() < 0.06
    for document in documents(trials, where):
        assert document["grasp"]["metrics"]["required_friction"] >= 0
        assert document["frame_id"] == ("cloud" if robot is None else "base")


def test_a_seed_gives_the_same_bytes_whatever_else_is_simulated() -> None:
    where = cell(robot="ur5", miss_m=0.002, miss_deg=2.0)
    alone = documents(list(trials_of(where, sample_thing("hammer"), 2)), where)
    again = documents(list(trials_of(where, sample_thing("hammer"), 1)), where)
    assert alone[0] == again[0]
    other = cell(robot="ur5", seed=1)
    assert documents(list(trials_of(other, sample_thing("hammer"), 1)), other)[0] != alone[0]


def test_what_is_wider_than_the_hand_gets_no_grasp() -> None:
    where = cell("pr2")
    (trial,) = trials_of(where, sample_thing("juice_box", mass_kg=0.2), 1)
    wide = sample_thing("pan")
    assert trial.status == "held"
    small = cell("robotiq_2f_85")
    small.gripper = small.gripper.model_copy(update={"max_opening_m": 0.009})
    small.job = Job(small.gripper, load_settings("default", ("approach.directions=top",)), workcell(None, None, None))
    (refused,) = trials_of(small, wide, 1)
    assert (refused.status, refused.execution) == ("no_grasp", None)
    (document,) = documents([refused], small)
    assert document["reason"]
    assert [document[key] for key in ("clean", "grasp", "lifted_m", "pushed_m")] == [None] * 4


def test_slippery_pads_lose_it_and_a_hand_that_misses_far_collides() -> None:
    slippery = cell(friction=0.02)
    assert [trial.status for trial in trials_of(slippery, sample_thing("juice_box"), 2)] == ["lost", "lost"]
    blind = cell(miss_m=0.04)
    assert {trial.status for trial in trials_of(blind, sample_thing("juice_box"), 2)} >= {"collision"}


def test_a_heap_is_cleared_grasp_by_grasp() -> None:
    where = cell()
    things = [sample_thing(name) for name in ("juice_box", "hammer")]
    trials = list(heaps_of(where, things, size=3, count=1))
    assert [trial.attempt for trial in trials] == list(range(len(trials)))
    assert sum(trial.status == "held" for trial in trials) == 3
    assert {trial.object for trial in trials} <= {"juice_box", "hammer"}
    assert all(trial.in_heap for trial in trials)
    documents(trials, where)


def test_what_is_left_of_a_heap_is_named_when_it_gets_no_grasp() -> None:
    where = cell()
    world = where.world([sample_thing("hammer"), sample_thing("juice_box")])
    rng = np.random.default_rng(0)
    look = where.look(rng)
    world.reset(where.parked(look), 0.08)
    world.put(1, where.spot, Rotation.identity())
    world.remove(0)
    small = where.gripper.model_copy(update={"max_opening_m": 0.009})
    where.job = Job(small, load_settings(), workcell(None, None, None))
    trial = attempt(where, world, look, rng, (0, 1))
    assert (trial.status, trial.object, trial.attempt) == ("no_grasp", "juice_box", 1)


def test_the_command_prints_a_table_and_ends_with_0(run: Run) -> None:
    done = run("simulate", "juice_box", "hammer", "-g", "robotiq_2f_85", "--trials", "1")
    assert (done.code, done.err) == (0, "")
    rows = [line.split() for line in done.out.splitlines()]
    assert ["juice_box", "1", "1", "1", "0", "21–100"] in rows
    assert ["all", "2", "2", "2", "0", "34–100"] in rows
    assert max(map(len, done.out.splitlines())) <= 80


def test_a_camera_that_sees_beyond_the_table_warns_of_nothing(run: Run) -> None:
    done = run("simulate", "juice_box", "-g", "robotiq_2f_85", "--trials", "1", "--sensor-tilt", "60", "--robot", "ur3")
    assert (done.code, done.err) == (0, "")


def test_what_is_not_held_ends_with_1_and_says_why(run: Run) -> None:
    done = run("simulate", "juice_box", "-g", "robotiq_2f_85", "--trials", "2", "--mu", "0.02", "--force", "30")
    assert done.code == 1
    assert "2 × the object was not lifted" in " ".join(done.out.split())


def test_documents_and_clouds_are_kept_and_plan_the_same_again(run: Run) -> None:
    done = run("simulate", "hammer", "-g", "robotiq_2f_85", "--trials", "1", "--json", "-o", "kept")
    (line,) = done.out.splitlines()
    trial = json.loads(line)
    VALIDATOR.validate(trial)
    assert (trial["conditions"]["force_from"], trial["conditions"]["force_n"]) == ("profile", 235.0)
    assert Path("kept/trials.jsonl").read_text(encoding="utf-8") == done.out
    pose = trial["camera_pose"]
    camera = ",".join(map(repr, pose["position"] + pose["orientation"]))
    again = run(
        *("plan", f"kept/{trial['cloud']}", "-g", "robotiq_2f_85", "--robot", "ur5", "--camera-pose", camera, "--json")
    )
    found, kept = json.loads(again.out), json.loads(Path("kept/hammer.00.grasps.json").read_text(encoding="utf-8"))
    for document in (found, kept):
        del document["timing_ms"], document["source"]["path"]
    assert found == kept
    assert found["objects"][0]["grasps"][0] == trial["grasp"]


def test_a_force_that_nobody_states_is_assumed_and_said(run: Run) -> None:
    done = run("simulate", "juice_box", "-g", "pr2", "--trials", "1", "--json")
    assert "warning: pr2: its profile has no max_force_n, 40 N are assumed; --force states it" in done.err
    assert json.loads(done.out)["conditions"]["force_from"] == "assumed"
    stated = run("simulate", "juice_box", "-g", "pr2", "--trials", "1", "--json", "--force", "15", "--mass", "0.1")
    conditions = json.loads(stated.out)["conditions"]
    assert stated.err == ""
    assert [conditions[key] for key in ("force_n", "force_from", "mass_kg")] == [15.0, "option", 0.1]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (
            ["teddybear"],
            3,
            "teddybear: is neither a mesh file nor one of the paper's objects: teddy_bear, electric_drill",
        ),
        (["juice_box", "--miss", "5"], 2, "'5' is no miss; give millimetres and perhaps degrees, e.g. 5mm,5deg"),
        (["juice_box", "--robot", "ur6"], 2, "no robot profile named 'ur6'"),
        (["juice_box", "--mu", "-1"], 2, "--mu"),
        (["juice_box", "--mass", "1e-9"], 2, "--mass"),
        (["juice_box", "--objects-per-scene", "1"], 2, "--objects-per-scene"),
    ],
)
def test_what_is_wrong_is_said_in_a_line(run: Run, arguments: list[str], code: int, words: str) -> None:
    done = run("simulate", *arguments)
    assert done.code == code
    assert words in done.err


def test_a_mesh_file_is_grasped_and_points_are_none(run: Run) -> None:
    corners = [(x, y, z) for x in (-30, 30) for y in (-20, 20) for z in (-15, 15)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    lines = [*("v {} {} {}".format(*corner) for corner in corners)]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    Path("brick.obj").write_text("o brick\n" + "\n".join(lines) + "\n", encoding="utf-8")
    done = run("simulate", "brick.obj", "--scale", "0.001", "-g", "robotiq_2f_85", "--trials", "1", "--json")
    assert done.code == 0
    trial = json.loads(done.out)
    assert (trial["object"], trial["conditions"]["mass_kg"]) == ("brick", pytest.approx(400 * 0.06 * 0.04 * 0.03))
    small = run("simulate", "brick.obj", "--scale", "1e-6")
    assert (small.code, "brick.obj: is 6e-05 m long; things of 0.005 to 1 m are simulated" in small.err) == (3, True)
    assert run("simulate", "brick.obj").code == 3
    if sys.platform == "linux":  # elsewhere names are in UTF-8, or are not at all
        Path("brick.obj").rename("br\udcefck.obj")
        done = run("simulate", "br\udcefck.obj", "--scale", "0.001", "-g", "pr2", "--trials", "1", "--json")
        assert json.loads(done.out)["object"] == r"br\xefck"
    Path("sheet.obj").write_text("o sheet\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", encoding="utf-8")
    assert "sheet.obj: has no faces; a mesh is wanted" in run("simulate", "sheet.obj").err


def test_without_mujoco_it_ends_with_the_install_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    load_mujoco.cache_clear()
    imported = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name == "mujoco":
            raise ModuleNotFoundError("No module named 'mujoco'", name="mujoco")
        return imported(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    monkeypatch.delitem(sys.modules, "mujoco", raising=False)
    done = run("simulate", "juice_box")
    assert done.code == 2
    assert done.err == "flatgrasp: simulating needs mujoco, which is not installed: pip install 'flatgrasp[simulate]'\n"
