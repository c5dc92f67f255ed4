"""`flatgrasp plan`: the documents that it prints, the files that it writes, and its exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from flatgrasp_cli.geometry.arrays import FloatArray
from tests.cli.command_line import PNG, documents
from tests.conftest import SAMPLES, Run
from tests.plates import slab, write_pcd


def test_json_prints_a_line_for_each_source_and_writes_nothing(plate: Path, large: Path, run: Run) -> None:
    done = run("plan", plate, large, plate, "--json")
    assert done.code == 1
    assert [each["status"] for each in documents(done.out)] == ["ok", "no_grasp", "ok"]
    assert [each["source"]["path"] for each in documents(done.out)] == [str(plate), str(large), str(plate)]
    assert list(Path().iterdir()) == []


def test_json_with_out_does_both(plate: Path, run: Run) -> None:
    done = run("plan", plate, "--json", "--out", "results", "--plots", "none")
    assert (done.code, done.err) == (0, "flatgrasp: wrote results/plate.grasps.json\n")
    assert [path.name for path in Path("results").iterdir()] == ["plate.grasps.json"]
    assert json.loads(Path("results/plate.grasps.json").read_text(encoding="utf-8")) == documents(done.out)[0]


def test_files_go_to_the_current_folder(plate: Path, run: Run) -> None:
    assert run("plan", plate, "--plots", "none").code == 0
    assert [path.name for path in Path().iterdir()] == ["plate.grasps.json"]


@pytest.mark.usefixtures("blank_pictures")
def test_plots_of_every_stage(run: Run) -> None:
    """Of a slice of an object on a table, which has more of them than an object alone."""
    assert run("plan", SAMPLES / "pan_on_table.pcd", "--plots", "stages").code == 0
    assert sorted(path.name for path in Path().iterdir()) == [
        "pan_on_table.grasps.json",
        "pan_on_table.grasps.png",
        "pan_on_table.stages",
    ]
    stages = list(Path("pan_on_table.stages").iterdir())
    assert len(stages) >= 5
    assert all(path.read_bytes().startswith(PNG) for path in stages)


def test_documents_follow_the_schema(plate: Path, large: Path, run: Run, validator: Draft202012Validator) -> None:
    good, refused = documents(run("plan", plate, large, "--json").out)
    assert (good["status"], refused["status"]) == ("ok", "no_grasp")
    assert [error.message for each in (good, refused) for error in validator.iter_errors(each)] == []
    assert good["schema"] == "flatgrasp.plan/1"
    assert not validator.is_valid(good | {"status": "fine"})  # the schema does refuse


def test_the_document_says_what_it_was_made_with(plate: Path, run: Run) -> None:
    done = run("plan", plate, "--json", "-g", "pr2", "--set", "fingers.step_m=0.004", "--top", "3", "--method", "paper")
    (document,) = documents(done.out)
    assert document["gripper"]["name"] == "pr2"
    assert document["gripper"]["max_opening_m"] == 0.09
    assert document["settings"]["name"] == "paper"
    assert document["settings"]["fingers"]["step_m"] == 0.004
    assert [grasp["rank"] for grasp in document["objects"][0]["grasps"]] == [1, 2, 3]


def test_scale_takes_millimetres(plate: Path, tmp_path: Path, run: Run) -> None:
    other = write_pcd(tmp_path / "mm.pcd", 1000 * slab(120, 40), above=1000.0)
    (document,) = documents(run("plan", other, "--json", "--scale", "0.001").out)
    (metres,) = documents(run("plan", plate, "--json").out)
    first, second = (each["objects"][0]["obb"]["size_m"] for each in (document, metres))
    assert first == pytest.approx(second, abs=1e-6)
    done = run("plan", other, "--json")
    assert (done.code, documents(done.out)[0]["status"]) == (1, "no_grasp")


def test_a_plate_too_large_is_refused_with_numbers(large: Path, run: Run) -> None:
    done = run("plan", large, "--json", "--gripper", "pr2")
    (document,) = documents(done.out)
    assert (done.code, document["status"]) == (1, "no_grasp")
    assert document["objects"][0]["grasps"] == []
    assert document["reason"] == document["objects"][0]["reason"]
    miss = document["objects"][0]["nearest_miss"]
    assert miss["stage"] == "grasping_range" == document["objects"][0]["funnel"][-1]["stage"]
    assert miss["value"] == pytest.approx(0.300, abs=0.005)
    assert miss["limit"] == pytest.approx(0.090, abs=0.005)
    assert "0.09" in document["reason"]
    assert document["remedy"] == document["objects"][0]["remedy"]
    assert done.err.splitlines() == [
        f"flatgrasp: {large}: no grasp: {document['reason']} (stage grasping_range)",
        f"flatgrasp: {large}: remedy: {document['remedy']}",
    ]


CROWD = np.random.default_rng(2).random((500, 1))
DEGENERATE: dict[str, tuple[FloatArray, str]] = {
    "one-point": (np.array([[0.1, 0.2, 0.3]]), "1 distinct point"),
    "two-points": (np.array([[0.1, 0.2, 0.3], [0.2, 0.2, 0.3]]), "2 distinct points"),
    "line": (CROWD * [0.1, 0.0, 0.0], "line"),
    "slanted-line": (CROWD * [0.1, 0.07, -0.03] + 0.5, "line"),
    "duplicates": (np.full((500, 3), 0.25), "1 distinct point"),
    "nan": (np.full((500, 3), np.nan), "no point of the cloud was measured"),
    "inf": (np.full((500, 3), np.inf), "no point of the cloud was measured"),
    "scaled-twice": (1e-3 * CROWD @ [[0.1, 0.0, 0.0]] + [0.0, 0.0, 1e-3], "--scale"),
}


@pytest.mark.parametrize(("points", "word"), DEGENERATE.values(), ids=DEGENERATE)
def test_a_degenerate_cloud_has_no_grasp_and_a_reason(
    points: FloatArray, word: str, tmp_path: Path, run: Run, validator: Draft202012Validator
) -> None:
    path = write_pcd(tmp_path / "odd.pcd", points)
    done = run("plan", path, "--json", "--out", "results", "--plots", "stages")
    assert done.code == 1
    (document,) = documents(done.out)
    assert word in document["reason"]
    assert word in done.err
    assert [error.message for error in validator.iter_errors(document)] == []
    assert document["source"]["points"] + document["source"]["dropped"] == len(points)
    assert Path("results/odd.grasps.png").read_bytes().startswith(PNG)


def test_an_unreadable_source_is_exit_3(tmp_path: Path, run: Run) -> None:
    path = tmp_path / "noise.pcd"
    path.write_bytes(b"no cloud at all")
    for source in (path, tmp_path / "missing.pcd", tmp_path):
        done = run("plan", source, "--json")
        assert (done.code, done.out) == (3, "")
        assert done.err.startswith(f"flatgrasp: {source}: ")
        assert len(done.err.splitlines()) <= 2


def test_an_unreadable_source_spares_the_others(plate: Path, large: Path, tmp_path: Path, run: Run) -> None:
    missing = tmp_path / "missing.pcd"
    done = run("plan", missing, plate, large, "--json")
    assert done.code == 3
    assert [each["source"]["path"] for each in documents(done.out)] == [str(plate), str(large)]
    assert f"{missing}: cannot be read: No such file" in done.err
    assert f"{large}: no grasp" in done.err


@pytest.mark.usefixtures("blank_pictures")
def test_sources_of_one_name_keep_their_own_results(plate: Path, tmp_path: Path, run: Run) -> None:
    second = write_pcd(tmp_path / "second" / "plate.pcd", slab(100, 30))
    third = write_pcd(tmp_path / "third" / "plate-2.pcd", slab(90, 50))
    assert run("plan", plate, second, third, "--out", "results").code == 0
    written = {path.name: path for path in Path("results").iterdir()}
    assert sorted(written) == [f"plate{n}.grasps.{end}" for n in ("-2-2", "-2", "") for end in ("json", "png")]
    texts = [written[f"plate{n}.grasps.json"].read_text(encoding="utf-8") for n in ("", "-2", "-2-2")]
    assert [json.loads(text)["source"]["path"] for text in texts] == [str(plate), str(second), str(third)]


@pytest.mark.parametrize("content", [b"", b"no cloud"], ids=["empty", "text"])
def test_a_bad_standard_input_is_exit_3(content: bytes, run: Run) -> None:
    done = run("plan", "-", "--json", stdin=content)
    assert (done.code, done.out) == (3, "")
    assert done.err.startswith("flatgrasp: stdin: ")


def test_a_terminal_as_standard_input_is_exit_2(run: Run) -> None:
    done = run("plan", "-", terminal=True)
    assert done.code == 2
    assert "terminal" in done.err


def test_an_interrupt_is_exit_130(plate: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("flatgrasp_cli.job.plan", interrupted)
    done = run("plan", plate, "--json")
    assert (done.code, done.out) == (130, "")
    assert "interrupted" in done.err
