"""Every request gets its answer, whatever is wrong with it or with the one before."""

from __future__ import annotations

import base64
import json
import logging
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from flatgrasp_cli import load_gripper, load_settings
from flatgrasp_cli.job import Job
from flatgrasp_cli.placing import Workcell
from flatgrasp_cli.serving import Answerer, answering
from tests.conftest import SAMPLES
from tests.plates import slab, write_pcd

JOB = Job(load_gripper("pr2"), load_settings(), Workcell())


@pytest.fixture
def answerer() -> Answerer:
    return Answerer(lambda _: JOB)


def asked(answerer: Answerer, **request: Any) -> Any:
    return json.loads(answerer.answer(json.dumps(request).encode()), parse_constant=pytest.fail)


def untimed(answer: dict[str, Any]) -> dict[str, Any]:
    """The only document of an answer, without its times and its source's name."""
    (document,) = answer["documents"]
    return {**document, "timing_ms": None, "source": {**document["source"], "path": None}}


def test_a_source_and_its_content_have_the_same_answer(answerer: Answerer, tmp_path: Path) -> None:
    plate = write_pcd(tmp_path / "plate.pcd", slab(120, 40, points=2000))
    named = asked(answerer, id=1, source=str(plate))
    brought = asked(answerer, id="b", data=base64.b64encode(plate.read_bytes()).decode())
    assert (named["id"], named["status"], brought["id"], brought["status"]) == (1, "ok", "b", "ok")
    assert brought["documents"][0]["source"]["path"] == "inline"
    assert untimed(named) == untimed(brought)


def test_a_recording_comes_along_too(answerer: Answerer) -> None:
    bag = base64.b64encode((SAMPLES / "pan_ros1.bag").read_bytes()).decode()
    assert len(asked(answerer, data=bag)["documents"]) > 1


def test_no_grasp_is_no_error(answerer: Answerer, tmp_path: Path) -> None:
    large = write_pcd(tmp_path / "large.pcd", slab(300, 300, points=2000))
    answer = asked(answerer, id=1, source=str(large))
    assert (answer["status"], answer["error"]) == ("no_grasp", None)
    assert answer["documents"][0]["reason"]


def test_every_hundred_lines_ten_are_wrong_and_none_is_lost(answerer: Answerer, tmp_path: Path) -> None:
    plate = write_pcd(tmp_path / "plate.pcd", slab(120, 40, points=500))
    for number in range(100):
        if number % 10 == 7:
            answer = json.loads(answerer.answer(b'{"id": %d, "source"' % number))
            assert (answer["status"], answer["id"], answer["error"]["kind"]) == ("error", None, "request")
        elif number % 10 == 3:
            answer = asked(answerer, id=number, source="nowhere.pcd")
            assert (answer["status"], answer["id"], answer["error"]["kind"]) == ("error", number, "source")
        else:
            answer = asked(answerer, id=number, source=str(plate))
            assert (answer["status"], answer["id"]) == ("ok", number)


def test_more_frames_than_are_kept_are_refused(answerer: Answerer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(answering, "FRAMES_AT_MOST", 2)
    answer = asked(answerer, id=1, source=str(SAMPLES / "pan_ros2"))
    assert (answer["status"], answer["error"]["kind"], len(answer["documents"])) == ("error", "options", 2)
    assert "count" in answer["error"]["text"]


def test_what_is_warned_of_is_in_the_answer_of_that_request(
    answerer: Answerer, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    damaged = tmp_path / "cut.mcap"
    content = (SAMPLES / "pan_foxglove.mcap").read_bytes()
    damaged.write_bytes(content[: len(content) * 2 // 3])
    with caplog.at_level(logging.WARNING):
        assert asked(answerer, source=str(damaged))["warnings"]
        assert asked(answerer, source="nowhere.pcd")["warnings"] == []
    assert caplog.records == []


def test_a_fault_of_ours_costs_one_request(tmp_path: Path) -> None:
    def job_of(options: dict[str, Any]) -> Job:
        return replace(JOB, gripper=None) if options else JOB  # type: ignore[arg-type]

    answerer, plate = Answerer(job_of), write_pcd(tmp_path / "plate.pcd", slab(120, 40, points=500))
    answer = asked(answerer, id=1, source=str(plate), options={"any": 1})
    assert (answer["id"], answer["status"], answer["error"]["kind"]) == (1, "error", "failure")
    assert asked(answerer, id=2, source=str(plate))["status"] == "ok"


def test_half_a_pair_of_surrogates_comes_back_as_it_came(answerer: Answerer) -> None:
    line = answerer.answer(b'{"id": "\\ud800", "source": "no\\udfffwhere.pcd"}')
    assert json.loads(line.encode("ascii"))["id"] == "\ud800"
