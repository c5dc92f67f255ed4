"""Does memory stay at one frame? Peak memory of planning a long recording over that of a short one.

    python benchmarks/recording_memory.py [--frames 2000]

The recordings hold a plate in view of a camera that moves, with transforms at 50 Hz, so that the transform buffer is
at work, too. Each is planned by the command line in a process of its own.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

SHORT, START_NS, PERIOD_NS, TF_PERIOD_NS = 20, 1_700_000_000 * 10**9, 100_000_000, 20_000_000
CLOUD, TF = "sensor_msgs/msg/PointCloud2", "tf2_msgs/msg/TFMessage"
STORE = get_typestore(Stores.ROS2_HUMBLE)


def make(name: str, *values: Any) -> Any:
    """A message of the type `name`."""
    return STORE.types[name](*values)


def header(stamp_ns: int, frame_id: str) -> Any:
    """A header."""
    return make("std_msgs/msg/Header", make("builtin_interfaces/msg/Time", *divmod(stamp_ns, 10**9)), frame_id)


def cloud(stamp_ns: int, rng: np.random.Generator) -> Any:
    """A plate of 120 × 40 mm, a metre away, of 640 × 480 points with as many behind it lost."""
    points = np.full((480 * 640, 3), np.nan, np.float32)
    points[:2000] = rng.uniform([-0.06, -0.02, 0.99], [0.06, 0.02, 1.0], (2000, 3))
    fields = [make("sensor_msgs/msg/PointField", axis, 4 * k, 7, 1) for k, axis in enumerate("xyz")]
    data = points.view(np.uint8).reshape(-1)
    return make(CLOUD, header(stamp_ns, "camera"), 480, 640, fields, False, 12, 12 * 640, data, False)


def transform(stamp_ns: int) -> Any:
    """The camera in the base."""
    pose = make(
        "geometry_msgs/msg/Transform",
        make("geometry_msgs/msg/Vector3", stamp_ns % 1000 / 1000, 0.0, 1.0),
        make("geometry_msgs/msg/Quaternion", 1.0, 0.0, 0.0, 0.0),
    )
    return make(TF, [make("geometry_msgs/msg/TransformStamped", header(stamp_ns, "base"), "camera", pose)])


def record(path: Path, frames: int) -> Path:
    """A rosbag2 of so many frames."""
    rng = np.random.default_rng(0)
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        clouds = writer.add_connection("/points", CLOUD, typestore=STORE)
        transforms = writer.add_connection("/tf", TF, typestore=STORE)
        same = STORE.serialize_cdr(cloud(START_NS, rng), CLOUD)
        for k in range(frames * PERIOD_NS // TF_PERIOD_NS):
            stamp_ns = START_NS + k * TF_PERIOD_NS
            writer.write(transforms, stamp_ns, STORE.serialize_cdr(transform(stamp_ns), TF))
            if stamp_ns % PERIOD_NS == 0:
                writer.write(clouds, stamp_ns, bytes(same[:4]) + stamp_of(stamp_ns) + bytes(same[12:]))
    return path


def stamp_of(stamp_ns: int) -> bytes:
    """A header's stamp in CDR, which follows the four bytes that say so."""
    return np.array(divmod(stamp_ns, 10**9), "<u4").tobytes()


def peak_mb(path: Path) -> float:
    """Peak memory in MB of planning all frames of a recording."""
    command = [sys.executable, "-m", "flatgrasp_cli", "plan", str(path), "--json", "--base-frame", "base"]
    options = ["--gripper", "pr2", "--scene", "object"]
    subprocess.run([*command, *options], stdout=subprocess.DEVNULL, check=True)  # noqa: S603
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def main() -> None:
    """Print both peaks and their ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=2000)
    count = parser.parse_args().frames
    with tempfile.TemporaryDirectory() as folder:
        short = peak_mb(record(Path(folder, "short"), SHORT))
        long = peak_mb(record(Path(folder, "long"), count))  # the children's peak so far: the longer one must be last
    print(f"{SHORT} frames {short:.0f} MB, {count} frames {long:.0f} MB, ratio {long / short:.2f}")


if __name__ == "__main__":
    main()
