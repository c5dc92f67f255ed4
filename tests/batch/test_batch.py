"""Batch: the same answers as plan, on any executor, and no work lost however it ends."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer

from flatgrasp_cli import __version__
from flatgrasp_cli.batch import run as run_module
from flatgrasp_cli.batch.inputs import find_inputs, fingerprint
from flatgrasp_cli.batch.slices import FRAMES, slices_of
from flatgrasp_cli.batch.store import Store
from flatgrasp_cli.batch.summary import chosen, summarize
from flatgrasp_cli.batch.work import work as work_of_a_slice
from flatgrasp_cli.sources.selection import Every, Moment, Selection
from flatgrasp_cli.whole_files import write_text
from tests.cli.test_cli import slab, write_pcd
from tests.conftest import SAMPLES, Ended, Run
from tests.recordings.writing import CLOUD_TYPE, POINTS, ROS2, START_NS
from tests.sources.test_recordings import cloud_message

PERIOD_NS = 100_000_000
LONG = 4 * FRAMES
FAST = ("--gripper", "pr2", "--scene", "object", "--top", "1")
COMMAND = [sys.executable, "-m", "flatgrasp_cli", "batch"]


def record(path: Path, frames: int) -> Path:
    """A rosbag2 of plates that turn slowly, each frame another answer."""
    plate = slab(120, 40, points=400)
    with Ros2Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        for k in range(frames):
            c, s = np.cos(0.01 * k), np.sin(0.01 * k)
            points = (plate @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0, 0, 1]).astype(np.float32)
            message = cloud_message(ROS2, points, "packed")
            message.header.stamp.nanosec = k
            writer.write(connection, START_NS + k * PERIOD_NS, ROS2.serialize_cdr(message, CLOUD_TYPE))
    return path


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("recordings") / "long", LONG)


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pcd(tmp_path_factory.mktemp("clouds") / "plate.pcd", slab(120, 40, points=400))


def documents(path: Path | str) -> list[Any]:
    """The documents of a file or of plan's output, without their times."""
    text = path.read_text() if isinstance(path, Path) else path
    found = [json.loads(line) for line in text.splitlines()]
    for document in found:
        del document["timing_ms"]
    return found


def files(out: Path) -> dict[str, str]:
    """All results but times: documents, and what the state keeps."""
    texts = {}
    for path in sorted(out.rglob("*.jsonl")):
        texts[str(path.relative_to(out))] = re.sub(r'"timing_ms": ?\{[^}]*\}', "", path.read_text())
    return texts


# --- inputs -----------------------------------------------------------------------------------------------------------


def test_names_lead_nowhere_but_down_and_do_not_collide(tmp_path: Path) -> None:
    for name in ("a/x.pcd", "b/x.pcd", "b/X.pcd", "b/so long; rm *.ply", ".hidden/y.pcd", "notes.txt"):
        path = tmp_path / "night" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    found = find_inputs([str(tmp_path / "night"), str(tmp_path / "night/a/x.pcd"), f"{tmp_path}/night/a/../b/x.pcd"])
    assert sorted(item.name for item in found) == ["a/x.pcd", "b/X.pcd", "b/so_long__rm__.ply", "b/x.pcd-2", "x.pcd"]
    (up,) = find_inputs(["../../etc/passwd"])
    assert up.name == "passwd"


def test_globs_and_folders(tmp_path: Path) -> None:
    for name in ("a.pcd", "b.pcd", "c.ply"):
        (tmp_path / name).touch()
    assert [item.name for item in find_inputs([f"{tmp_path}/*.pcd"])] == ["a.pcd", "b.pcd"]
    names = [item.name for item in find_inputs([str(SAMPLES)])]
    assert names[-3:] == ["spray_bottle.pcd", "table_scene.pcd", "teddy_bear.pcd"]
    assert "pan_ros2" in names


def test_an_empty_folder_is_an_error(run: Run, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    done = run("batch", tmp_path / "empty", "-o", "out")
    assert done.code == 3
    assert "holds no clouds, meshes or recordings" in done.err
    assert run("batch", "-o", "out").code == 2


def test_a_fingerprint_tells_a_changed_input(tmp_path: Path) -> None:
    path = tmp_path / "cloud.pcd"
    path.write_bytes(b"1234")
    before = fingerprint(str(path))
    assert fingerprint(str(path)) == before
    os.utime(path, ns=(1, 1))
    touched = fingerprint(str(path))
    path.write_bytes(b"1235")
    os.utime(path, ns=(1, 1))
    assert len({before, touched, fingerprint(str(path)), fingerprint(str(tmp_path / "gone"))}) == 4


# --- slices -----------------------------------------------------------------------------------------------------------


def test_slices_cover_a_recording_without_overlap(long: Path) -> None:
    (item,) = find_inputs([str(long)])
    pieces = slices_of(item, Selection())
    assert len(pieces) == LONG // FRAMES
    assert [piece.index for piece in pieces] == list(range(len(pieces)))
    assert all(a.end_ns == b.start_ns for a, b in pairwise(pieces))
    assert pieces[0].start_ns == START_NS
    assert pieces[-1].end_ns == START_NS + (LONG - 1) * PERIOD_NS + 1
    half = slices_of(item, Selection(start=Moment(LONG // 2 * PERIOD_NS, absolute=False)))
    assert half[0].start_ns == START_NS + LONG // 2 * PERIOD_NS
    for counted in (Selection(count=5), Selection(every=Every(frames=2)), Selection(at=Moment(0, absolute=False))):
        assert len(slices_of(item, counted)) == 1


# --- the same answers as plan -----------------------------------------------------------------------------------------


def test_documents_are_those_of_plan(long: Path, plate: Path, run: Run) -> None:
    done = run("batch", long, plate, "-o", "out", "-j", "1", *FAST)
    assert (done.code, done.out) == (0, "")
    assert documents(Path("out/long.jsonl")) == documents(run("plan", long, "--json", *FAST).out)
    assert documents(Path("out/plate.pcd.jsonl")) == documents(run("plan", plate, "--json", *FAST).out)
    assert not list(Path("out").rglob("*.part"))
    assert not list(Path("out/.flatgrasp").rglob("parts/*/*"))


def batch(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def whole(long: Path, plate: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The files of a batch that nothing disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    assert batch(long, plate, "-o", "out", "-j", "1", *FAST, cwd=folder).returncode == 0
    return files(folder / "out")


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


def test_every_object_of_a_scene_is_in_the_report(run: Run) -> None:
    assert run("batch", SAMPLES / "table_scene.pcd", "-o", "out", "-j", "1", "--gripper", "pr2", "--plots").code == 0
    page = Path("out/report.html").read_text()
    (document,) = documents(Path("out/table_scene.pcd.jsonl"))
    assert page.count("<path") == len(document["objects"]) == 4
    for thing in document["objects"]:
        best = thing["grasps"][0] if thing["grasps"] else None
        line = f"{1000 * best['width_m']:.0f} mm wide" if best else "no grasp: "
        assert f"<li>{thing['id']}: {line}" in page
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
    assert rows[1]["width_m"] in (None, "")
    assert "opens 0.090 m" in rows[1]["reason"]


def test_pictures_on_request(plate: Path, run: Run) -> None:
    assert run("batch", plate, SAMPLES / "pan_ros2", "-o", "out", "-j", "1", "--plots", "--gripper", "pr2").code == 0
    pictures = sorted(str(path.relative_to("out")) for path in Path("out").rglob("*.png"))
    assert pictures == [
        *(f"pan_ros2/1700000000.{ns}00000000.grasps.png" for ns in (0, 2, 4)),
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


# --- never lose work --------------------------------------------------------------------------------------------------


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


def test_an_input_that_vanishes_costs_only_itself(long: Path, plate: Path, run: Run, tmp_path: Path) -> None:
    done = run("batch", long, tmp_path / "gone.bag", plate, "-o", "out", "-j", "1", *FAST)
    assert done.code == 3
    assert "gone.bag" in done.err
    assert {path.name for path in Path("out").glob("*.jsonl")} == {"long.jsonl", "plate.pcd.jsonl"}


def test_quiet(plate: Path, run: Run) -> None:
    assert run("batch", plate, "-o", "out", "-j", "1", "--quiet", *FAST) == (0, "", "")


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


def test_links_back_are_not_followed(tmp_path: Path, plate: Path) -> None:
    (tmp_path / "night").mkdir()
    (tmp_path / "night" / "plate.pcd").write_bytes(plate.read_bytes())
    (tmp_path / "night" / "self").symlink_to(tmp_path / "night")
    (tmp_path / "night" / "up").symlink_to(tmp_path)
    assert [item.name for item in find_inputs([str(tmp_path / "night")])] == ["plate.pcd"]
