"""A batch gives the same answers as plan, on any executor, and a summary, a table and a report of them."""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from flatgrasp_cli import __version__
from flatgrasp_cli.batch.inputs import find_inputs
from flatgrasp_cli.batch.store import Store
from flatgrasp_cli.batch.summary import chosen, summarize
from tests.batch.batches import FAST, batch, documents, files
from tests.conftest import SAMPLES, Run
from tests.plates import slab, write_pcd


def test_documents_are_those_of_plan(whole_folder: Path, long: Path, plate: Path, run: Run) -> None:
    assert documents(whole_folder / "long.jsonl") == documents(run("plan", long, "--json", *FAST).out)
    assert documents(whole_folder / "plate.pcd.jsonl") == documents(run("plan", plate, "--json", *FAST).out)
    assert not list(whole_folder.rglob("*.part"))
    assert not list((whole_folder / ".flatgrasp").rglob("parts/*/*"))


@pytest.mark.parametrize("where", [("-j", "2"), ("-j", "2", "--cluster", "local")], ids=["processes", "dask"])
def test_every_executor_gives_the_same(
    where: tuple[str, ...], whole: dict[str, str], long: Path, plate: Path, tmp_path: Path
) -> None:
    done = batch(long, plate, "-o", "out", *where, *FAST, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "")
    assert "Traceback" not in done.stderr
    assert files(tmp_path / "out") == whole


def test_summary_table_and_report(plate: Path, run: Run, tmp_path: Path) -> None:
    broken = tmp_path / "<b>broken & bad.pcd"
    broken.write_text("no cloud")
    wide = write_pcd(tmp_path / "wide.pcd", slab(300, 300, points=8000))
    done = run("batch", plate, broken, wide, "-o", "out", "-j", "1", *FAST)
    assert done.code == 3
    assert str(broken) in done.err
    summary = json.loads(Path("out/summary.json").read_text())
    assert (summary["inputs"], summary["failed"], summary["frames"], summary["grasped"]) == (3, 1, 2, 1)
    assert sum(summary["no_grasp_by_stage"].values()) == 1
    assert summary["by_input"][0]["source"] == str(broken)  # failures first
    page = Path("out/report.html").read_text()
    read = Page(page)
    assert read.open == []
    assert all(link.startswith("./") for link in read.links)
    assert all(Path("out", unquote(link)).exists() for link in read.links)
    assert {"./summary.json", "./plate.pcd.jsonl", "./wide.pcd.jsonl"} <= set(read.links)
    assert any(unquote(link).endswith("/<b>broken & bad.pcd") for link in read.links)
    assert page.index("broken") < page.index("wide.pcd") < page.index("plate.pcd")
    assert "<b>broken" not in page
    assert page.count("<svg") == 2
    assert f"flatgrasp {__version__}" in page
    assert "pr2: two fingers on an arc, opens 90 mm" in page
    assert "scene.mode = object" in page
    assert "too wide or too narrow for the gripper (1)" in page


@pytest.mark.usefixtures("blank_pictures")
def test_every_object_of_a_scene_is_in_the_report(run: Run) -> None:
    assert run("batch", SAMPLES / "table_scene.pcd", "-o", "out", "-j", "1", "--gripper", "pr2", "--plots").code == 0
    page = Path("out/report.html").read_text()
    (document,) = documents(Path("out/table_scene.pcd.jsonl"))
    assert page.count("<path") == len(document["objects"]) == 4
    for thing in document["objects"]:
        best = thing["grasps"][0] if thing["grasps"] else None
        line = f"{1000 * best['width_m']:.0f} mm wide" if best else "no grasp: "
        assert f"<li>{thing['id']}: {line}" in page
        assert best is None or f"holds with {100 * best['success']['probability']:.0f} %" in page
    assert 'href="./table_scene.pcd/cloud.grasps.png"' in page


def test_the_first_frame_of_a_worker_is_not_counted_in_the_times_of_frames(run: Run) -> None:
    assert run("batch", SAMPLES / "pan_ros2", "-o", "out", "-j", "1", "--gripper", "pr2").code == 0
    store, (item,) = Store(Path("out")), find_inputs([str(SAMPLES / "pan_ros2")])
    records = list(store.records(item))
    records[0]["timing_ms"] |= {"first": True, "plan": 900.0, "total": 1000.0}
    for record in records[1:]:
        record["timing_ms"] |= {"first": False, "read": 1.0, "scene": 2.0, "plan": 3.0, "total": 6.0}
    path = Path("out/.flatgrasp/done/pan_ros2.jsonl")
    state = path.read_text().splitlines()[0]
    path.write_text("\n".join([state, *map(json.dumps, records)]) + "\n")
    (one,) = summarize(store, [item])
    assert one.median_ms == {"read": 1.0, "scene": 2.0, "plan": 3.0, "total": 6.0}
    assert one.first_ms == [1000.0]


def test_reports_show_frames_of_every_reason() -> None:
    examples: dict[str, list[tuple[int, dict[str, Any]]]] = {
        "pads": [(k, {}) for k in range(20)],
        "reach": [(k, {}) for k in range(20, 22)],
        "": [(30, {})],
    }
    shown = [index for index, _ in chosen(examples)]
    assert shown[:4] == [0, 20, 1, 21]
    assert len(shown) == 12


class Page(HTMLParser):
    """Tags that are not closed, and what a page would fetch."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.links += [value or "" for name, value in attributes if name in {"src", "href", "xlink:href"}]
        if tag not in {"meta", "input"}:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.parametrize("parquet", [True, False])
def test_the_table_has_a_row_for_each_object(
    parquet: bool, plate: Path, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wide = write_pcd(tmp_path / "wide.pcd", slab(300, 300, points=8000))
    if not parquet:
        monkeypatch.setattr("flatgrasp_cli.batch.table.find_spec", lambda _: None)
    assert run("batch", plate, wide, "-o", "out", "-j", "1", *FAST).code == 1
    rows: list[dict[str, Any]]
    if parquet:
        rows = pytest.importorskip("pyarrow.parquet").read_table("out/grasps.parquet").to_pylist()
    else:
        rows = list(csv.DictReader(Path("out/grasps.csv").read_text().splitlines()))
    assert [(row["input"], row["status"]) for row in rows] == [(str(plate), "ok"), (str(wide), "no_grasp")]
    (document,) = documents(Path("out/plate.pcd.jsonl"))
    best = document["objects"][0]["grasps"][0]
    assert float(rows[0]["width_m"]) == best["width_m"]
    assert [float(rows[0][name]) for name in ("qx", "qy", "qz", "qw")] == best["pose"]["orientation"]
    assert float(rows[0]["probability"]) == best["success"]["probability"]
    assert (rows[1]["width_m"] or "", rows[1]["probability"] or "") == ("", "")
    assert "opens 0.090 m" in rows[1]["reason"]


@pytest.mark.usefixtures("blank_pictures")
def test_pictures_on_request(plate: Path, run: Run) -> None:
    sources = (plate, SAMPLES / "pan_ros2", "--count", "2")
    assert run("batch", *sources, "-o", "out", "-j", "1", "--plots", "--gripper", "pr2").code == 0
    pictures = sorted(str(path.relative_to("out")) for path in Path("out").rglob("*.png"))
    assert pictures == [
        *(f"pan_ros2/1700000000.{ns}00000000.grasps.png" for ns in (0, 2)),
        "plate.pcd/cloud.grasps.png",
    ]


def test_sources_from_a_list_and_from_urls(plate: Path, run: Run, tmp_path: Path) -> None:
    pytest.importorskip("fsspec")
    listed = tmp_path / "list.txt"
    listed.write_text(f"{plate}\n\nfile://{SAMPLES}/pan_foxglove.mcap\n")
    assert run("batch", "--from-list", listed, "-o", "out", "-j", "1", "--gripper", "pr2").code == 0
    assert len(documents(Path("out/pan_foxglove.mcap.jsonl"))) == 3
    gone = run("batch", "memory://nowhere/x.pcd", "-o", "other", "-j", "1")
    assert gone.code == 3
    assert "memory://nowhere/x.pcd: cannot be read" in gone.err


CHROMIUM = shutil.which("chromium")


@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_the_report_opens_in_chromium_without_network(plate: Path, run: Run) -> None:
    assert run("batch", plate, SAMPLES / "pan_ros2", "-o", "out", "-j", "1", "--gripper", "pr2").code == 0
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--host-resolver-rules=MAP * ~NOTFOUND", "--dump-dom"]
    page = Path("out/report.html").resolve().as_uri()
    shown = subprocess.run([str(CHROMIUM), *options, page], capture_output=True, text=True, check=True).stdout
    assert "4 of 4 frames with a grasp" in shown
    assert shown.count("<path") == 4
    assert shown.index("pan_ros2") < shown.index("plate.pcd")
