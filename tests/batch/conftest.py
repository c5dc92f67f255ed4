"""A recording of many frames, a cloud, and the files of a batch of both that nothing disturbed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.batch.batches import FAST, LONG, files, record
from tests.cli.command_line import called
from tests.plates import slab, write_pcd


@pytest.fixture(scope="session")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("recordings") / "long", LONG)


@pytest.fixture(scope="session")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pcd(tmp_path_factory.mktemp("clouds") / "plate.pcd", slab(120, 40, points=400))


@pytest.fixture(scope="session")
def whole_folder(long: Path, plate: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a batch that nothing disturbed."""
    out = tmp_path_factory.mktemp("whole") / "out"
    assert called("batch", long, plate, "-o", out, "-j", "1", *FAST) == (0, "")
    return out


@pytest.fixture(scope="session")
def whole(whole_folder: Path) -> dict[str, str]:
    """The files of it."""
    return files(whole_folder)
