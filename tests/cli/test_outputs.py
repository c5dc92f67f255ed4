"""What is written is whole or not there; what cannot be drawn, or read, costs nothing else."""

from __future__ import annotations

import errno
import io
import json
import os
import resource
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli.cli import run as run_here
from flatgrasp_cli.whole_files import draft_of, write_bytes, write_text
from tests.cli.command_line import COMMAND, PNG
from tests.conftest import SAMPLES, TABLE, Camera, Run
from tests.plates import slab, write_pcd


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A table with nothing on it, a metre below the sensor."""
    seen = Camera(distance=1.0).sees(TABLE)
    return write_pcd(tmp_path_factory.mktemp("clouds") / "table.pcd", seen.points[::4])


NO_SPACE = "flatgrasp: the output cannot be written: No space left on device\n"


@contextmanager
def files_end_at(size: int) -> Iterator[None]:
    """No file may grow beyond `size` bytes: the nearest thing to a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_file_is_whole_or_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "new" / "file"
    write_text(path, ["a\n", "ü\n"])
    assert path.read_bytes() == b"a\n\xc3\xbc\n"

    def breaks() -> Iterator[str]:
        yield "b\n"
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_text(path, breaks())
    with pytest.raises(OSError, match="too large"), files_end_at(10):
        write_bytes(path, bytes(11))
    with pytest.raises(RuntimeError), draft_of(path):
        raise RuntimeError  # before anything was written
    assert path.read_bytes() == b"a\n\xc3\xbc\n"
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.parametrize("size", [0, 100])
@pytest.mark.parametrize("arguments", [("plan",), ("plan", "--plots", "stages"), ("cage",), ("compare",)], ids=" ".join)
def test_a_full_disk_leaves_no_part_of_a_file(
    size: int, arguments: tuple[str, ...], plate: Path, tmp_path: Path, run: Run
) -> None:
    out = tmp_path / "out"
    with files_end_at(size):
        done = run(*arguments, plate, "--out", out)
    assert done.code == 2
    assert "cannot be written: File too large" in done.err
    assert "--out" in done.err
    assert len(done.err.splitlines()) == 1
    assert not out.exists() or list(out.iterdir()) == []


def test_a_disk_that_fills_up_keeps_the_document(plate: Path, run: Run) -> None:
    written = run("plan", plate, "--out", "all", "--json")
    document, picture = (Path(f"all/plate.grasps.{kind}").stat().st_size for kind in ("json", "png"))
    assert document < picture
    with files_end_at((document + picture) // 2):
        done = run("plan", plate, "--out", "some", "--json")
    assert done.code == 2
    assert "plate.grasps.png: cannot be written" in done.err
    assert [path.name for path in Path("some").iterdir()] == ["plate.grasps.json"]
    assert json.loads(done.out)["status"] == json.loads(written.out)["status"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_stdout_ends_a_process_without_a_traceback(plate: Path, tmp_path: Path) -> None:
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*COMMAND, "plan", str(plate), "--json"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            cwd=tmp_path,
            env={"PYTHONPATH": str(SAMPLES.parent)},
        )
    assert done.returncode == 2
    assert done.stderr == NO_SPACE


class Full(io.RawIOBase):
    """A device that is full until it is `emptied`."""

    emptied = False

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        if not self.emptied:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return len(data)


@pytest.mark.parametrize("command", ["plan", "cage", "compare", "inspect", "schema"])
def test_a_full_stdout_is_an_error(
    command: str, plate: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    device = Full()
    out = io.TextIOWrapper(io.BufferedWriter(device))
    monkeypatch.setattr("flatgrasp_cli.cli._abandon_stdout", lambda: None)  # the tests' own stdout goes on
    monkeypatch.setattr(sys, "argv", ["flatgrasp", command, *(() if command == "schema" else (str(plate), "--json"))])
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", out)
        code = run_here()
    device.emptied = True
    assert (code, capsys.readouterr().err) == (2, NO_SPACE)


def test_a_picture_that_fails_costs_no_answer(plate: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise np.linalg.LinAlgError("singular")

    monkeypatch.setattr("flatgrasp_cli.results.figures.final_figure", fails)
    monkeypatch.setattr("flatgrasp_cli.results.figures.comparison.comparison_figure", fails)
    monkeypatch.setattr("flatgrasp_cli.results.figures.cage.cage_figure", fails)
    done = run("plan", plate, plate, "--json", "--out", "out")
    assert done.code == 2
    assert len(done.out.splitlines()) == 2
    *said, written = done.err.splitlines()
    assert written == "flatgrasp: wrote out/plate.grasps.json, out/plate-2.grasps.json"
    assert [line.partition(": the picture cannot be drawn: ") for line in said] == [
        (f"flatgrasp: out/{name}.grasps.png", ": the picture cannot be drawn: ", "LinAlgError: singular")
        for name in ("plate", "plate-2")
    ]
    assert sorted(path.name for path in Path("out").iterdir()) == ["plate-2.grasps.json", "plate.grasps.json"]
    for command in ("cage", "compare"):
        done = run(command, plate, "--json", "--out", "out")
        assert json.loads(done.out)["object"] == 0
        assert "the picture cannot be drawn" in done.err
    done = run("batch", plate, "-o", "many", "-j", "1", "--plots", "--quiet")
    assert done.code == 0
    assert "the picture cannot be drawn" in done.err
    assert len(Path("many/plate.pcd.jsonl").read_text(encoding="utf-8").splitlines()) == 1


@pytest.mark.parametrize("name", ["a$b^$c", "テ\tレ", "x" * 120, "[red]", "%s {0}"])
def test_any_name_of_a_file_can_be_drawn(name: str, plate: Path, tmp_path: Path, run: Run) -> None:
    path = tmp_path / f"{name}.pcd"
    path.write_bytes(plate.read_bytes())
    done = run("plan", path, "--out", "out", "--json")
    assert done.code == 0
    assert done.err.count("\n") == 1
    (picture,) = Path("out").glob("*.png")
    assert picture.read_bytes().startswith(PNG)


@pytest.mark.parametrize("command", ["cage", "compare"])
@pytest.mark.parametrize("json_option", [(), ("--json",)])
def test_nothing_on_the_table(command: str, json_option: tuple[str, ...], table: Path, run: Run) -> None:
    done = run(command, table, *json_option)
    assert (done.code, done.out) == (1, "")
    said, remedy = done.err.splitlines()
    assert said == f"flatgrasp: {table}: no grasp: nothing stands on the support plane"
    assert remedy.startswith(f"flatgrasp: {table}: remedy: ")


@pytest.mark.parametrize("command", ["plan", "compare", "inspect"])
def test_a_missing_source_does_not_stop_the_others(command: str, plate: Path, table: Path, run: Run) -> None:
    done = run(command, "nowhere.pcd", plate, table, "--json")
    assert done.code == 3
    assert "nowhere.pcd: cannot be read: No such file" in done.err
    assert str(plate) in done.out


ODD = {
    "one point": np.array([[0.1, 0.2, 0.8]]),
    "the same point": np.tile([[0.1, 0.2, 0.8]], (500, 1)),
    "a line": np.linspace([0.0, 0.0, 0.8], [0.3, 0.1, 0.9], 500),
    "two far apart": np.vstack([slab(60, 30), slab(60, 30) + np.array([50.0, 3000.0, 1.0])]),
    "outliers at 9 km": np.vstack([slab(60, 30), [[9000.0, 9000.0, 9000.0], [-9000.0, 0.0, 3.0]]]),
    "a map's corner": slab(60, 30) + np.array([5000.0, 4000.0, 100.0]),
    "a kilometre": 1e4 * slab(60, 30),
    "a micrometre": 1e-5 * slab(60, 30),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_clouds_get_both_files(name: str, tmp_path: Path, run: Run) -> None:
    path = write_pcd(tmp_path / "odd.pcd", ODD[name])
    plots = "final" if "outliers" in name else "stages"  # the stages are those of any cloud then
    done = run("plan", path, "--out", "out", "--plots", plots, "--gripper", "pr2")
    assert done.code in (0, 1)
    assert all(line.startswith("flatgrasp: ") for line in done.err.splitlines())
    json.loads(Path("out/odd.grasps.json").read_text(encoding="utf-8"), parse_constant=pytest.fail)
    assert Path("out/odd.grasps.png").read_bytes().startswith(PNG)
