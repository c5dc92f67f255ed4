"""Ctrl-C at any moment: exit code 130, one line on stderr, and nothing left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from flatgrasp_cli import read_clouds
from tests.conftest import SAMPLES
from tests.sources.pcd_ply import XYZ, pcd, table

TELLS = """
import os
from flatgrasp_cli import __main__
from flatgrasp_cli.interrupts import Interrupts
install = Interrupts.install
def told(self):
    install(self)
    os.write(2, b"ready\\n")
Interrupts.install = told
{more}
__main__.main()
"""
"""The command line, which says when Ctrl-C is ours: what comes before that is Python's own start."""

SWALLOWS = """
import signal, sys
class Finder:
    def find_spec(self, name, path, target=None):
        if name == "numpy":
            try:
                signal.raise_signal(signal.SIGINT)
            except KeyboardInterrupt:
                raise ImportError("initialization failed")
sys.meta_path.insert(0, Finder())
"""
"""Turns a KeyboardInterrupt within an import into an ImportError, as the start of C extensions does."""

REMOVES = """
import shutil, signal
real = shutil.rmtree
def rmtree(*arguments, **options):
    signal.raise_signal(signal.SIGINT)
    real(*arguments, **options)
shutil.rmtree = rmtree
"""
"""Gets its KeyboardInterrupt while a temporary folder is being removed."""

FORGETS = """
import signal
class Forgets:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)
def run(function=Interrupts.install):
    Forgets()
    import time
    time.sleep(30)
import flatgrasp_cli.cli
flatgrasp_cli.cli.run = run
"""
"""Gets its KeyboardInterrupt where Python can only print and forget it."""


def start(*arguments: str | Path, folder: Path, more: str = "") -> subprocess.Popen[str]:
    """The command line in a process of its own, which is past Python's own start."""
    inherited = signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs in a shell's background ignore Ctrl-C
    command = [sys.executable, "-c", TELLS.format(more=more), *map(str, arguments)]
    environment = os.environ | {"TMPDIR": str(folder), "PYTHONPATH": str(SAMPLES.parent)}
    process = subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    signal.signal(signal.SIGINT, inherited)
    assert process.stderr is not None
    assert process.stderr.readline() == "ready\n"
    return process


@pytest.fixture(scope="module")
def compressed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene that only Open3D can read."""
    (cloud,) = read_clouds(SAMPLES / "table_scene.pcd")
    path = tmp_path_factory.mktemp("compressed") / "table_scene.pcd"
    path.write_bytes(pcd(table(XYZ, cloud.points), "binary_compressed"))
    return path


EARLY_MS, LATE_MS = (0, 1, 3, 10, 30, 60, 100, 150, 200), (250, 300, 400, 500, 600, 700)
"""Before Open3D would be imported, which takes longer than all the rest, and from then on."""


@pytest.mark.parametrize("delay_ms", EARLY_MS + LATE_MS)
def test_any_moment_ends_with_130_and_one_line(delay_ms: int, compressed: Path, tmp_path: Path) -> None:
    scene = SAMPLES / "table_scene.pcd" if delay_ms in EARLY_MS else compressed
    process = start("plan", scene, folder=tmp_path)
    time.sleep(delay_ms / 1000)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err.strip()) in {(130, "flatgrasp: interrupted"), (0, "")}  # done in time
    assert process.returncode == 130 or delay_ms > 100
    assert all(path.name.startswith("table_scene.grasps.") for path in tmp_path.iterdir())  # no draft, no spool


def test_a_temporary_folder_is_removed_before_it_ends(compressed: Path, tmp_path: Path) -> None:
    process = start("plan", compressed, folder=tmp_path, more=REMOVES)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err.strip()) == (130, "flatgrasp: interrupted")
    assert list(tmp_path.iterdir()) == []


def test_a_second_one_ends_it_on_the_spot(tmp_path: Path) -> None:
    process = start("plan", SAMPLES / "table_scene.pcd", "--json", folder=tmp_path)
    for _ in range(5):
        process.send_signal(signal.SIGINT)
        time.sleep(0.005)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert set(err.split("\n")) == {"flatgrasp: interrupted", ""}


@pytest.mark.parametrize("more", [SWALLOWS, FORGETS], ids=["swallowed", "forgotten"])
def test_it_cannot_be_lost(more: str, tmp_path: Path) -> None:
    process = start("plan", SAMPLES / "table_scene.pcd", "--json", more=more, folder=tmp_path)
    _, err = process.communicate(timeout=20)
    assert (process.returncode, err.strip()) == (130, "flatgrasp: interrupted")


def test_who_ignores_it_is_not_interrupted(tmp_path: Path) -> None:
    inherited = signal.signal(signal.SIGINT, signal.SIG_IGN)
    command = [sys.executable, "-m", "flatgrasp_cli", "plan", str(SAMPLES / "pan.pcd"), "--json"]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    signal.signal(signal.SIGINT, inherited)
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 0
