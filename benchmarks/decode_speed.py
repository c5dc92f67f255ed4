"""How fast is a PointCloud2 decoded? Beside a plain copy of its bytes, in turn, in one process.

    python benchmarks/decode_speed.py [--repeat 200]

A frame of 640 × 480 points of 32 bytes, x, y, z as float32 and rgb at offset 16, 24 % NaN: what a Kinect's driver
publishes. Machines are noisy, so the figure to compare is the ratio; both are medians. Planning asks for no colours,
figures do.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from statistics import median
from types import SimpleNamespace
from typing import Any

import numpy as np
from clocks import milliseconds

from flatgrasp_cli.recordings.messages.pointcloud2 import decode_pointcloud2

HEIGHT, WIDTH, STEP, NAN_SHARE = 480, 640, 32, 0.24
FLOAT32 = 7


def kinect_message() -> Any:
    """A message as the driver writes it; where there is no depth there is none for a stretch of the row."""
    rng = np.random.default_rng(0)
    records = np.zeros((HEIGHT * WIDTH, STEP), np.uint8)
    values = records.view(np.float32)
    values[:, :3] = rng.uniform(-1.0, 1.0, (len(records), 3))
    records[:, 16:20] = rng.integers(0, 256, (len(records), 4))
    stretches = rng.random(len(records) // 32) < NAN_SHARE
    values[np.repeat(stretches, 32), :3] = np.nan
    names = {"x": 0, "y": 4, "z": 8, "rgb": 16}
    return SimpleNamespace(
        header=SimpleNamespace(stamp=SimpleNamespace(sec=1, nanosec=0), frame_id="camera"),
        height=HEIGHT,
        width=WIDTH,
        fields=[SimpleNamespace(name=n, offset=o, datatype=FLOAT32, count=1) for n, o in names.items()],
        is_bigendian=False,
        point_step=STEP,
        row_step=WIDTH * STEP,
        data=records.reshape(-1),
        is_dense=False,
    )


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=200)
    args = parser.parse_args()
    message = kinect_message()
    tasks: dict[str, Callable[[], object]] = {
        "plain copy": message.data.copy,
        "decode": partial(decode_pointcloud2, message),
        "decode with colours": partial(decode_pointcloud2, message, colors=True),
    }
    times: dict[str, list[float]] = {name: [] for name in tasks}
    for _ in range(args.repeat):
        for name, task in tasks.items():
            times[name].append(milliseconds(task))
    copy = median(times["plain copy"])
    for name, values in times.items():
        print(f"{name:20} {median(values):6.2f} ms, ratio {median(values) / copy:.2f}")


if __name__ == "__main__":
    main()
