"""Kernels that check the bounds of their arrays, which compiled ones otherwise do not, plan the samples."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import SAMPLES

ROOT = SAMPLES.parent
COMPILE = "import hatch_build as h; h.compile_kernels(h.ROOT / h.KERNELS, boundscheck=True)"


@pytest.mark.slow
def test_no_index_leaves_its_array(tmp_path: Path) -> None:
    for name in ("flatgrasp_cli", "configs"):
        shutil.copytree(ROOT / name, tmp_path / name)
    shutil.copy(ROOT / "hatch_build.py", tmp_path)
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    for command in (["-c", COMPILE], ["-m", "flatgrasp_cli", "plan", *map(str, SAMPLES.glob("*.pcd")), "--json"]):
        done = subprocess.run(
            [sys.executable, *command], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        assert "IndexError" not in done.stderr  # which what is inlined can only report
