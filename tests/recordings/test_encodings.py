"""Messages in the encodings of ROS 1, ROS 2, JSON and Protobuf, and definitions that do not fit."""

from __future__ import annotations

import base64
import json
import sqlite3
import struct
from pathlib import Path

import pytest
from rosbags.rosbag1 import Writer as Ros1Writer

from flatgrasp_cli.recordings.containers import Topic
from tests.recordings.containers import read
from tests.recordings.writing import (
    POINTS,
    ROS1,
    START_NS,
    write_other_mcap,
    write_rosbag2,
)


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
