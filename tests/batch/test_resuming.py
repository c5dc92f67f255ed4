"""No work is lost however a batch ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import pytest

from flatgrasp_cli.batch import run as run_module
from flatgrasp_cli.batch.work import work as work_of_a_slice
from flatgrasp_cli.whole_files import write_text
from tests.batch.batches import COMMAND, FAST, documents, files
from tests.conftest import SAMPLES, Ended, Run
from tests.plates import slab, write_pcd


@pytest.fixture
def started(long: Path, plate: Path, tmp_path: Path) -> subprocess.Popen[str]:
    """A batch of two workers, at a moment at which some slices are done and some are not."""
    command = [*COMMAND, str(long), str(plate), "-o", "out", "-j", "2", *FAST]
    inherited = signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs in a shell's background ignore Ctrl-C
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    signal.signal(signal.SIGINT, inherited)
    end = time.monotonic() + 60
    while not list((tmp_path / "out").rglob("parts/long/*.jsonl")):
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.01)
    return process


def children(process: subprocess.Popen[str]) -> list[int]:
    task = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    return [int(word) for word in task.read_text().split()]


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


linux = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")


@linux
def test_killed_it_goes_on_where_it_was(
    started: subprocess.Popen[str], whole: dict[str, str], long: Path, plate: Path, tmp_path: Path, run: Run
) -> None:
    workers = children(started)
    started.kill()
    started.communicate()
    kept = len(list((tmp_path / "out").rglob("parts/long/*.jsonl")))
    assert kept >= 1
    end = time.monotonic() + 30
    while any(map(alive, workers)):  # workers do not outlive their coordinator
        assert time.monotonic() < end
        time.sleep(0.05)
    assert run("batch", long, plate, "-o", tmp_path / "out", "-j", "1", *FAST).code == 0
    assert files(tmp_path / "out") == whole


@linux
def test_ctrl_c_says_how_to_go_on(
    started: subprocess.Popen[str], whole: dict[str, str], long: Path, plate: Path, tmp_path: Path, run: Run
) -> None:
    started.send_signal(signal.SIGINT)
    _, err = started.communicate(timeout=60)
    assert started.returncode == 130
    assert "the same command goes on from there" in err
    assert "Traceback" not in err
    assert "leaked" not in err
    assert run("batch", long, plate, "-o", tmp_path / "out", "-j", "1", *FAST).code == 0
    assert files(tmp_path / "out") == whole


@linux
def test_a_dying_worker_costs_nothing(started: subprocess.Popen[str], whole: dict[str, str], tmp_path: Path) -> None:
    os.kill(max(children(started)), signal.SIGKILL)
    _, err = started.communicate(timeout=120)
    assert started.returncode == 0, err
    assert files(tmp_path / "out") == whole


def test_a_slice_that_kills_its_worker_is_given_up(plate: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[str] = []
    real: Callable[..., Any] = work_of_a_slice

    def work(job: Any, piece: Any, plots: bool) -> Any:
        tried.append(piece.input.name)
        if piece.input.name == "pan.pcd":
            raise BrokenProcessPool("a worker died")
        return real(job, piece, plots)

    monkeypatch.setattr(run_module, "work", work)
    done = run("batch", SAMPLES / "pan.pcd", plate, "-o", "out", "-j", "1", *FAST)
    assert done.code == 3
    assert tried.count("pan.pcd") == run_module.TRIES
    assert "given up: BrokenProcessPool: a worker died" in done.err
    assert len(documents(Path("out/plate.pcd.jsonl"))) == 1


def test_what_is_done_is_not_done_again(plate: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("batch", plate, "-o", "out", "-j", "1", *FAST).code == 0
    before = Path("out/plate.pcd.jsonl").read_bytes()
    monkeypatch.setattr(run_module, "work", lambda *_: pytest.fail("planned again"))
    done = run("batch", plate, "-o", "out", "-j", "1", *FAST)
    assert done.code == 0
    assert "1 of 1 frames with a grasp" in done.err
    assert Path("out/plate.pcd.jsonl").read_bytes() == before


def test_other_settings_are_not_mixed_in(plate: Path, run: Run) -> None:
    assert run("batch", plate, "-o", "out", "-j", "1", *FAST).code == 0
    done = run("batch", plate, "-o", "out", "-j", "1", *FAST, "--set", "balance.friction=0.3")
    assert done.code == 2
    assert "made otherwise (other settings)" in done.err
    assert "--force" in done.err
    forced = run("batch", plate, "-o", "out", "-j", "1", *FAST, "--set", "balance.friction=0.3", "--force")
    assert forced.code == 0
    assert documents(Path("out/plate.pcd.jsonl"))[0]["settings"]["balance"]["friction"] == 0.3


def test_a_changed_or_repaired_input_is_planned_again(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "cloud.pcd"
    path.write_text("broken")
    assert run("batch", path, "-o", "out", "-j", "1", *FAST).code == 3
    write_pcd(path, slab(120, 40, points=400))
    assert run("batch", path, "-o", "out", "-j", "1", *FAST).code == 0
    write_pcd(path, slab(110, 30, points=400))
    done = run("batch", path, "-o", "out", "-j", "1", *FAST)
    assert (done.code, "is planned again" in done.err) == (0, True)
    (document,) = documents(Path("out/cloud.pcd.jsonl"))
    assert document["objects"][0]["grasps"][0]["width_m"] == pytest.approx(0.03, abs=2e-3)


def test_a_full_disk_leaves_what_is_whole(
    long: Path, whole: dict[str, str], plate: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = write_text
    written = 0

    def write(path: Path, lines: Any) -> None:
        nonlocal written
        written += 1
        if written == 4:
            raise OSError(28, "No space left on device")
        real(path, lines)

    monkeypatch.setattr("flatgrasp_cli.batch.store.write_text", write)
    done: Ended = run("batch", long, plate, "-o", "out", "-j", "1", *FAST)
    assert done.code == 2
    assert "No space left on device" in done.err
    monkeypatch.setattr("flatgrasp_cli.batch.store.write_text", real)
    assert run("batch", long, plate, "-o", "out", "-j", "1", *FAST).code == 0
    assert files(Path("out")) == whole


def test_an_input_that_vanishes_costs_only_itself(plate: Path, run: Run, tmp_path: Path) -> None:
    done = run("batch", SAMPLES / "pan.pcd", tmp_path / "gone.bag", plate, "-o", "out", "-j", "1", *FAST)
    assert done.code == 3
    assert "gone.bag" in done.err
    assert {path.name for path in Path("out").glob("*.jsonl")} == {"pan.pcd.jsonl", "plate.pcd.jsonl"}


def test_quiet(plate: Path, run: Run) -> None:
    assert run("batch", plate, "-o", "out", "-j", "1", "--quiet", *FAST) == (0, "", "")
