"""Every container gives what was recorded in the order of time, a chunk at a time."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from flatgrasp_cli.recordings.containers import Recording, is_recording, open_recording
from flatgrasp_cli.recordings.containers.merge import in_order
from tests.recordings.containers import CONTAINERS, read
from tests.recordings.writing import (
    CLOUD_TYPE,
    POINTS,
    START_NS,
    STEP_NS,
    cloud_points,
    stamps,
    write_mcap,
)

if TYPE_CHECKING:
    from flatgrasp_cli.recordings.containers.mcap import McapRecording


RECORDINGS = Path(__file__).resolve().parents[3] / "shared" / "data" / "recordings"


@pytest.mark.parametrize("container", CONTAINERS)
def test_every_container_gives_the_clouds_in_order(container: str, tmp_path: Path) -> None:
    path = CONTAINERS[container](tmp_path)
    assert is_recording(path)
    with open_recording(path, "rec", strict=True) as recording:
        assert [(t.name, t.type, t.count) for t in recording.topics] == [(POINTS, CLOUD_TYPE, 5)]
        assert (recording.start_ns, recording.end_ns) == (START_NS, START_NS + 4 * STEP_NS)
        messages = list(recording.messages({POINTS}))
        assert [message.stamp_ns for message in messages] == stamps(5)
        for k, message in enumerate(messages):
            assert message.topic is recording.topics[0]
            assert (message.value.width, message.value.header.frame_id) == (100, "camera")
            np.testing.assert_array_equal(message.value.data.view(np.float32).reshape(-1, 3), cloud_points(k))
        assert list(recording.messages({"/other"})) == []
        assert recording.problems.counts == {}


@pytest.mark.parametrize("container", ["mcap zstd", "ros1", "sqlite folder", "mcap folder", "mcap without chunks"])
def test_a_range_of_time_is_half_open(container: str, tmp_path: Path) -> None:
    messages, _ = read(CONTAINERS[container](tmp_path), start_ns=stamps(5)[1], end_ns=stamps(5)[3])
    assert [message.stamp_ns for message in messages] == stamps(5)[1:3]


def test_messages_are_read_one_chunk_at_a_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from flatgrasp_cli.recordings.containers.mcap import McapRecording

    reads: list[int] = []
    original = McapRecording.read_chunk

    def counting(self: McapRecording, chunk: Any) -> Any:
        reads.append(chunk.offset)
        return original(self, chunk)

    monkeypatch.setattr(McapRecording, "read_chunk", counting)
    with open_recording(write_mcap(tmp_path / "a", count=20), "rec") as recording:
        next(iter(recording.messages({POINTS})))
    assert len(reads) == 1


def test_sources_are_merged_and_opened_when_their_time_comes() -> None:
    opened: list[int] = []

    def source(values: list[int]) -> Any:
        opened.append(values[0])
        yield from values

    lists = [[10, 11], [0, 4], [2, 3, 12]]
    merged: Iterator[int] = in_order([(values[0], partial(source, values)) for values in lists], int)
    assert next(merged) == 0
    assert opened == [0]
    assert list(merged) == [2, 3, 4, 10, 11, 12]


def test_this_package_alone_loads_no_reader() -> None:
    heavy = ("mcap", "rosbags", "lz4", "backports.zstd", "google.protobuf")
    code = f"import sys, flatgrasp_cli.recordings.containers; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.skipif(not RECORDINGS.exists(), reason="the recordings are not here")
@pytest.mark.parametrize(
    ("name", "topics", "messages", "clouds"),
    [
        ("all_messages_mcap", 94, 188, 2),
        ("all_messages_sqlite3", 94, 188, 2),
        ("example-bz2.bag", 9, 8647, 0),
        ("example-lz4.bag", 9, 8647, 0),
        ("example-unsorted-chunks.bag", 1, 3, 0),
        ("kinect_table.bag", 1, 1, 1),
        ("no-messages.bag", 0, 0, 0),
        ("pct_three_clouds.mcap", 1, 3, 3),
        ("cdr_test_0.mcap", 2, 7, 0),
    ],
)
def test_real_recordings(name: str, topics: int, messages: int, clouds: int) -> None:
    recording: Recording
    with open_recording(RECORDINGS / name, name, strict=True) as recording:
        assert len(recording.topics) == topics
        assert sum(topic.count or 0 for topic in recording.topics) == messages
        assert (recording.start_ns is None) == (messages == 0)
        every = list(recording.messages({topic.name for topic in recording.topics}))
        assert [m.stamp_ns for m in every] == sorted(m.stamp_ns for m in every)
        assert len(every) == messages
        assert sum(m.topic.type == CLOUD_TYPE for m in every) == clouds
