"""A recording of many frames, a cloud, and the files of a batch of both that nothing disturbed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.batch.batches import FAST, LONG, batch, files, record
from tests.plates import slab, write_pcd


@pytest.fixture(scope="session")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("recordings") / "long", LONG)


@pytest.fixture(scope="session")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pcd(tmp_path_factory.mktemp("clouds") / "plate.pcd", slab(120, 40, points=400))


@pytest.fixture(scope="session")
def whole(long: Path, plate: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The files of a batch that nothing disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    assert batch(long, plate, "-o", "out", "-j", "1", *FAST, cwd=folder).returncode == 0
    return files(folder / "out")
