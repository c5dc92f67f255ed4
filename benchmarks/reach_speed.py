"""How fast are the arm's kinematics? Poses a second of the inverse alone, grasps a second of the full reach.

    python benchmarks/reach_speed.py [--robot ur5] [--count 5000] [--repeat 7]

Grasps come from above, tilted by up to 29°, all around the base; machines are noisy, so medians are printed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from statistics import median

import numpy as np

from flatgrasp_cli import load_robot
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.robot import Motion, Plane, forward, inverse, reach, ur_rows

TOOL_M = 0.17
TILT = np.tan(np.radians(29.0))
UP = np.array([0.0, 0.0, 1.0])


def grasps(count: int, span_m: float, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Fingertips (n, 3) within `span_m` of the base, up to half as high, and hands (n, 3, 3) that come from above."""
    positions = rng.uniform([-span_m, -span_m, 0.0], [span_m, span_m, span_m / 2], (count, 3))
    angle, tilt = rng.uniform(0, 2 * np.pi, count), TILT * np.sqrt(rng.random(count))
    z = np.column_stack([tilt * np.cos(angle), tilt * np.sin(angle), np.full(count, -1.0)])
    x = np.cross(rng.normal(size=(count, 3)), z)
    x, z = (each / np.linalg.norm(each, axis=1, keepdims=True) for each in (x, z))
    return positions, np.stack([x, np.cross(z, x), z], axis=1)


def rate(function: Callable[[], object], count: int, repeat: int) -> float:
    """Median of `count` over the wall time of a call."""
    seconds = []
    for _ in range(repeat):
        began = time.perf_counter()
        function()
        seconds.append(time.perf_counter() - began)
    return count / median(seconds)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="ur5")
    parser.add_argument("--count", type=int, default=5000)
    parser.add_argument("--repeat", type=int, default=7)
    args = parser.parse_args()
    robot, rng, count = load_robot(args.robot), np.random.default_rng(0), args.count
    positions, axes = grasps(count, robot.reach_m, rng)
    dh = ur_rows(robot, "this benchmark")
    pose = forward(dh, rng.uniform(-np.pi, np.pi, (count, 6)))[:, 5]
    random_axes = np.ascontiguousarray(pose[:, :3, :3].transpose(0, 2, 1))
    poses = {"random poses": (pose[:, :3, 3], random_axes), "poses of grasps": (positions - TOOL_M * axes[:, 2], axes)}
    for name, (flange, turned) in poses.items():
        print(f"{name:16} {rate(partial(inverse, dh, flange, turned), count, args.repeat):9,.0f} a second, inverse")
    ask = partial(reach, robot, *poses["poses of grasps"], Motion(0.1, 0.1, UP, twin=True), Plane(UP, 0.0))
    reached = sum(answer.ok for answer in ask())
    speed = rate(ask, count, args.repeat)
    print(f"{'grasps':16} {speed:9,.0f} a second, full reach; {100 * reached / count:.1f} % are reached")


if __name__ == "__main__":
    main()
