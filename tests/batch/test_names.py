"""A batch of files whose names are no UTF-8, or have in them what other programs would obey."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote_to_bytes

import pytest

from tests.batch.batches import COMMAND, FAST, documents
from tests.conftest import Run

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the file system has no names but in UTF-8")
LATIN_1 = "gr\udcf6\udcdfe.pcd"
ODD = (
    "a.pcd",
    "n\nl.pcd",
    "t\tb.pcd",
    "e\x1b[31m.pcd",
    "q\"u'o.pcd",
    "h#a.pcd",
    "p%41.pcd",
    "-g.pcd",
    "z.pcd",
    LATIN_1,
)


@pytest.fixture
def folder(plate: Path, run: Run) -> Path:  # noqa: ARG001 (it makes the folder)
    """Clouds with odd names, in a folder with one."""
    folder = Path("f\udcf6lder")
    folder.mkdir()
    for name in ODD:
        shutil.copy(plate, folder / name)
    return folder


def test_every_file_is_planned_once_and_named_in_utf_8(folder: Path, run: Run) -> None:
    (folder / "bro\udcf6ken.pcd").write_bytes(b"nothing")
    ours = ("-o", "out", "-j", "1", *FAST)
    done = run("batch", folder, *ours)
    assert (done.code, r"f\xf6lder/bro\xf6ken.pcd: is neither" in done.err) == (3, True)
    summary = json.loads(Path("out/summary.json").read_text(encoding="utf-8"))
    assert (summary["inputs"], summary["failed"], summary["grasped"]) == (len(ODD) + 1, 1, len(ODD))
    names = {one["source"]: one["results"] for one in summary["by_input"]}
    assert set(names) >= {r"f\xf6lder/gr\xf6\xdfe.pcd", r"f\xf6lder/bro\xf6ken.pcd", "f\\xf6lder/n\nl.pcd"}
    (document,) = documents(Path("out") / names[r"f\xf6lder/gr\xf6\xdfe.pcd"])
    assert document["source"]["path"] == r"f\xf6lder/gr\xf6\xdfe.pcd"
    links = Path("out/report.html").read_text(encoding="utf-8").split('href="./')[1:]
    linked = {unquote_to_bytes(link.partition('"')[0]) for link in links}
    assert {f"../{folder / name}".encode("utf-8", "surrogateescape") for name in ODD} <= linked
    (folder / "bro\udcf6ken.pcd").unlink()
    made = {path: path.stat().st_mtime_ns for path in Path("out").glob("*.jsonl")}
    assert run("batch", folder, *ours).code == 0
    assert {path: path.stat().st_mtime_ns for path in Path("out").glob("*.jsonl")} == made


@pytest.mark.usefixtures("blank_pictures")
def test_pictures_and_bags_are_made_and_the_folder_of_results_may_be_called_so_too(folder: Path, run: Run) -> None:
    done = run("batch", folder / LATIN_1, "-o", "o\udcf6t", "-j", "1", "--plots", "--bag", "b\udcf6g.mcap", *FAST)
    assert done.code == 0, done.err
    assert Path("b\udcf6g.mcap").exists()
    assert {path.name for path in Path("o\udcf6t").iterdir()} >= {"gr__e.pcd.jsonl", "gr__e.pcd.view.html"}
    assert r"gr\xf6\xdfe.pcd" in (Path("o\udcf6t") / "gr__e.pcd.view.html").read_text(encoding="utf-8")


def test_a_list_has_paths_as_find_writes_them(folder: Path, run: Run) -> None:
    listed = "".join(f"{folder / name}\r\n" for name in ODD if "\n" not in name).encode("utf-8", "surrogateescape")
    Path("list").write_bytes(listed + b"\n")
    for where, stdin in (("list", b""), ("-", listed)):
        done = run("batch", "--from-list", where, "-o", f"of {where}", "-j", "1", *FAST, stdin=stdin)
        assert (done.code, f"{len(ODD) - 1} of {len(ODD) - 1} frames" in done.err) == (0, True)
    for content in ("a.pcd".encode("utf-16"), b"\0"):
        Path("list").write_bytes(content)
        done = run("batch", "--from-list", "list", "-o", "none")
        assert (done.code, "list: is no text" in done.err) == (2, True)


def test_a_list_on_closed_standard_input_is_said(tmp_path: Path) -> None:
    closed = ["sh", "-c", 'exec "$@" <&-', "sh", *COMMAND, "--from-list", "-", "-o", "none"]
    done = subprocess.run(closed, cwd=tmp_path, capture_output=True, check=False, text=True)
    assert (done.returncode, done.stderr) == (2, "flatgrasp: --from-list -: standard input is closed\n")
