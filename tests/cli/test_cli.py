"""The command line as a user and a program meet it: what it prints where, the files it writes, how it ends."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from flatgrasp_cli.geometry.arrays import FloatArray
from tests.conftest import SAMPLES, Run

PNG = b"\x89PNG\r\n\x1a\n"
COMMAND = [sys.executable, "-m", "flatgrasp_cli"]


def slab(width_mm: float, height_mm: float, thickness_mm: float = 10, points: int = 6000) -> FloatArray:
    """Random points (n, 3) in metres of a rectangular plate, and its corners."""
    rng = np.random.default_rng(5)
    half = 5e-4 * np.array([width_mm, height_mm, thickness_mm])
    corners = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), axis=-1).reshape(-1, 3)
    return np.vstack([rng.uniform(-half, half, (points, 3)), corners * half])


def write_pcd(path: Path, points: FloatArray, above: float = 1.0) -> Path:
    """Write points as a binary PCD file, seen from a metre above."""
    path.parent.mkdir(parents=True, exist_ok=True)
    header = (
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
        f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 {above} 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n"
    )
    path.write_bytes(header.encode() + points.astype("<f4").tobytes())
    return path


def documents(text: str) -> list[dict[str, Any]]:
    """JSON Lines."""
    assert text.endswith("\n")
    return [json.loads(line) for line in text.splitlines()]


def untimed(text: str) -> str:
    """A document as text without its times, its keys in their order."""
    document = json.loads(text)
    assert all(value >= 0 for value in document.pop("timing_ms").values())
    return json.dumps(document)


def answer(document: dict[str, Any]) -> Any:
    """What was found, wherever it was read from."""
    return document["status"], document["objects"], document["gripper"], document["settings"]


def modules(importtime: str) -> set[str]:
    """The top-level packages that `-X importtime` says were loaded."""
    rows = [line for line in importtime.splitlines() if line.startswith("import time:")]
    assert len(rows) > 50
    return {row.rsplit("|", 1)[1].strip().split(".")[0] for row in rows}


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plate of 120 × 40 × 10 mm, which every gripper can take across."""
    return write_pcd(tmp_path_factory.mktemp("clouds") / "plate.pcd", slab(120, 40))


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plate of 300 × 300 mm, which no gripper can take."""
    return write_pcd(tmp_path_factory.mktemp("clouds") / "large.pcd", slab(300, 300, points=20000))


@pytest.fixture(scope="module")
def validator() -> Draft202012Validator:
    """Of documents against what `flatgrasp schema` prints."""
    done = subprocess.run([*COMMAND, "schema"], capture_output=True, check=True, text=True)
    assert done.stderr == ""
    schema = json.loads(done.stdout)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def test_plan_writes_both_files_and_prints_a_plain_table(plate: Path, tmp_path: Path, run: Run) -> None:
    out = tmp_path / "new" / "folder"
    done = subprocess.run([*COMMAND, "plan", plate, "--out", out], capture_output=True, check=False, text=True)
    written = f"flatgrasp: wrote {out}/plate.grasps.json, {out}/plate.grasps.png\n"
    assert (done.returncode, done.stderr) == (0, written)
    assert sorted(path.name for path in out.iterdir()) == ["plate.grasps.json", "plate.grasps.png"]
    assert (out / "plate.grasps.png").read_bytes().startswith(PNG)
    text = (out / "plate.grasps.json").read_text(encoding="utf-8")
    best = json.loads(text)["objects"][0]["grasps"][0]
    assert best["width_m"] == pytest.approx(0.040, abs=0.002)
    assert len(text.splitlines()) > 100
    assert "\x1b" not in done.stdout
    assert f"{1e3 * best['width_m']:.1f}" in done.stdout

    again = tmp_path / "again"
    assert run("plan", plate, "--out", again).code == 0  # in this process, with another seed of str's hash
    assert untimed((again / "plate.grasps.json").read_text(encoding="utf-8")) == untimed(text)
    assert (again / "plate.grasps.png").read_bytes() == (out / "plate.grasps.png").read_bytes()


def test_plan_from_a_pipe_gives_the_same_and_loads_no_plotting(plate: Path, run: Run, tmp_path: Path) -> None:
    command = [sys.executable, "-X", "importtime", *COMMAND[1:], "plan", "-", "--json"]
    done = subprocess.run(command, input=plate.read_bytes(), capture_output=True, check=False, cwd=tmp_path)
    assert done.returncode == 0
    (piped,) = documents(done.stdout.decode())
    assert piped["source"]["path"] == "stdin"
    (direct,) = documents(run("plan", plate, "--json").out)
    assert direct["source"]["path"] == str(plate)
    assert answer(piped) == answer(direct)
    loaded = modules(done.stderr.decode())
    assert "cv2" in loaded
    assert loaded.isdisjoint({"matplotlib", "open3d", "rich"})


def test_no_sample_waits_for_open3d(tmp_path: Path) -> None:
    samples = sorted(SAMPLES.glob("*.pcd"))
    assert len(samples) == 9
    assert all(b"\nDATA binary\n" in path.read_bytes()[:300] for path in samples)
    command = [sys.executable, "-X", "importtime", *COMMAND[1:], "plan", str(SAMPLES / "juice_box.pcd"), "--json"]
    done = subprocess.run(command, capture_output=True, check=False, cwd=tmp_path, text=True)
    assert done.returncode == 0
    assert modules(done.stderr).isdisjoint({"matplotlib", "open3d", "rich"})


def test_help_loads_nothing_heavy() -> None:
    done = subprocess.run(
        [sys.executable, "-X", "importtime", *COMMAND[1:], "--help"], capture_output=True, check=False, text=True
    )
    assert done.returncode == 0
    assert all(command in done.stdout for command in ("plan", "profiles", "schema"))
    loaded = modules(done.stderr)
    assert "click" in loaded
    assert loaded.isdisjoint({"numpy", "open3d", "pydantic", "pydantic_core", "scipy", "shapely", "matplotlib", "yaml"})


PIPED = {
    "json": ("plan", "PLATE", "--json"),
    "table": ("plan", "PLATE", "--plots", "none"),
    "schema": ("schema",),
}


@pytest.mark.parametrize("arguments", PIPED.values(), ids=PIPED)
def test_a_closed_pipe_is_no_error(arguments: tuple[str, ...], plate: Path, tmp_path: Path) -> None:
    command = [*COMMAND, *(str(plate) if word == "PLATE" else word for word in arguments)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, cwd=tmp_path
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        err = process.stderr.read().decode()
    assert (process.returncode, err) == (0, "")


def test_a_full_disk_is_no_traceback() -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("this system has no /dev/full")
    with full.open("wb") as out:
        done = subprocess.run([*COMMAND, "schema"], stdout=out, stderr=subprocess.PIPE, check=False, text=True)
    assert done.returncode == 2
    assert "No space left" in done.stderr
    assert "Traceback" not in done.stderr


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


USAGE = {
    "no-source": (("plan",), "SOURCE"),
    "unknown-command": (("plam",), "plam"),
    "unknown-option": (("plan", "PLATE", "--griper", "pr2"), "--gripper"),
    "unknown-gripper": (("plan", "PLATE", "--gripper", "pr3"), "did you mean 'pr2'"),
    "unknown-method": (("plan", "PLATE", "--method", "papper"), "did you mean 'paper'"),
    "missing-gripper-file": (("plan", "PLATE", "--gripper", "mine.yaml"), "mine.yaml"),
    "set-unknown-key": (("plan", "PLATE", "--set", "fingers.stepp_m=0.004"), "did you mean 'step_m'"),
    "set-unknown-section": (("plan", "PLATE", "--set", "finger.step_m=0.004"), "did you mean 'fingers'"),
    "set-no-value": (("plan", "PLATE", "--set", "fingers.step_m"), "section.key=value"),
    "set-not-a-number": (("plan", "PLATE", "--set", "fingers.step_m=wide"), "wide"),
    "set-millimetres": (("plan", "PLATE", "--set", "fingers.step_m=400"), "400"),
    "set-nan": (("plan", "PLATE", "--set", "fingers.step_m=.nan"), "fingers.step_m"),
    "set-below-a-value": (("plan", "PLATE", "--set", "fingers.step_m.deep=1"), "fingers.step_m"),
    "set-not-yaml": (("plan", "PLATE", "--set", "fingers.step_m=[1"), "YAML"),
    "scale-zero": (("plan", "PLATE", "--scale", "0"), "--scale"),
    "scale-nan": (("plan", "PLATE", "--scale", "nan"), "--scale"),
    "scale-inf": (("plan", "PLATE", "--scale", "inf"), "--scale"),
    "sensor-out-of-this-world": (("plan", "PLATE", "--sensor", "1e300,0,0"), "--sensor"),
    "top-zero": (("plan", "PLATE", "--top", "0"), "--top"),
    "plots-unknown": (("plan", "PLATE", "--plots", "all"), "stages"),
    "out-is-a-file": (("plan", "PLATE", "--out", "PLATE"), "--out"),
    "out-below-a-file": (("plan", "PLATE", "--out", "PLATE/results"), "--out"),
    "profiles-unknown": (("profiles", "show", "pr3"), "pr2"),
    "profiles-missing": (("profiles", "check", "mine.yaml"), "mine.yaml"),
}


@pytest.mark.parametrize(("arguments", "word"), USAGE.values(), ids=USAGE)
def test_wrong_usage_is_exit_2_and_says_what_is_right(
    arguments: tuple[str, ...], word: str, plate: Path, run: Run
) -> None:
    done = run(*(each.replace("PLATE", str(plate)) for each in arguments))
    assert (done.code, done.out) == (2, "")
    assert word in done.err
    assert list(Path().iterdir()) == []


def test_a_fault_in_ones_own_gripper_is_named(plate: Path, run: Run) -> None:
    shown = run("profiles", "show", "pr2").out
    assert "max_opening_m: 0.090" in shown
    Path("mine.yaml").write_text(shown.replace("max_opening_m: 0.090", "max_opening_m: -0.090"), encoding="utf-8")
    done = run("plan", plate, "--gripper", "mine.yaml", "--json")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("flatgrasp: mine.yaml: max_opening_m: -0.09: ")
    assert len(done.err.splitlines()) == 1


def test_ones_own_gripper_is_used(plate: Path, run: Run) -> None:
    shown = run("profiles", "show", "pr2").out
    Path("mine.yaml").write_text(shown.replace("max_opening_m: 0.090", "max_opening_m: 0.030"), encoding="utf-8")
    done = run("plan", plate, "--gripper", "mine.yaml", "--json")
    assert done.code == 1
    assert documents(done.out)[0]["gripper"]["max_opening_m"] == 0.03


def test_profiles_list(run: Run) -> None:
    done = run("profiles", "list")
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert {"gripper\tlacquey", "gripper\tpr2", "robot\tur5", "planner\tdefault", "planner\tpaper"} <= set(lines)
    planners = [f"planner\t{name}" for name in ("allen", "default", "paper")]
    assert run("profiles", "list", "planner").out.splitlines() == planners


def test_every_profile_shown_passes_its_check(run: Run) -> None:
    files = []
    for line in run("profiles", "list").out.splitlines():
        kind, name = line.split("\t")
        files.append(f"{kind}-{name}.yaml")
        Path(files[-1]).write_text(run("profiles", "show", name).out, encoding="utf-8")
    done = run("profiles", "check", *files)
    assert (done.code, done.err) == (0, "")
    assert done.out.splitlines() == [f"{file}: ok" for file in files]


def test_profiles_check_lists_every_fault(run: Run) -> None:
    shown = run("profiles", "show", "pr2").out
    broken = shown.replace("max_opening_m: 0.090", "max_opening_m: wide").replace("palm_m", "plam_m")
    Path("broken.yaml").write_text(broken, encoding="utf-8")
    Path("good.yaml").write_text(shown, encoding="utf-8")
    done = run("profiles", "check", "broken.yaml", "good.yaml")
    assert (done.code, done.out) == (2, "good.yaml: ok\n")
    faults = done.err.splitlines()
    assert all(fault.startswith("broken.yaml: ") for fault in faults)
    assert [word in done.err for word in ("max_opening_m: 'wide'", "palm_m: missing", "did you mean 'palm_m'")] == [
        True,
        True,
        True,
    ]
    assert len(faults) == 3


def test_an_interrupt_is_exit_130(plate: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("flatgrasp_cli.job.plan", interrupted)
    done = run("plan", plate, "--json")
    assert (done.code, done.out) == (130, "")
    assert "interrupted" in done.err
