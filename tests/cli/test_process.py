"""The command line as a process: what it loads, how it reads and writes pipes, what it prints where."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.command_line import COMMAND, PNG, answer, documents, modules, untimed
from tests.conftest import SAMPLES, Run


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


def test_no_sample_waits_for_open3d() -> None:
    """For what is binary does not; tests/planner/test_speed.py looks at what the plan of a sample loads."""
    samples = sorted(SAMPLES.glob("*.pcd"))
    assert len(samples) == 9
    assert all(b"\nDATA binary\n" in path.read_bytes()[:300] for path in samples)


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
