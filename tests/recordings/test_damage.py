"""Damaged recordings give what can be read of them, and say where what follows is lost."""

from __future__ import annotations

import sqlite3
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from mcap.writer import CompressionType

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers import Problems, open_recording
from tests.recordings.containers import CONTAINERS, NONE, read
from tests.recordings.writing import (
    BARE,
    CLOUD_TYPE,
    POINTS,
    raw_cloud,
    stamps,
    write_mcap,
    write_ros1,
    write_rosbag2,
)

if TYPE_CHECKING:
    from flatgrasp_cli.recordings.containers.mcap import McapRecording
    from flatgrasp_cli.recordings.containers.ros1_bag import Ros1Recording


@pytest.mark.parametrize("container", ["mcap none", "mcap zstd", "mcap lz4", "mcap without chunks", "ros1", "ros1 lz4"])
def test_truncated_recordings_give_what_can_be_read(container: str, tmp_path: Path) -> None:
    path = CONTAINERS[container](tmp_path)
    data = path.read_bytes()
    least = 0
    for size in range(len(data) // 2, len(data), 97):
        path.write_bytes(data[:size])
        messages, problems = read(path)
        assert [m.stamp_ns for m in messages] == stamps(5)[: len(messages)]
        assert len(messages) >= least
        assert any("byte" in text or "not closed" in text for text in problems)
        least = len(messages)
        with pytest.raises(SourceError, match=r"^rec: "), open_recording(path, "rec", strict=True) as recording:
            list(recording.messages({POINTS}))
    assert least == 5


def test_place_of_truncation(tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "a", compression=NONE, use_chunking=False)
    data = path.read_bytes()
    third = data.index(raw_cloud(2)) - 31
    path.write_bytes(data[: third + 500])
    messages, problems = read(path)
    assert len(messages) == 2
    assert problems == {
        f"truncated at byte {third}: the record there runs beyond the end of the file at byte {third + 500}; "
        "what comes after is lost": 1
    }


@pytest.mark.parametrize("compression", [NONE, CompressionType.ZSTD, CompressionType.LZ4])
@pytest.mark.parametrize("options", [{}, BARE])
def test_corrupt_chunk_is_skipped(compression: CompressionType, options: dict[str, Any], tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "a", count=6, compression=compression, **options)
    data = bytearray(path.read_bytes())
    chunks = [k for k in range(len(data)) if data[k] == 6 and data[k + 9 : k + 17] == struct.pack("<Q", stamps(6)[1])]
    assert len(chunks) == 1
    for k in range(20):
        data[chunks[0] + 200 + k] ^= 0xFF
    path.write_bytes(data)
    messages, problems = read(path)
    assert [m.stamp_ns for m in messages] == stamps(6)[:1] + stamps(6)[3:]
    assert len(problems) == 1
    assert next(iter(problems)).startswith(f"chunk at byte {chunks[0]} skipped: ")


def test_unindexed_ros1_bag(tmp_path: Path) -> None:
    path = write_ros1(tmp_path / "a", count=6)
    data = path.read_bytes()
    at = data.index(b"index_pos=") + len(b"index_pos=")
    (index,) = struct.unpack_from("<Q", data, at)
    path.write_bytes(data[:at] + bytes(8) + data[at + 8 : index])
    messages, problems = read(path)
    assert [m.stamp_ns for m in messages] == stamps(6)
    assert problems == {"not closed by its recorder, or truncated: it has no index": 1}


def test_ros1_bag_cut_between_two_chunks(tmp_path: Path) -> None:
    path = write_ros1(tmp_path / "a", count=6)
    data = path.read_bytes()
    at = data.index(b"index_pos=") + len(b"index_pos=")
    (index,) = struct.unpack_from("<Q", data, at)
    with open_recording(path, "rec") as recording:
        second = cast("Ros1Recording", recording).chunks[1].offset
    path.write_bytes(data[:second])
    messages, problems = read(path)
    assert [m.stamp_ns for m in messages] == stamps(6)[: len(messages)]
    assert 0 < len(messages) < 6
    assert problems == {f"truncated at byte {second}, before its index at byte {index}; what comes after is lost": 1}


@pytest.mark.parametrize(
    ("times", "count"),
    [({"start_ns": 2**70}, 0), ({"end_ns": -(2**70)}, 0), ({"start_ns": -(2**70), "end_ns": 2**70}, 5)],
)
def test_times_beyond_a_database_are_no_damage(times: dict[str, Any], count: int, tmp_path: Path) -> None:
    messages, problems = read(write_rosbag2(tmp_path / "bag"), **times)
    assert (len(messages), problems) == (count, {})


def test_names_in_problems_are_printable() -> None:
    problems = Problems()
    problems.add("message on /a\x1b[31m\n that is bad")
    assert problems.counts == {"message on /a\\x1b[31m\\n that is bad": 1}


def test_message_that_cannot_be_decoded(tmp_path: Path) -> None:
    path = write_rosbag2(tmp_path / "bag")
    database = sqlite3.connect(path / "bag.db3")
    database.execute("UPDATE messages SET data = substr(data, 1, 100) WHERE id IN (2, 3)")
    database.commit()
    database.close()
    messages, problems = read(path)
    assert [m.stamp_ns for m in messages] == [stamps(5)[k] for k in (0, 3, 4)]
    assert list(problems.values()) == [2]
    assert next(iter(problems)).startswith(f"bag.db3: message on {POINTS} that could not be decoded (")


FUZZED = ["mcap zstd", "mcap none", "mcap without summary", "mcap without chunks", "ros1", "ros1 bz2", "db3 alone"]


@pytest.mark.parametrize("container", FUZZED)
def test_any_bytes_give_an_error_in_words_at_most(container: str, tmp_path: Path) -> None:
    path = CONTAINERS[container](tmp_path)
    data = path.read_bytes()
    random = np.random.default_rng(7)
    for _ in range(60):
        damaged = bytearray(data)
        for _ in range(random.integers(1, 6)):
            damaged[random.integers(len(damaged))] = random.integers(256)
        if random.random() < 0.3:
            del damaged[random.integers(len(damaged)) :]
        path.write_bytes(damaged)
        try:
            messages, _ = read(path)
        except SourceError as error:
            assert str(error).startswith("rec: ")  # noqa: PT017 most of the files can be read
        else:
            assert len(messages) <= 6


def test_an_index_that_points_where_no_file_can_be_is_damage(tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "a", compression=CompressionType.NONE, enable_crcs=False)
    with open_recording(path, "rec") as recording:
        place = cast("McapRecording", recording).chunks[0].offset
    data = bytearray(path.read_bytes())
    at = data.index(struct.pack("<Q", place))
    data[at : at + 8] = b"\xff" * 8
    path.write_bytes(data)
    messages, problems = read(path)
    assert 0 < len(messages) < 5
    assert problems


def test_a_channel_that_only_a_chunk_declares_is_no_topic(tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "a", compression=CompressionType.NONE, enable_crcs=False)
    data = bytearray(path.read_bytes())
    at = data.index(struct.pack("<I", len(POINTS)) + POINTS.encode()) - 4
    data[at : at + 4] = struct.pack("<HH", 9, 0)  # another id, and no schema
    path.write_bytes(data)
    with open_recording(path, "rec") as recording:
        for _ in range(2):
            assert {message.topic.type for message in recording.messages([POINTS])} == {CLOUD_TYPE}


def test_ros1_chunks_beyond_damage_are_found_by_the_index(tmp_path: Path) -> None:
    path = write_ros1(tmp_path / "a", count=6)
    data = bytearray(path.read_bytes())
    with open_recording(path, "rec") as recording:
        second = cast("Ros1Recording", recording).chunks[1].offset
    data[second : second + 4] = bytes(4)
    path.write_bytes(data)
    messages, problems = read(path)
    assert 0 < len(messages) < 6
    assert messages[-1].stamp_ns == stamps(6)[-1]
    assert f"truncated or damaged at byte {second}; what comes after is lost" in problems


def test_database_cut_short(tmp_path: Path) -> None:
    path = write_rosbag2(tmp_path / "bag", count=200) / "bag.db3"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(SourceError, match=r"^rec: the SQLite file is damaged"):
        open_recording(path, "rec", strict=True)


def test_zstd_file_cut_short(tmp_path: Path) -> None:
    path = CONTAINERS["mcap zstd file"](tmp_path)
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(SourceError, match=r"^rec: its zstd compression is damaged or cut short"):
        open_recording(path, "rec", strict=True)
