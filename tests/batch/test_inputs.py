"""Which sources a batch has, and the slices of time that a long one is split into."""

from __future__ import annotations

import os
from itertools import pairwise
from pathlib import Path

from flatgrasp_cli.batch.inputs import find_inputs, fingerprint
from flatgrasp_cli.batch.slices import FRAMES, slices_of
from flatgrasp_cli.sources.selection import Every, Moment, Selection
from tests.batch.batches import LONG, PERIOD_NS
from tests.conftest import SAMPLES, Run
from tests.recordings.writing import START_NS


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


def test_links_back_are_not_followed(tmp_path: Path, plate: Path) -> None:
    (tmp_path / "night").mkdir()
    (tmp_path / "night" / "plate.pcd").write_bytes(plate.read_bytes())
    (tmp_path / "night" / "self").symlink_to(tmp_path / "night")
    (tmp_path / "night" / "up").symlink_to(tmp_path)
    assert [item.name for item in find_inputs([str(tmp_path / "night")])] == ["plate.pcd"]


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
