"""Recordings in every container, whole and damaged."""

from __future__ import annotations

import base64
import json
import sqlite3
import struct
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from backports import zstd
from mcap.writer import CompressionType
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers import Problems, Recording, Topic, bounded, is_recording, open_recording
from flatgrasp_cli.recordings.containers.merge import in_order
from tests.recordings.writing import (
    BARE,
    CLOUD_TYPE,
    POINTS,
    ROS1,
    START_NS,
    STEP_NS,
    cloud_points,
    raw_cloud,
    stamps,
    write_mcap,
    write_other_mcap,
    write_ros1,
    write_rosbag2,
)

if TYPE_CHECKING:
    from flatgrasp_cli.recordings.containers.mcap import McapRecording
    from flatgrasp_cli.recordings.containers.ros1_bag import Ros1Recording

RECORDINGS = Path(__file__).resolve().parents[3] / "shared" / "data" / "recordings"
BZ2, LZ4 = Ros1Writer.CompressionFormat.BZ2, Ros1Writer.CompressionFormat.LZ4
NONE = CompressionType.NONE


def _folder(storage: StoragePlugin, mode: CompressionMode) -> Callable[[Path], Path]:
    return lambda folder: write_rosbag2(folder / "bag", storage=storage, compression=mode)


def _alone(write: Callable[[Path], Path]) -> Callable[[Path], Path]:
    """The storage file of a folder without its metadata."""

    def alone(folder: Path) -> Path:
        file = next(file for file in write(folder).iterdir() if file.name != "metadata.yaml")
        return file.rename(folder / "recorded")

    return alone


def _packed(write: Callable[[Path], Path]) -> Callable[[Path], Path]:
    def packed(folder: Path) -> Path:
        path = folder / "packed"
        path.write_bytes(zstd.compress(write(folder).read_bytes()))
        return path

    return packed


SQLITE, MCAP = StoragePlugin.SQLITE3, StoragePlugin.MCAP
CONTAINERS: dict[str, Callable[[Path], Path]] = {
    "mcap zstd": lambda folder: write_mcap(folder / "a"),
    "mcap lz4": lambda folder: write_mcap(folder / "a", compression=CompressionType.LZ4),
    "mcap none": lambda folder: write_mcap(folder / "a", compression=NONE),
    "mcap ros1": lambda folder: write_mcap(folder / "a", encoding="ros1"),
    "mcap without summary": lambda folder: write_mcap(folder / "a", **BARE),
    "mcap without chunks": lambda folder: write_mcap(folder / "a", use_chunking=False),
    "mcap shuffled": lambda folder: write_mcap(folder / "a", order=[2, 0, 1, 4, 3]),
    "mcap zstd file": _packed(lambda folder: write_mcap(folder / "a")),
    "ros1": lambda folder: write_ros1(folder / "a"),
    "ros1 bz2": lambda folder: write_ros1(folder / "a", compression=BZ2),
    "ros1 lz4": lambda folder: write_ros1(folder / "a", compression=LZ4),
    "sqlite folder": _folder(SQLITE, CompressionMode.NONE),
    "sqlite folder, zstd files": _folder(SQLITE, CompressionMode.FILE),
    "sqlite folder, zstd messages": _folder(SQLITE, CompressionMode.MESSAGE),
    "mcap folder": _folder(MCAP, CompressionMode.NONE),
    "mcap folder, zstd files": _folder(MCAP, CompressionMode.FILE),
    "mcap folder, zstd messages": _folder(MCAP, CompressionMode.MESSAGE),
    "db3 alone": _alone(_folder(SQLITE, CompressionMode.NONE)),
    "db3 alone, zstd messages": _alone(_folder(SQLITE, CompressionMode.MESSAGE)),
    "db3 alone, zstd file": _alone(_folder(SQLITE, CompressionMode.FILE)),
}


def read(path: Path, topics: set[str] | None = None, **times: int) -> tuple[list[Any], dict[str, int]]:
    """All messages and problems."""
    with open_recording(path, "rec") as recording:
        messages = list(recording.messages(topics or {topic.name for topic in recording.topics}, **times))
        return messages, dict(recording.problems.counts)


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


# other encodings


def test_json_becomes_namespaces(tmp_path: Path) -> None:
    text = {
        "frame_id": "a",
        "pose": {"position": {"x": 1.5}},
        "data": base64.b64encode(b"xyz").decode(),
        "fields": [{}],
    }
    schema = ("foxglove.PointCloud", "jsonschema", b"{}")
    path = write_other_mcap(tmp_path / "a", "json", schema, [json.dumps(text).encode(), b"{"])
    messages, problems = read(path)
    assert messages[0].topic == Topic(POINTS, "foxglove.PointCloud", "json", 2)
    assert (messages[0].value.pose.position.x, messages[0].value.data) == (1.5, "eHl6")
    assert len(messages) == 1
    assert [(n, text.startswith(f"message on {POINTS} that could not be decoded")) for text, n in problems.items()] == [
        (1, True)
    ]


def test_protobuf(tmp_path: Path) -> None:
    from google.protobuf import descriptor_pb2, timestamp_pb2  # type: ignore[import-untyped,unused-ignore]

    files = descriptor_pb2.FileDescriptorSet()
    file = files.file.add(name="cloud.proto", package="foxglove", syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    kind = file.message_type.add(name="PointCloud")
    kind.field.add(name="timestamp", number=1, type=11, label=1, type_name=".google.protobuf.Timestamp")
    kind.field.add(name="frame_id", number=2, type=9, label=1)
    kind.field.add(name="data", number=3, type=12, label=1)
    timestamp_pb2.DESCRIPTOR.CopyToProto(files.file.add())
    schema = ("foxglove.PointCloud", "protobuf", files.SerializeToString())
    path = write_other_mcap(tmp_path / "a", "protobuf", schema, [b"\x0a\x02\x08\x07\x12\x01c\x1a\x02\x01\x02", b"\xff"])
    messages, problems = read(path)
    assert [(m.value.timestamp.seconds, m.value.frame_id, m.value.data) for m in messages] == [(7, "c", b"\x01\x02")]
    assert problems == {f"message on {POINTS} that could not be decoded (no valid protobuf)": 1}


IDL = b"""module a { module msg {
  @verbatim(language="comment", text="a (nested (text))")
  struct B { long x; string y; };
}; };"""


def test_idl_definitions(tmp_path: Path) -> None:
    data = b"\0\1\0\0" + struct.pack("<iI3s", -3, 3, b"hi\0")
    messages, problems = read(write_other_mcap(tmp_path / "a", "cdr", ("a/msg/B", "ros2idl", IDL), [data]))
    assert [(m.value.x, m.value.y) for m in messages] == [(-3, "hi")]
    assert problems == {}


@pytest.mark.parametrize(
    ("encoding", "form", "definition", "words"),
    [
        ("cdr", "ros2msg", b"float32 $$$", "the definition of a/msg/B cannot be parsed"),
        ("cdr", "ros2msg", b"Unknown x", "the definition of a/msg/B lacks that of a/msg/Unknown"),
        ("cdr", "ros2msg", b"B[] x", "the definition of a/msg/B contains itself"),
        ("cdr", "ros2msg", b"string[2000000000] x", "the definition of a/msg/B has an array of 2000000000 elements"),
        ("cdr", "ros2msg", b"uint8[-1] x", "the definition of a/msg/B has an array of -1 elements"),
        ("ros1", "ros1msg", b"std_msgs/Empty[] x", "the definition of a/msg/B has an array of empty messages"),
        (
            "cdr",
            "ros2idl",
            b"module a { module msg { const long X = ((((1)))); struct B { long x; }; }; };",
            "the definition of a/msg/B has a constant with parentheses",
        ),
        ("flatbuffer", "", b"", "the encoding 'flatbuffer' is not supported"),
        ("protobuf", "protobuf", b"\xff", "its FileDescriptorSet cannot be parsed"),
    ],
)
def test_a_definition_in_error_costs_its_topic(
    encoding: str, form: str, definition: bytes, words: str, tmp_path: Path
) -> None:
    path = write_other_mcap(tmp_path / "a", encoding, ("a/msg/B", form, definition), [b"\0\1\0\0aaaa"] * 3)
    messages, problems = read(path)
    assert messages == []
    assert list(problems.values()) == [1]
    assert f"messages on {POINTS} cannot be decoded" in next(iter(problems))
    assert words in next(iter(problems))


def test_only_the_topic_of_a_wrong_definition_is_lost(tmp_path: Path) -> None:
    path = write_rosbag2(tmp_path / "bag")
    database = sqlite3.connect(path / "bag.db3")
    database.execute("INSERT INTO topics VALUES (9, '/odd', 'odd/msg/Odd', 'cdr', '', '')")
    database.execute("INSERT INTO message_definitions VALUES (9, 'odd/msg/Odd', 'ros2msg', '$$$', '')")
    database.execute("INSERT INTO messages VALUES (99, 9, ?, x'00010000')", (START_NS,))
    database.commit()
    database.close()
    messages, problems = read(path)
    assert [m.topic.name for m in messages] == [POINTS] * 5
    assert problems == {
        "bag.db3: messages on /odd cannot be decoded: the definition of odd/msg/Odd cannot be parsed": 1
    }
    assert len(read(path, {POINTS})[1]) == 0


def test_database_of_an_old_distribution_has_no_definitions(tmp_path: Path) -> None:
    path = write_rosbag2(tmp_path / "bag") / "bag.db3"
    database = sqlite3.connect(path)
    database.executescript("DROP TABLE message_definitions; DROP TABLE schema; DROP INDEX timestamp_idx")
    database.close()
    messages, problems = read(path.parent)
    assert len(messages) == 5
    assert problems == {}


def test_one_topic_of_two_types(tmp_path: Path) -> None:
    path = tmp_path / "a"
    with Ros1Writer(path) as writer:
        for k, kind in enumerate(["tf/msg/tfMessage", "tf2_msgs/msg/TFMessage"]):
            connection = writer.add_connection("/tf", kind, msgdef="int32 a\n" if k else "string a\n", md5sum="0" * 32)
            writer.write(connection, START_NS + k, b"\x05\0\0\0" if k else b"\x02\0\0\0hi")
    messages, problems = read(path)
    assert [(m.topic.type, m.value.a) for m in messages] == [("tf/msg/tfMessage", "hi"), ("tf2_msgs/msg/TFMessage", 5)]
    assert problems == {}


def test_one_type_of_two_definitions(tmp_path: Path) -> None:
    path = tmp_path / "a"
    with Ros1Writer(path) as writer:
        for k, text in enumerate(["string a\n", "int32 a\n"]):
            connection = writer.add_connection(f"/{k}", "a/msg/A", msgdef=text, md5sum=str(k) * 32)
            writer.write(connection, START_NS + k, b"\x05\0\0\0" if k else b"\x02\0\0\0hi")
    assert [m.value.a for m in read(path)[0]] == ["hi", 5]


def test_empty_messages_of_ros1(tmp_path: Path) -> None:
    with Ros1Writer(tmp_path / "a") as writer:
        writer.write(writer.add_connection("/go", "std_msgs/msg/Empty", typestore=ROS1), START_NS, b"")
    messages, problems = read(tmp_path / "a")
    assert (len(messages), problems) == (1, {})


# folders


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


# damage


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


@pytest.mark.parametrize("declared", [10, 2**20, 2**33])
@pytest.mark.parametrize("compression", [CompressionType.ZSTD, CompressionType.LZ4])
def test_chunks_inflate_to_what_they_declare_at_most(
    declared: int, compression: CompressionType, tmp_path: Path
) -> None:
    path = write_mcap(tmp_path / "a", count=1, compression=compression)
    data = bytearray(path.read_bytes())
    chunk = next(k for k in range(len(data)) if data[k] == 6 and data[k + 9 : k + 17] == struct.pack("<Q", START_NS))
    struct.pack_into("<Q", data, chunk + 25, declared)
    path.write_bytes(data)
    messages, problems = read(path)
    assert messages == []
    assert next(iter(problems)).startswith(f"chunk at byte {chunk} skipped: ")


def test_bomb_of_a_chunk_is_stopped_early() -> None:
    bomb = zstd.compress(bytes(2**28))
    content, fault = bounded.inflate("zstd", bomb, 1000)
    assert (len(content), fault) == (0, "inflates beyond its declared size")


def test_chunk_of_zeros_ends_at_once(tmp_path: Path) -> None:
    content = zstd.compress(bytes(2**28))
    head = struct.pack("<QQQII", START_NS, START_NS, 2**28, 0, 4) + b"zstd" + struct.pack("<Q", len(content))
    path = tmp_path / "a"
    magic = b"\x89MCAP0\r\n"
    path.write_bytes(magic + b"\x06" + struct.pack("<Q", len(head) + len(content)) + head + content)
    messages, problems = read(path)
    assert messages == []
    assert "chunk at byte 8 is damaged at byte 0 of its content" in problems


def test_messages_inflate_piece_by_piece_up_to_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded, "MESSAGE_PIECE_BYTES", 1000)
    monkeypatch.setattr(bounded, "MAX_CHUNK_BYTES", 100_000)
    content = np.random.default_rng(0).bytes(100_000)
    assert bounded.inflate_message(zstd.compress(content[:900])) == content[:900]
    assert bounded.inflate_message(zstd.compress(content)) == content
    for broken in (zstd.compress(content + b"!"), zstd.compress(content)[:-10], zstd.compress(bytes(10**7))):
        with pytest.raises(ValueError, match="cut short or too large"):
            bounded.inflate_message(broken)


def test_bomb_of_a_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded, "MIN_FILE_BYTES", 2**22)
    path = tmp_path / "a"
    path.write_bytes(zstd.compress(b"\x89MCAP0\r\n" + bytes(2**25)))
    assert is_recording(path)
    with pytest.raises(SourceError, match=r"^rec: the zstd file of \d+ bytes inflates to more than 4194304 bytes"):
        open_recording(path, "rec")


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


def test_this_package_alone_loads_no_reader() -> None:
    heavy = ("mcap", "rosbags", "lz4", "backports.zstd", "google.protobuf")
    code = f"import sys, flatgrasp_cli.recordings.containers; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


# real recordings


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
