"""Folders of a recording's files: bags in parts, their metadata, and what is no recording."""

from __future__ import annotations

from pathlib import Path

import pytest
from backports import zstd

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers import is_recording, open_recording
from tests.recordings.containers import CONTAINERS, read
from tests.recordings.writing import (
    POINTS,
    stamps,
    write_mcap,
    write_rosbag2,
)


def _split(folder: Path, times: list[list[int]]) -> Path:
    """A folder of MCAP files without metadata."""
    folder.mkdir()
    for n, order in enumerate(times):
        write_mcap(folder / f"bag_{n}.mcap", count=9, order=order)
    return folder


def test_split_bags_are_read_in_order_of_time(tmp_path: Path) -> None:
    folder = _split(tmp_path / "bag", [[4, 5, 7], [0, 1, 2, 3], [6, 8]])
    messages, problems = read(folder)
    assert [m.stamp_ns for m in messages] == stamps(9)
    assert problems == {"metadata.yaml is missing; the storage files in the folder are read": 1}
    with open_recording(folder, "rec") as recording:
        assert [topic.count for topic in recording.topics] == [9]
        assert recording.container == "rosbag2 folder (3 × MCAP, zstd chunks)"


@pytest.mark.parametrize("text", ["", "{", "[1]", "rosbag2_bagfile_information: {relative_file_paths: 3}", "[" * 5000])
def test_wrong_metadata_is_not_needed(text: str, tmp_path: Path) -> None:
    folder = write_rosbag2(tmp_path / "bag")
    (folder / "metadata.yaml").write_text(text)
    messages, problems = read(folder)
    assert len(messages) == 5
    assert list(problems.values()) == [1]
    assert next(iter(problems)).startswith("metadata.yaml cannot be used")


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("{", "it is no YAML"),
        ("[1]", "it has no rosbag2_bagfile_information"),
        ("rosbag2_bagfile_information: 5", "it has no rosbag2_bagfile_information"),
        ("rosbag2_bagfile_information: {relative_file_paths: 3}", "it lists no files"),
    ],
)
def test_wrong_metadata_is_told_in_words(text: str, fault: str, tmp_path: Path) -> None:
    folder = write_rosbag2(tmp_path / "bag")
    (folder / "metadata.yaml").write_text(text)
    told = f"metadata.yaml cannot be used ({fault}); the storage files in the folder are read"
    assert read(folder)[1] == {told: 1}


def test_missing_and_broken_files_of_a_folder(tmp_path: Path) -> None:
    folder = write_rosbag2(tmp_path / "bag")
    metadata = folder / "metadata.yaml"
    (folder / "bad.db3").write_bytes(b"no database")
    metadata.write_text(metadata.read_text().replace("- bag.db3", "- bag.db3\n  - gone.db3\n  - bad.db3"))
    messages, problems = read(folder)
    assert len(messages) == 5
    assert sorted(problems) == [
        "bad.db3: is no MCAP file, ROS bag or SQLite file (it begins with b'no database')",
        "gone.db3 is missing, though metadata.yaml lists it",
    ]
    (folder / "bag.db3").unlink()
    with pytest.raises(SourceError, match=r"^rec: bad\.db3: is no MCAP file"):
        open_recording(folder, "rec")


def test_temporary_copies_are_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    with open_recording(CONTAINERS["sqlite folder, zstd files"](tmp_path), "rec") as recording:
        assert len(list(recording.messages({POINTS}))) == 5
        assert len(list((tmp_path / "tmp").iterdir())) == 1
    assert list((tmp_path / "tmp").iterdir()) == []


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "the file is empty"),
        (b"hello", "is no MCAP file, ROS bag or SQLite file"),
        (b"#ROSBAG V1.2\n", "is a ROS bag of the format '#ROSBAG V1.2', not 2.0; convert it with `rosbag fix`"),
        (b"SQLite format 3\0" + bytes(100), "the SQLite file is damaged"),
        (zstd.compress(b"hello"), "is no MCAP file"),
    ],
)
def test_what_is_no_recording(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    with pytest.raises(SourceError, match=r"^rec: ") as raised:
        open_recording(path, "rec")
    assert words in str(raised.value)
    assert is_recording(path) == content.startswith((b"#ROSBAG", b"SQLite"))


def test_folders_that_are_no_recordings(tmp_path: Path) -> None:
    assert not is_recording(tmp_path)
    (tmp_path / "metadata.yaml").write_text("a: 1")
    assert not is_recording(tmp_path)
    with pytest.raises(SourceError, match=r"^rec: the folder has no \.mcap or \.db3 file to read$"):
        open_recording(tmp_path, "rec")
    assert not is_recording(tmp_path / "gone")
    with pytest.raises(SourceError, match=r"^rec: cannot be read: No such file or directory$"):
        open_recording(tmp_path / "gone", "rec")
