"""Whether kernels are compiled, and from these sources: a program must not run with other ones than it shows."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from flatgrasp_cli import kernels
from flatgrasp_cli.kernels import _freshness

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the program, compiled."""
    shutil.copytree(ROOT / "flatgrasp_cli", tmp_path / "flatgrasp_cli")
    shutil.copytree(ROOT / "configs", tmp_path / "configs")
    return tmp_path


def version(tree: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "flatgrasp_cli", "--version"]
    environment = os.environ | {"PYTHONPATH": str(tree)}
    return subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, check=False)


def extensions(tree: Path) -> list[Path]:
    return list((tree / "flatgrasp_cli" / "kernels").glob(f"*{_freshness.SUFFIX}"))


def test_tests_run_with_compiled_kernels() -> None:
    assert kernels.STATE == "compiled"


def test_a_tree_that_nothing_compiled_says_so_and_runs(tree: Path) -> None:
    for extension in extensions(tree):
        extension.unlink()
    done = version(tree)
    assert done.returncode == 0
    assert done.stdout.endswith("(interpreted)\n")
    assert done.stderr.startswith(
        "flatgrasp: warning: the kernels are not compiled: planning is very slow; pip install"
    )


def test_kernels_of_other_sources_are_refused(tree: Path) -> None:
    assert version(tree).stdout.endswith("(compiled)\n")
    source = tree / "flatgrasp_cli" / "kernels" / "closing.py"
    source.write_text(source.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    done = version(tree)
    assert done.returncode == 2
    assert "have changed since they were compiled; pip install -e . compiles them" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_so_are_those_of_which_some_are_missing(tree: Path) -> None:
    shutil.copy(tree / "flatgrasp_cli" / "kernels" / "closing.py", tree / "flatgrasp_cli" / "kernels" / "new.py")
    assert version(tree).returncode == 2


def test_ends_of_lines_do_not_count(tree: Path) -> None:
    folder = tree / "flatgrasp_cli" / "kernels"
    before = _freshness.digest(folder)
    source = folder / "closing.py"
    source.write_bytes(source.read_bytes().replace(b"\n", b"\r\n"))
    assert _freshness.digest(folder) == before
