"""What the tests of batches share: a recording, the command, and what is compared of results."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer

from flatgrasp_cli.batch.slices import FRAMES
from tests.plates import slab
from tests.recordings.writing import CLOUD_TYPE, POINTS, ROS2, START_NS
from tests.sources.recordings import cloud_message

PERIOD_NS = 100_000_000
LONG = 3 * FRAMES
FAST = ("--gripper", "pr2", "--scene", "object", "--top", "1")
COMMAND = [sys.executable, "-m", "flatgrasp_cli", "batch"]


def record(path: Path, frames: int) -> Path:
    """A rosbag2 of plates that turn slowly, each frame another answer."""
    plate = slab(120, 40, points=400)
    with Ros2Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(POINTS, CLOUD_TYPE, typestore=ROS2)
        for k in range(frames):
            c, s = np.cos(0.01 * k), np.sin(0.01 * k)
            points = (plate @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0, 0, 1]).astype(np.float32)
            message = cloud_message(ROS2, points, "packed")
            message.header.stamp.nanosec = k
            writer.write(connection, START_NS + k * PERIOD_NS, ROS2.serialize_cdr(message, CLOUD_TYPE))
    return path


def documents(path: Path | str) -> list[Any]:
    """The documents of a file or of plan's output, without their times."""
    text = path.read_text() if isinstance(path, Path) else path
    found = [json.loads(line) for line in text.splitlines()]
    for document in found:
        del document["timing_ms"]
    return found


def files(out: Path) -> dict[str, str]:
    """All results but times: documents, and what the state keeps."""
    texts = {}
    for path in sorted(out.rglob("*.jsonl")):
        texts[str(path.relative_to(out))] = re.sub(r'"timing_ms": ?\{[^}]*\}', "", path.read_text())
    return texts


def batch(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False)
