"""Recordings with known answers, written in every container."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

CLOUD_TYPE = "sensor_msgs/msg/PointCloud2"
TEXT_TYPE = "std_msgs/msg/String"
POINTS = "/camera/points"
TEXT = "/note"
START_NS = 1_700_000_000_000_000_000
STEP_NS = 100_000_000
ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS2 = get_typestore(Stores.ROS2_HUMBLE)


def stamps(count: int) -> list[int]:
    """Log times of `count` messages."""
    return [START_NS + k * STEP_NS for k in range(count)]


def cloud_points(k: int) -> np.ndarray[Any, np.dtype[np.float32]]:
    """The points of the k-th cloud, (100, 3)."""
    return np.arange(300, dtype=np.float32).reshape(100, 3) + np.float32(k)


def cloud_message(store: Typestore, k: int) -> Any:
    """The k-th PointCloud2, as a message of the store."""
    types = store.types
    stamp: Any = types["builtin_interfaces/msg/Time"](sec=1_700_000_000 + k, nanosec=0)
    sequence = {"seq": k} if "seq" in types["std_msgs/msg/Header"].__annotations__ else {}
    header: Any = types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera", **sequence)
    fields: Any = [
        types["sensor_msgs/msg/PointField"](name=axis, offset=4 * n, datatype=7, count=1)
        for n, axis in enumerate("xyz")
    ]
    return types[CLOUD_TYPE](
        header=header,
        height=1,
        width=100,
        fields=fields,
        is_bigendian=False,
        point_step=12,
        row_step=1200,
        data=cloud_points(k).view(np.uint8).reshape(-1),
        is_dense=True,
    )


def raw_cloud(k: int, encoding: str = "cdr") -> bytes:
    """The k-th cloud in CDR or in ROS 1's serialisation."""
    if encoding == "ros1":
        return bytes(ROS1.serialize_ros1(cloud_message(ROS1, k), CLOUD_TYPE))
    return bytes(ROS2.serialize_cdr(cloud_message(ROS2, k), CLOUD_TYPE))


def write_mcap(
    path: Path,
    count: int = 5,
    compression: CompressionType = CompressionType.ZSTD,
    encoding: str = "cdr",
    order: Sequence[int] | None = None,
    **options: Any,
) -> Path:
    """An MCAP of `count` clouds, about two to a chunk; `order` permutes them in the file."""
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=2000, compression=compression, **options)
        writer.start(profile="ros2", library="flatgrasp's tests")
        store, form = (ROS1, "ros1msg") if encoding == "ros1" else (ROS2, "ros2msg")
        text, _ = store.generate_msgdef(CLOUD_TYPE, ros_version=1 if encoding == "ros1" else 2)
        name = "sensor_msgs/PointCloud2" if encoding == "ros1" else CLOUD_TYPE
        schema = writer.register_schema(name, form, text.encode())
        channel = writer.register_channel(POINTS, encoding, schema)
        for k in order or range(count):
            writer.add_message(channel, stamps(count)[k], raw_cloud(k, encoding), stamps(count)[k])
        writer.finish()  # type: ignore[no-untyped-call]
    return path


BARE: dict[str, Any] = {
    "index_types": IndexType.NONE,
    "repeat_channels": False,
    "repeat_schemas": False,
    "use_statistics": False,
    "use_summary_offsets": False,
}
"""Options of the MCAP writer for a file without a summary."""


def write_other_mcap(path: Path, encoding: str, schema: tuple[str, str, bytes], messages: Sequence[bytes]) -> Path:
    """An MCAP of raw messages on POINTS; `schema` is its name, encoding and data."""
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        channel = writer.register_channel(POINTS, encoding, writer.register_schema(*schema))
        for stamp, data in zip(stamps(len(messages)), messages, strict=True):
            writer.add_message(channel, stamp, data, stamp)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def write_ros1(
    path: Path, count: int = 5, compression: Ros1Writer.CompressionFormat | None = None, chunk_bytes: int = 2000
) -> Path:
    """A ROS 1 bag of `count` clouds, about two to a chunk."""
    writer = Ros1Writer(path)
    if compression is not None:
        writer.set_compression(compression)
    writer.chunk_threshold = chunk_bytes
    with writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS1)
        for k, stamp in enumerate(stamps(count)):
            writer.write(connection, stamp, raw_cloud(k, "ros1"))
    return path


def write_rosbag2(
    folder: Path,
    count: int = 5,
    storage: StoragePlugin = StoragePlugin.SQLITE3,
    compression: CompressionMode = CompressionMode.NONE,
) -> Path:
    """A rosbag2 folder of `count` clouds."""
    writer = Rosbag2Writer(folder, version=9, storage_plugin=storage)
    if compression != CompressionMode.NONE:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        for k, stamp in enumerate(stamps(count)):
            writer.write(connection, stamp, raw_cloud(k))
    return folder


def write_messages(folder: Path, messages: Sequence[tuple[str, str, int, Any]]) -> Path:
    """A rosbag2 folder of any messages: topic, type, log time, and the message of the store ROS2."""
    with Rosbag2Writer(folder, version=9) as writer:
        connections: dict[str, Any] = {}
        for topic, kind, stamp, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ROS2)
            writer.write(connections[topic], stamp, ROS2.serialize_cdr(message, kind))
    return folder


def header2(frame_id: str, stamp_ns: int = START_NS) -> Any:
    """A header of the store ROS2."""
    time = ROS2.types["builtin_interfaces/msg/Time"](*divmod(stamp_ns, 10**9))
    return ROS2.types["std_msgs/msg/Header"](stamp=time, frame_id=frame_id)


def transform2(
    parent: str, child: str, xyz: Sequence[float], quaternion: Sequence[float] = (0, 0, 0, 1), stamp_ns: int = START_NS
) -> tuple[str, Any]:
    """The type and a TFMessage with one transform, of the store ROS2."""
    types: Any = ROS2.types
    motion = types["geometry_msgs/msg/Transform"](
        types["geometry_msgs/msg/Vector3"](*map(float, xyz)),
        types["geometry_msgs/msg/Quaternion"](*map(float, quaternion)),
    )
    stamped = types["geometry_msgs/msg/TransformStamped"](header2(parent, stamp_ns), child, motion)
    return "tf2_msgs/msg/TFMessage", types["tf2_msgs/msg/TFMessage"]([stamped])
