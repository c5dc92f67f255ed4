"""Does planning keep up with a depth camera? Whole frames of 640 × 480, on one core, beside Open3D's reader.

    python benchmarks/frame_rate.py [--gripper lacquey] [--frames 20] [--out docs/frame_rate.png]

A frame is a table with 1, 3 or 10 objects, seen by the simulated sensor of sample_data and stored as binary PCD. It is
read, segmented and planned, without plots. Machines are noisy: every round times all frames, and Open3D's reading of
them, in turn; medians are printed, and the figures to compare are ratios within one run.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from clocks import StageClock, milliseconds

from flatgrasp_cli import Plan, load_gripper, load_settings, plan, read_clouds
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.planner import pipeline
from flatgrasp_cli.planning import answers, lifting, objects, search
from flatgrasp_cli.profiles import Gripper, PlannerSettings
from flatgrasp_cli.scene import segmentation
from flatgrasp_cli.simulation.samples import electric_drill, hammer, juice_box, spray_bottle
from flatgrasp_cli.simulation.solids import Solid, box, rod, turned
from flatgrasp_cli.surroundings import OnSupport, Tilted

ROOT = Path(__file__).resolve().parent.parent
PIXELS = 640 * 480
POINTS = (100_000, 300_000, 1_000_000, 3_000_000)
STEPS_M = (0.004, 0.002, 0.001)
COUNTS = (1, 3, 10)
STAGES = {
    "read": (),
    "support plane": ((segmentation, "find_support_plane"),),
    "objects": ((segmentation, "find_clusters"), (segmentation, "objects_of")),
    "surroundings": ((objects, "places"), (Tilted, "whole")),
    "silhouette": ((search, "silhouette_of"),),
    "finger candidates": (
        (pipeline, "step_points"),
        (pipeline, "finger_candidates"),
        (pipeline, "inward_directions"),
        (OnSupport, "sides"),
    ),
    "pairs": (
        (pipeline, "force_balanced"),
        (pipeline, "torque_balanced"),
        (pipeline, "closing_axes"),
        (pipeline, "on_pads"),
        (pipeline, "in_range"),
        (pipeline, "flat"),
    ),
    "operability, depth": ((pipeline, "operable"), (OnSupport, "approached")),
    "ranking": ((pipeline, "best_first"), (lifting, "_lifted")),
    "certificates": ((answers, "certified"),),
}


REST = "all else"
"""What of a frame's time is none of the stages'."""

# --- the frames -------------------------------------------------------------------------------------------------------


def samples() -> Any:
    """The module sample_data/make_samples.py: objects and sensor."""
    spec = importlib.util.spec_from_file_location("make_samples", ROOT / "sample_data" / "make_samples.py")
    assert spec is not None  # noqa: S101
    assert spec.loader is not None  # noqa: S101
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def layout(make: Any, count: int) -> list[Solid]:
    """The meshes of `count` objects, apart from each other on a table."""

    def mug() -> list[Solid]:
        wall = [(0.0, 0.005), (0.036, 0.005), (0.036, 0.095), (0.040, 0.095), (0.040, 0.0), (0.0, 0.0)]
        return [turned(wall, [], (0, 0, 0)), box((0.03, 0.01, 0.06), (0.052, 0, 0.05))]

    def can() -> list[Solid]:
        return [turned([(0.0, 0.0), (0.033, 0.0), (0.033, 0.115), (0.0, 0.115)], [], (0, 0, 0))]

    def pen() -> list[Solid]:
        return [rod(0.004, 0.14, (0, 0, 0.004))]

    places: list[tuple[Callable[[], list[Solid]], float, float, float]] = [
        (mug, -0.16, 0.05, 30),
        (juice_box, 0.12, 0.10, 50),
        (hammer, 0.02, -0.14, 10),
    ]
    if count == 10:
        places = [
            (mug, -0.33, 0.16, 30),
            (juice_box, -0.12, 0.18, 20),
            (hammer, 0.08, 0.13, 0),
            (can, 0.32, 0.18, 0),
            (spray_bottle, -0.30, -0.03, 75),
            (pen, -0.08, 0.03, 40),
            (electric_drill, 0.13, -0.02, 170),
            (mug, 0.34, -0.02, 80),
            (juice_box, -0.30, -0.20, -30),
            (pen, 0.0, -0.14, -20),
        ]
    return [mesh for kind, x, y, yaw in places[:count] for mesh in make.moved(kind(), x, y, yaw)]


def render(folder: Path, count: int, points: int = PIXELS) -> Path:
    """A frame of `count` objects as binary PCD; with other than 640 × 480 pixels, of a finer or coarser sensor."""
    make, open3d = samples(), load_open3d()
    rng = np.random.default_rng([30, count, points])
    cloud, _ = make.capture(layout(make, count), make.camera_pose(0.95, 30.0, 90.0), rng, (points / PIXELS) ** 0.5)
    path = folder / f"table_{count}_{points}.pcd"
    tensor = open3d.core.Tensor(cloud.reshape(-1, 3).astype(np.float32))
    open3d.t.io.write_point_cloud(str(path), open3d.t.geometry.PointCloud(tensor))
    return path


# --- the times --------------------------------------------------------------------------------------------------------


def frame(path: Path, hand: Gripper, settings: PlannerSettings, clock: StageClock) -> Plan:
    """Everything that is done for one frame."""
    clock.ms.clear()
    clouds: list[Any] = []
    clock.ms["read"] = milliseconds(lambda: clouds.extend(read_clouds(path)))
    return plan(clouds[0], hand, settings)


Figures = dict[str, float]


def time_frames(paths: list[Path], hand: Gripper, rounds: int, clock: StageClock) -> list[Figures]:
    """Median milliseconds of each frame: in all, of Open3D's reading, and of each stage; and the number of objects."""
    settings, open3d = load_settings(), load_open3d()
    found = [float(len(frame(path, hand, settings, clock).objects)) for path in paths]
    rows: list[dict[str, list[float]]] = [defaultdict(list) for _ in paths]
    for _ in range(rounds):
        for path, row in zip(paths, rows, strict=True):
            row["Open3D reads"].append(milliseconds(partial(open3d.io.read_point_cloud, str(path))))
            row["frame"].append(milliseconds(partial(frame, path, hand, settings, clock)))
            for stage in STAGES:
                row[stage].append(clock.ms[stage])
            row[REST].append(row["frame"][-1] - sum(clock.ms[stage] for stage in STAGES))
    return [
        {name: median(values) for name, values in row.items()} | {"found": count}
        for row, count in zip(rows, found, strict=True)
    ]


def time_steps(path: Path, hand: Gripper, rounds: int) -> list[float]:
    """Median milliseconds of planning with ever more step points."""
    cloud = next(read_clouds(path))
    times: list[list[float]] = [[] for _ in STEPS_M]
    for _ in range(rounds):
        for step_m, row in zip(STEPS_M, times, strict=True):
            row.append(plan(cloud, hand, load_settings("default", (f"fingers.step_m={step_m}",))).plan_ms)
    return [median(row) for row in times]


def peak_mb(code: str) -> float:
    """Peak memory of a Python process that runs `code`, in MB."""
    # not getrusage's ru_maxrss, which a process inherits from the one that starts it
    report = "print(next(line for line in open('/proc/self/status') if line.startswith('VmHWM')).split()[1])"
    done = subprocess.run([sys.executable, "-c", f"{code}\n{report}"], capture_output=True, check=True)  # noqa: S603
    return float(done.stdout.split()[-1]) / 1024


def process_seconds(caches: Path, *arguments: str) -> float:
    """Wall time of a Python process that finds its bytecode in `caches`, as an installed program does."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = str(caches)
    began = time.perf_counter()
    subprocess.run([sys.executable, *arguments], env=environment, stdout=subprocess.DEVNULL, check=True)  # noqa: S603
    return time.perf_counter() - began


# --- the report -------------------------------------------------------------------------------------------------------

DOOR = "from flatgrasp_cli.open3d_door import load_open3d; load_open3d()"
PLAN = "from flatgrasp_cli import *; plan(next(read_clouds({path!r})), load_gripper({gripper!r}))"


def report_processes(folder: Path, scene: Path, gripper: str, rounds: int) -> None:
    """Print memory and start-up, measured in processes of their own."""
    open3d = load_open3d()
    bare, whole = peak_mb(DOOR), peak_mb(PLAN.format(path=str(scene), gripper=gripper))
    print(f"peak memory: a frame of {PIXELS} points {whole:.0f} MB, import open3d {bare:.0f} MB ({whole - bare:+.0f})")
    plate = np.random.default_rng(0).uniform([-0.06, -0.02, 0.79], [0.06, 0.02, 0.81], (10_000, 3))
    path = str(folder / "plate.pcd")
    tensor = open3d.core.Tensor(plate.astype(np.float32))
    open3d.t.io.write_point_cloud(path, open3d.t.geometry.PointCloud(tensor))
    commands = [("-c", DOOR), ("-m", "flatgrasp_cli", "plan", path, "--json")]
    rows = [[process_seconds(folder / "caches", *each) for each in commands] for _ in range(1 + rounds)]
    importing, planning = zip(*rows[1:], strict=True)  # the first one compiles
    print(
        f"flatgrasp plan plate.pcd --json, 10,000 points: {median(planning):.2f} s, import open3d "
        f"{median(importing):.2f} s, ratio {median(planning) / median(importing):.2f}"
    )


def draw(out: Path, by_count: list[Figures], by_points: list[Figures]) -> None:
    """The figure: time by stage of frames with 1, 3 and 10 objects, and time by points."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained")
    colors = plt.get_cmap("viridis")(np.linspace(0.0, 0.95, len(STAGES)))
    for place, row in enumerate(by_count):
        begin = 0.0
        for stage, color in zip((*STAGES, REST), (*colors, "lightgray"), strict=True):
            left.barh(place, row[stage], left=begin, color=color, label=None if place else stage)
            begin += row[stage]
        left.plot([row["Open3D reads"]] * 2, [place - 0.45, place + 0.45], "r", label=None if place else "Open3D reads")
    left.axvline(1000 / 30, color="k", linestyle="--", linewidth=1, label="30 Hz")
    left.set_yticks(range(len(by_count)), [f"{count} object{'s' if count > 1 else ''}" for count in COUNTS])
    left.set(xlabel="milliseconds", title="A frame of 640 × 480, by stage")
    left.legend(fontsize=8, loc="lower right")
    points = np.array(POINTS)
    right.loglog(points, [row["frame"] for row in by_points], "o-", label="read and plan")
    scene = [row["read"] + row["support plane"] + row["objects"] for row in by_points]
    right.loglog(points, scene, "s-", label="of that: read, plane, objects")
    right.loglog(points, [row["Open3D reads"] for row in by_points], "r^-", label="Open3D reads")
    right.loglog(points, scene[1] * points / points[1], "k:", linewidth=1, label="linear")
    right.set(xlabel="points of the frame", ylabel="milliseconds", title="3 objects, by points")
    right.legend(fontsize=8)
    figure.savefig(out, dpi=110)
    print(f"{out} written")


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gripper", default="lacquey")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    hand, clock = load_gripper(args.gripper), StageClock(STAGES)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        scenes = [render(folder, count) for count in COUNTS]
        by_count = time_frames(scenes, hand, args.frames, clock)
        print("milliseconds (median)    " + "".join(f"{count:>9} obj." for count in COUNTS))
        for name in ("found", "Open3D reads", "frame", *STAGES, REST):
            print(f"{name:25}" + "".join(f"{figures[name]:14.1f}" for figures in by_count))
        ratios = [figures["frame"] / figures["Open3D reads"] for figures in by_count]
        print(f"{'frame / Open3D reads':25}" + "".join(f"{ratio:14.2f}" for ratio in ratios))
        print(
            f"{'frame / one object':25}" + "".join(f"{row['frame'] / by_count[0]['frame']:14.2f}" for row in by_count)
        )
        by_points = time_frames([render(folder, 3, points) for points in POINTS], hand, max(3, args.frames // 4), clock)
        for points, row in zip(POINTS, by_points, strict=True):
            scene = row["support plane"] + row["objects"]
            print(
                f"{points:9} points: frame {row['frame']:7.1f} ms, of that read {row['read']:6.1f}, "
                f"scene {scene:6.1f}, plan {row['frame'] - row['read'] - scene:6.1f}; "
                f"Open3D reads {row['Open3D reads']:7.1f}"
            )
        steps = time_steps(scenes[1], hand, max(3, args.frames // 4))
        by_step = ", ".join(f"{1e3 * step:.0f} mm {ms:.0f} ms" for step, ms in zip(STEPS_M, steps, strict=True))
        print(f"planning 3 objects by step: {by_step}")
        report_processes(folder, scenes[1], args.gripper, max(3, args.frames // 4))
    if args.out:
        draw(args.out, by_count, by_points)


if __name__ == "__main__":
    main()
