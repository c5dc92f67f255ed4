"""Makes the recordings of this folder: a camera on an arm moves around the pan on the table, three frames.

    python sample_data/make_recordings.py [OUT_DIR]

The same frames as a ROS 2 bag with clouds (`pan_ros2/`), a ROS 1 bag with depth images (`pan_ros1.bag`) and an MCAP
that knows nothing of ROS (`pan_foxglove.mcap`). In all of them the transforms lead from base_link, 0.5 m beside the
pan at the table's height, over camera_link, which moves, to camera_depth_optical_frame. `make_samples.py` makes the pan
and the camera.
"""

from __future__ import annotations

import base64
import json
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from make_samples import FOCAL_PX, Array, camera_pose, capture
from mcap.writer import CompressionType, Writer
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from scipy.spatial.transform import Rotation

from flatgrasp_cli.simulation.samples import pan

START_NS, PERIOD_NS, TF_PERIOD_NS = 1_700_000_000 * 10**9, 200_000_000, 50_000_000
AZIMUTHS_DEG = (60.0, 65.0, 70.0)
HALF = 0.5
ROWS, COLUMNS = slice(60, 180), slice(80, 240)
PAN_X_M = 0.5
BASE, MOUNT, OPTICAL = "base_link", "camera_link", "camera_depth_optical_frame"
OPTICAL_IN_MOUNT = np.array([-0.5, 0.5, -0.5, 0.5])
"""Quaternion x, y, z, w: z forward, x right, y down, in a frame with x forward, y left, z up (REP 103)."""


@dataclass(frozen=True)
class Frame:
    """One frame: time, azimuth, and points (120, 160, 3) in the optical frame."""

    stamp_ns: int
    points: Array


def frames() -> list[Frame]:
    """The three frames that every recording holds."""
    rng = np.random.default_rng([2016, 100])
    return [
        Frame(START_NS + k * PERIOD_NS, capture(pan(), camera_pose(0.9, 20.0, azimuth), rng, HALF)[0][ROWS, COLUMNS])
        for k, azimuth in enumerate(AZIMUTHS_DEG)
    ]


def mounts() -> list[tuple[int, Array, Array]]:
    """Time, position (3,) and quaternion (4,) of camera_link in base_link, from before the first frame to the end."""
    last_ns = PERIOD_NS * (len(AZIMUTHS_DEG) - 1)
    times = np.arange(-TF_PERIOD_NS, last_ns + 2 * TF_PERIOD_NS, TF_PERIOD_NS)
    azimuths = np.interp(times, PERIOD_NS * np.arange(len(AZIMUTHS_DEG)), AZIMUTHS_DEG)
    result = []
    for time, azimuth in zip(times.tolist(), azimuths.tolist(), strict=True):
        camera = np.linalg.inv(camera_pose(0.9, 20.0, azimuth))  # in the table's frame, whose origin is under the pan
        turn = Rotation.from_matrix(camera[:3, :3]) * Rotation.from_quat(OPTICAL_IN_MOUNT).inv()
        result.append((START_NS + time, camera[:3, 3] + [PAN_X_M, 0, 0], turn.as_quat()))
    return result


# --- ROS 1 and ROS 2 --------------------------------------------------------------------------------------------------


class Messages:
    """Makes the messages of one ROS distribution."""

    def __init__(self, store: Typestore) -> None:
        self.store = store

    def make(self, name: str, *values: Any, **named: Any) -> Any:
        """A message of the type `name`."""
        return self.store.types[name](*values, **named)

    def header(self, stamp_ns: int, frame_id: str) -> Any:
        """A header; ROS 1's also has a sequence number."""
        stamp = self.make("builtin_interfaces/msg/Time", *divmod(stamp_ns, 10**9))
        named = {"stamp": stamp, "frame_id": frame_id}
        fields = [name for name, _ in self.store.fielddefs["std_msgs/msg/Header"][1]]
        return self.make("std_msgs/msg/Header", **({"seq": 0} if "seq" in fields else {}), **named)

    def transform(self, stamp_ns: int, parent: str, child: str, position: Array, quaternion: Array) -> Any:
        """A message with one transform."""
        x, y, z = position.tolist()
        transform = self.make(
            "geometry_msgs/msg/Transform",
            self.make("geometry_msgs/msg/Vector3", x, y, z),
            self.make("geometry_msgs/msg/Quaternion", *quaternion.tolist()),
        )
        stamped = self.make("geometry_msgs/msg/TransformStamped", self.header(stamp_ns, parent), child, transform)
        return self.make("tf2_msgs/msg/TFMessage", [stamped])

    def cloud(self, frame: Frame) -> Any:
        """An organised PointCloud2 of x, y, z."""
        rows, columns = frame.points.shape[:2]
        fields = [self.make("sensor_msgs/msg/PointField", name, 4 * k, 7, 1) for k, name in enumerate("xyz")]
        data = frame.points.astype("<f4").view(np.uint8).ravel()
        header = self.header(frame.stamp_ns, OPTICAL)
        return self.make(
            "sensor_msgs/msg/PointCloud2", header, rows, columns, fields, False, 12, 12 * columns, data, False
        )  # fmt: skip

    def depth_image(self, frame: Frame) -> Any:
        """A depth image in millimetres, 0 where nothing returned."""
        depth = np.nan_to_num(1000 * frame.points[..., 2]).round().astype("<u2")
        rows, columns = depth.shape
        header = self.header(frame.stamp_ns, OPTICAL)
        return self.make(
            "sensor_msgs/msg/Image", header, rows, columns, "16UC1", 0, 2 * columns, depth.view(np.uint8).ravel()
        )

    def camera_info(self, frame: Frame) -> Any:
        """The QVGA camera, of which the images are the middle: the region of interest says so."""
        roi = self.make("sensor_msgs/msg/RegionOfInterest", COLUMNS.start, ROWS.start, *frame.points.shape[:2], False)
        focal, u0, v0 = HALF * FOCAL_PX, 159.5, 119.5
        matrix = np.array([focal, 0, u0, 0, focal, v0, 0, 0, 1])
        projection = np.array([focal, 0, u0, 0, 0, focal, v0, 0, 0, 0, 1, 0])
        values = [np.zeros(5), matrix, np.eye(3).ravel(), projection, 0, 0, roi]
        header = self.header(frame.stamp_ns, OPTICAL)
        return self.make("sensor_msgs/msg/CameraInfo", header, 240, 320, "plumb_bob", *values)


def write_ros2(path: Path) -> None:
    """A rosbag2 folder: clouds, MCAP storage, compressed message by message."""
    shutil.rmtree(path, ignore_errors=True)
    messages = Messages(get_typestore(Stores.ROS2_HUMBLE))
    writer = rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP)
    writer.set_compression(rosbag2.CompressionMode.STORAGE, rosbag2.CompressionFormat.ZSTD)
    with writer:
        _write(writer, messages, "cdr", {"/camera/depth/points": ("sensor_msgs/msg/PointCloud2", messages.cloud)})


def write_ros1(path: Path) -> None:
    """A ROS 1 bag: depth images and their camera."""
    path.unlink(missing_ok=True)
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    messages = Messages(store)
    writer = rosbag1.Writer(path)
    writer.set_compression(rosbag1.Writer.CompressionFormat.BZ2)
    topics = {
        "/camera/depth/camera_info": ("sensor_msgs/msg/CameraInfo", messages.camera_info),
        "/camera/depth/image_rect_raw": ("sensor_msgs/msg/Image", messages.depth_image),
    }
    with writer:
        _write(writer, messages, "ros1", topics)


def _write(writer: Any, messages: Messages, encoding: str, topics: dict[str, Any]) -> None:
    """Write transforms and frames in the order of time."""
    store = messages.store
    serialize = store.serialize_ros1 if encoding == "ros1" else store.serialize_cdr
    log: list[tuple[int, str, str, Any]] = [
        (mounts()[0][0], "/tf_static", "tf2_msgs/msg/TFMessage",
         messages.transform(mounts()[0][0], MOUNT, OPTICAL, np.zeros(3), OPTICAL_IN_MOUNT))
    ]  # fmt: skip
    for stamp_ns, position, quaternion in mounts():
        message = messages.transform(stamp_ns, BASE, MOUNT, position, quaternion)
        log.append((stamp_ns, "/tf", "tf2_msgs/msg/TFMessage", message))
    for frame in frames():
        log += [(frame.stamp_ns, topic, kind, make(frame)) for topic, (kind, make) in topics.items()]
    connections: dict[str, Any] = {}
    for stamp_ns, topic, kind, message in sorted(log, key=lambda entry: entry[0]):
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=store)
        writer.write(connections[topic], stamp_ns, serialize(message, kind))


# --- MCAP without ROS -------------------------------------------------------------------------------------------------


def write_foxglove(path: Path) -> None:
    """An MCAP of JSON messages after Foxglove's schemas."""
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(library="flatgrasp sample")
        schemas = {name: writer.register_schema(name, "jsonschema", b"{}") for name in KINDS.values()}
        channels = {topic: writer.register_channel(topic, "json", schemas[kind]) for topic, kind in KINDS.items()}
        log = [(stamp_ns, "/tf", _transform(stamp_ns, BASE, MOUNT, *pose)) for stamp_ns, *pose in mounts()]
        log += [
            (stamp_ns, "/tf", _transform(stamp_ns, MOUNT, OPTICAL, np.zeros(3), OPTICAL_IN_MOUNT))
            for stamp_ns, *_ in mounts()
        ]
        log += [(frame.stamp_ns, "/points", _cloud(frame)) for frame in frames()]
        for stamp_ns, topic, message in sorted(log, key=lambda entry: entry[0]):
            writer.add_message(channels[topic], stamp_ns, json.dumps(message).encode(), stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]


KINDS = {"/points": "foxglove.PointCloud", "/tf": "foxglove.FrameTransform"}


def _time(stamp_ns: int) -> dict[str, int]:
    return {"sec": stamp_ns // 10**9, "nsec": stamp_ns % 10**9}


def _vector(position: Array) -> dict[str, float]:
    return dict(zip("xyz", position.tolist(), strict=True))


def _quaternion(quaternion: Array) -> dict[str, float]:
    return dict(zip("xyzw", quaternion.tolist(), strict=True))


def _transform(stamp_ns: int, parent: str, child: str, position: Array, quaternion: Array) -> dict[str, Any]:
    return {
        "timestamp": _time(stamp_ns),
        "parent_frame_id": parent,
        "child_frame_id": child,
        "translation": _vector(position),
        "rotation": _quaternion(quaternion),
    }


def _cloud(frame: Frame) -> dict[str, Any]:
    points = frame.points.reshape(-1, 3)
    finite = points[np.isfinite(points[:, 2])].astype("<f4")
    return {
        "timestamp": _time(frame.stamp_ns),
        "frame_id": OPTICAL,
        "pose": {"position": _vector(np.zeros(3)), "orientation": _quaternion(np.array([0.0, 0.0, 0.0, 1.0]))},
        "point_stride": 12,
        "fields": [{"name": name, "offset": 4 * k, "type": 7} for k, name in enumerate("xyz")],
        "data": base64.b64encode(finite.tobytes()).decode(),
    }


def main() -> None:
    """Make every recording."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    out.mkdir(parents=True, exist_ok=True)
    for name, write in (("pan_ros2", write_ros2), ("pan_ros1.bag", write_ros1), ("pan_foxglove.mcap", write_foxglove)):
        write(out / name)
        files = [path for path in (out / name, *sorted((out / name).glob("*"))) if path.is_file()]
        print(f"{name}: {sum(path.stat().st_size for path in files) / 1000:.0f} kB")


if __name__ == "__main__":
    main()
