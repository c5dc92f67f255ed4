"""`flatgrasp serve`: whose options win, and who may connect."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.cli.command_line import untimed
from tests.conftest import Run


def served(run: Run, plate: Path, *arguments: str, options: object = None) -> Any:
    """The answer to one request."""
    line = json.dumps({"id": 1, "source": str(plate), "options": options}).encode()
    done = run("serve", *arguments, stdin=line)
    assert done.code == 0
    (answer,) = (json.loads(line) for line in done.out.splitlines())
    return answer


def test_a_document_is_that_of_plan(plate: Path, run: Run) -> None:
    options = ("--gripper", "pr2", "--set", "fingers.step_m=0.006", "--top", "3")
    (document,) = served(run, plate, *options)["documents"]
    assert untimed(json.dumps(document)) == untimed(run("plan", plate, "--json", *options).out)
    of_request = {"gripper": "pr2", "set": {"fingers": {"step_m": 0.006}}, "top": 3}
    (again,) = served(run, plate, options=of_request)["documents"]
    assert untimed(json.dumps(again)) == untimed(json.dumps(document))


def test_a_request_beats_the_process_and_that_beats_variables(
    plate: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FLATGRASP_GRIPPER", "lacquey")
    monkeypatch.setenv("FLATGRASP_SET", "fingers.step_m=0.005")
    monkeypatch.setenv("FLATGRASP_SCENE", "object")

    def resolved(*arguments: str, **options: object) -> tuple[str, float, str]:
        (document,) = served(run, plate, *arguments, options=options)["documents"]
        settings = document["settings"]
        return document["gripper"]["name"], settings["fingers"]["step_m"], settings["scene"]["mode"]

    process = ("--gripper", "pr2", "--set", "fingers.step_m=0.006", "--set", "scene.mode=table")
    assert resolved() == ("lacquey", 0.005, "object")
    assert resolved(*process) == ("pr2", 0.006, "table")
    assert resolved(*process, gripper="wsg_50", set=["fingers.step_m=0.007"]) == ("wsg_50", 0.007, "table")
    assert resolved(*process, scene="auto", set="fingers.step_m=0.008") == ("pr2", 0.008, "auto")


WRONG = {
    "unknown": ({"griper": "pr2"}, "--griper: no such option; did you mean 'gripper'"),
    "help": ({"help": True}, "--help: no such option"),
    "no-word": ({"": True}, "--: no such option"),
    "a-word-with-its-value": ({"top=3": True}, "--top=3: no such option"),
    "of-the-process": ({"config": "mine.yaml"}, "--config"),
    "not-of-planning": ({"listen": "127.0.0.1:1"}, "--listen"),
    "no-choice": ({"scene": "floor"}, "auto"),
    "no-number": ({"top": "many"}, "--top"),
    "no-flag": ({"strict": "yes"}, "--strict"),
    "no-value": ({"gripper": True}, "--gripper: wants a value"),
    "no-value-before-another": ({"base_frame": True, "count": 1}, "--base-frame: wants a value"),
    "no-text": ({"base_frame": "\ud800"}, "no text in UTF-8"),
    "an-object": ({"gripper": {"name": "pr2"}}, "gripper"),
    "profile": ({"gripper": "pr3"}, "did you mean 'pr2'"),
    "setting": ({"set": {"fingers": {"stepp_m": 1}}}, "did you mean 'step_m'"),
    "frames": ({"at": 1, "count": 2}, "--at names one frame"),
    "words": ({"gripper": "pr2 --top 3"}, "pr2 --top 3"),
}


@pytest.mark.parametrize(("options", "word"), WRONG.values(), ids=WRONG)
def test_wrong_options_are_said(options: dict[str, object], word: str, plate: Path, run: Run) -> None:
    answer = served(run, plate, options=options)
    assert (answer["id"], answer["status"], answer["error"]["kind"]) == (1, "error", "options")
    assert word in answer["error"]["text"]


def test_null_and_false_say_nothing(plate: Path, run: Run) -> None:
    answer = served(run, plate, options={"strict": False, "robot": None, "crop": None, "count": 1})
    assert (answer["status"], answer["documents"][0]["robot"]) == ("ok", None)


def test_numbers_in_a_list_are_those_of_the_option(plate: Path, run: Run) -> None:
    (document,) = served(run, plate, options={"crop": [-1, 1, -1, 1, -1, 1.5]})["documents"]
    assert document["settings"]["scene"]["crop"] == [-1, 1, -1, 1, -1, 1.5]


def test_the_end_of_input_is_the_end(run: Run) -> None:
    assert run("serve", stdin=b"\n\n") == run("serve")
    assert run("serve").code == 0


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--listen", "0.0.0.0:0"), "--remote"),
        (("--listen", "5555"), "HOST:PORT"),
        (("--remote",), "--listen"),
        (("--gripper", "pr3"), "did you mean 'pr2'"),
    ],
)
def test_what_cannot_be_served_is_said_at_once(arguments: tuple[str, ...], word: str, run: Run) -> None:
    done = run("serve", *arguments)
    assert (done.code, done.out) == (2, "")
    assert word in done.err
