"""Sources whose names are no UTF-8 are read like all others, and every document names them in UTF-8."""

from __future__ import annotations

import csv
import json
import shutil
import sys
from pathlib import Path

import pytest

from flatgrasp_cli.recordings.containers import open_recording
from tests.conftest import Run

LATIN_1 = "gr\udcf6\udcdfe"
CALLED = r"gr\xf6\xdfe"
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the file system has no names but in UTF-8")


@pytest.fixture
def source(plate: Path, run: Run) -> str:  # noqa: ARG001 (it makes the folder)
    """A cloud in the current folder."""
    shutil.copy(plate, f"{LATIN_1}.pcd")
    return f"{LATIN_1}.pcd"


@pytest.mark.usefixtures("blank_pictures")
def test_it_is_planned_and_found_again_by_its_name(source: str, run: Run) -> None:
    assert run("plan", source, "-o", "out").code == 0
    assert sorted(path.name for path in Path("out").iterdir()) == ["gr__e.grasps.json", "gr__e.grasps.png"]
    document = json.loads(Path("out/gr__e.grasps.json").read_text(encoding="utf-8"))
    assert document["source"]["path"] == f"{CALLED}.pcd"
    assert run("view", "out/gr__e.grasps.json", "-o", "again.html") == (0, "", "flatgrasp: wrote again.html\n")
    Path(source).rename(Path("out") / source)  # beside the document, as others are found that were moved with it
    assert run("view", "out/gr__e.grasps.json", "-o", "beside.html").err == "flatgrasp: wrote beside.html\n"
    (Path("out") / source).unlink()
    gone = run("view", "out/gr__e.grasps.json", "-o", "gone.html")
    assert gone.code == 0
    assert f"{CALLED}.pcd: cannot be read: No such file or directory" in gone.err


def test_what_others_read_is_utf_8(source: str, run: Run) -> None:
    done = run("plan", source, "--json", "--bag", "out.mcap")
    assert done.code == 0
    assert json.loads(done.out)["source"]["path"] == f"{CALLED}.pcd"
    with open_recording(Path("out.mcap"), "out.mcap") as bag:
        assert bag.topics
    Path(f"{LATIN_1}.json").write_text(done.out, encoding="utf-8")
    assert run("export", f"{LATIN_1}.json", "--format", "csv", "-o", "tables").code == 0
    with (Path("tables") / f"{LATIN_1}.grasps.csv").open(encoding="utf-8") as table:
        assert {row["source"] for row in csv.DictReader(table)} == {f"{CALLED}.pcd"}
    assert run("view", source, "-o", "page.html").code == 0
    assert f"flatgrasp: {CALLED}.pcd" in Path("page.html").read_text(encoding="utf-8")


def test_all_commands_say_its_name(source: str, run: Run) -> None:
    assert json.loads(run("inspect", source, "--json").out)["path"] == f"{CALLED}.pcd"
    assert json.loads(run("compare", source, "--json").out)["source"] == f"{CALLED}.pcd"
    assert json.loads(run("cage", source, "--json").out.splitlines()[0])["source"] == f"{CALLED}.pcd"
    polygon = f"{LATIN_1}.json"
    Path(polygon).write_text("[[0, 0], [4, 0], [2, 1], [4, 2], [0, 2], [1, 1]]", encoding="utf-8")
    assert json.loads(run("cage", polygon, "--json").out)["source"] == f"{CALLED}.json"
    Path(source).write_bytes(b"nothing")
    for command in ("plan", "inspect", "compare", "cage", "view"):
        done = run(command, source)
        assert (done.code, done.err.partition(":")[0]) == (3, "flatgrasp")
        assert f"{CALLED}.pcd: is neither" in done.err


def test_an_image_of_a_folder_is_called_so_too(run: Run) -> None:
    import numpy as np

    Path("images").mkdir()
    np.save(f"images/{LATIN_1}.npy", np.full((4, 4), 0.7, dtype=np.float32))
    done = run("plan", "images", "--intrinsics", "5,5,2,2", "--json")
    assert json.loads(done.out)["source"]["path"] == f"images/{CALLED}.npy"


def test_profiles_of_such_names_are_checked(run: Run) -> None:
    Path(f"{LATIN_1}.yaml").write_text(run("profiles", "show", "pr2").out, encoding="utf-8")
    assert run("profiles", "check", f"{LATIN_1}.yaml") == (0, f"{CALLED}.yaml: ok\n", "")


@pytest.mark.parametrize("option", ["--topic", "--base-frame", "--sensor"])
def test_what_comes_into_documents_and_is_no_path_is_refused(option: str, source: str, run: Run) -> None:
    for command in (("plan",), ("batch", "-o", "out")):
        done = run(*command, source, option, "b\udcf6")
        assert (done.code, done.out) == (2, "")
        assert rf"{option}': b\xf6 is no text in UTF-8" in done.err
    assert "stdin" not in run("plan", source, option, "-").err
