"""The sample recordings, and clouds recorded in every container."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import Writer as McapWriter
from numpy.typing import NDArray
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer

from flatgrasp_cli import read_clouds
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources.selection import Selection
from tests.conftest import SAMPLES
from tests.recordings.writing import (
    CLOUD_TYPE,
    POINTS,
    ROS1,
    ROS2,
    START_NS,
)

PAN = {name: SAMPLES / name for name in ("pan_ros2", "pan_ros1.bag", "pan_foxglove.mcap")}
PERIOD_NS = 200_000_000
STAMPS = [START_NS + k * PERIOD_NS for k in range(3)]
PAN_X_M = 0.5
"""Where make_recordings.py puts the pan in base_link."""
FLOATS = {"f4": 7, "f8": 8}
NO_INFO = (
    "expected on /depth/camera_info, or one for frame 'camera' and 2 × 2 pixels; CameraInfos seen so far: none; "
    "or give --intrinsics fx,fy,cx,cy"
)


def frames(path: Path, **wanted: Any) -> list[Cloud]:
    return list(read_clouds(path, selection=Selection(**wanted)))


def cloud_message(store: Any, points: NDArray[np.float32], layout: str) -> Any:
    """A PointCloud2 of `points` in a layout: packed, double, big_endian or padded rows."""
    kind = "f8" if layout == "double" else "f4"
    order = ">" if layout == "big_endian" else "<"
    step, row_rest = (48, 16) if layout == "padded" else (3 * int(kind[1]), 0)
    height, width = (2, len(points) // 2) if layout == "padded" else (1, len(points))
    names = ["z", "y", "x"] if layout == "padded" else ["x", "y", "z"]
    offsets = [step - int(kind[1]) * (k + 1) for k in range(3)] if layout == "padded" else None
    offsets = offsets or [int(kind[1]) * k for k in range(3)]
    row = np.dtype({"names": names, "formats": [order + kind] * 3, "offsets": offsets, "itemsize": step})
    table = np.zeros((height, width), row)
    for k, axis in enumerate("xyz"):
        table[axis] = points[: height * width, k].reshape(height, width)
    rows = np.zeros((height, width * step + row_rest), np.uint8)
    rows[:, : width * step] = table.view(np.uint8).reshape(height, -1)
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](START_NS // 10**9, 0)
    sequence = {"seq": 0} if "seq" in types["std_msgs/msg/Header"].__annotations__ else {}
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera", **sequence)
    fields = [
        types["sensor_msgs/msg/PointField"](name, offset, FLOATS[kind], 1)
        for name, offset in zip(names, offsets, strict=True)
    ]
    return types[CLOUD_TYPE](
        header, height, width, fields, order == ">", step, rows.shape[1], rows.reshape(-1), layout != "padded"
    )


def ros1_bag(path: Path, points: NDArray[np.float32], layout: str) -> Path:
    with Ros1Writer(path) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS1)
        writer.write(connection, START_NS, ROS1.serialize_ros1(cloud_message(ROS1, points, layout), CLOUD_TYPE))
    return path


def rosbag2(path: Path, points: NDArray[np.float32], layout: str, storage: StoragePlugin) -> Path:
    with Ros2Writer(path, version=9, storage_plugin=storage) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        writer.write(connection, START_NS, ROS2.serialize_cdr(cloud_message(ROS2, points, layout), CLOUD_TYPE))
    return path


def json_mcap(path: Path, points: NDArray[np.float32], _layout: str, **more: Any) -> Path:
    message = {
        "timestamp": {"sec": START_NS // 10**9, "nsec": 0},
        "frame_id": "camera",
        "point_stride": 12,
        "fields": [{"name": axis, "offset": 4 * k, "type": 7} for k, axis in enumerate("xyz")],
        "data": base64.b64encode(points.astype("<f4").tobytes()).decode(),
    }
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        channel = writer.register_channel(
            POINTS, "json", writer.register_schema("foxglove.PointCloud", "jsonschema", b"{}")
        )
        writer.add_message(channel, START_NS, json.dumps(message | more).encode(), START_NS)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


WRITERS: dict[str, Callable[[Path, NDArray[np.float32], str], Path]] = {
    "ROS 1 bag": ros1_bag,
    "rosbag2 sqlite3": lambda path, points, layout: rosbag2(path, points, layout, StoragePlugin.SQLITE3),
    "rosbag2 mcap": lambda path, points, layout: rosbag2(path, points, layout, StoragePlugin.MCAP),
}
