"""How fast is planning? Times per stage, beside the time that Open3D takes to read the same file.

    python benchmarks/plan_speed.py [--gripper lacquey] [--repeat 15] [FILE…]

Without files: all of sample_data/, and ../shared/data/clouds if it is there. Machines are noisy, so the figures to
compare are ratios within one run; every round times reading and planning in turn, and medians are printed.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import defaultdict
from functools import partial
from pathlib import Path
from statistics import median
from types import ModuleType
from typing import Any

import numpy as np
from clocks import StageClock, milliseconds

from flatgrasp_cli import load_gripper, load_settings, plan, read_clouds
from flatgrasp_cli.model import Cloud, Source
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.planner import pipeline
from flatgrasp_cli.planning import objects, search
from flatgrasp_cli.surroundings import Alone, OnSupport

ROOT = Path(__file__).resolve().parent.parent
SECTIONS: dict[str, list[tuple[ModuleType | type, str]]] = {
    "A.1": [(objects, "oriented_box")],
    "A.2": [(search, "silhouette_of")],
    "A.3": [(pipeline, "step_points"), (pipeline, "finger_candidates"), (pipeline, "inward_directions")],
    "B.2": [(pipeline, "torque_balanced")],
    "B.3": [(pipeline, "closing_axes"), (pipeline, "on_pads"), (pipeline, "in_range")],
    "B.4": [(pipeline, "flat")],
    "B.5": [(pipeline, "operable")],
    "3-D": [
        (objects, "places"),
        *((of, name) for of in (Alone, OnSupport) for name in ("sides", "approached")),
    ],
    "C": [(pipeline, "best_first")],
}
"""The calls of each section of the method."""
FRAME_POINTS, OBJECT_POINTS = 300_000, 10_000


def time_file(path: Path, gripper: str, repeat: int, clock: StageClock) -> None:
    """Print one row: points, read by Open3D, plan, their ratio, milliseconds of each section."""
    hand, settings, open3d = load_gripper(gripper), load_settings(), load_open3d()
    cloud = next(read_clouds(path))
    rows: dict[str, list[float]] = defaultdict(list)
    for _ in range(repeat):
        rows["read"].append(milliseconds(partial(open3d.io.read_point_cloud, str(path))))
        clock.ms.clear()
        rows["plan"].append(milliseconds(partial(plan, cloud, hand, settings)))
        for section in SECTIONS:
            rows[section].append(clock.ms[section])
    figures = {name: median(values) for name, values in rows.items()}
    sections = " ".join(f"{figures[section]:6.1f}" for section in SECTIONS)
    ratio = figures["plan"] / figures["read"]
    head = f"{path.name[:38]:38} {len(cloud.points):7}"
    print(f"{head} {figures['read']:7.1f} {figures['plan']:7.1f} {ratio:6.2f}  {sections}")


def time_against_frame(gripper: str, repeat: int) -> None:
    """Print planning one object of 10,000 points over reading a frame of 300,000 as binary PCD."""
    hand, settings, open3d = load_gripper(gripper), load_settings(), load_open3d()
    rng = np.random.default_rng(0)
    objects = {
        "plate 120 × 40 mm": rng.uniform([-0.06, -0.02, -0.01], [0.06, 0.02, 0.01], (OBJECT_POINTS, 3)),
        "teddy bear": _resampled(ROOT / "sample_data" / "teddy_bear.pcd", OBJECT_POINTS, rng),
    }
    with tempfile.TemporaryDirectory() as folder:
        frame = str(Path(folder, "frame.pcd"))
        points = open3d.utility.Vector3dVector(rng.random((FRAME_POINTS, 3)))
        open3d.io.write_point_cloud(frame, open3d.geometry.PointCloud(points))
        for name, cloud_points in objects.items():
            cloud = Cloud(cloud_points, np.array([0.0, 0.0, 1.0]), Source(name))
            plan(cloud, hand, settings)
            planning, reading = [], []
            for _ in range(repeat):
                planning.append(milliseconds(partial(plan, cloud, hand, settings)))
                reading.append(milliseconds(partial(open3d.io.read_point_cloud, frame)))
            print(
                f"{name}, {OBJECT_POINTS} points: plan {median(planning):.1f} ms, Open3D reads {FRAME_POINTS} points "
                f"in {median(reading):.1f} ms, ratio {median(planning) / median(reading):.2f}"
            )


def _resampled(path: Path, count: int, rng: np.random.Generator) -> Any:
    points = next(read_clouds(path)).points
    return points[rng.choice(len(points), count, replace=len(points) < count)]


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--gripper", default="lacquey")
    parser.add_argument("--repeat", type=int, default=15)
    args = parser.parse_args()
    shared = ROOT.parent / "shared" / "data" / "clouds"
    files = args.files or [*sorted((ROOT / "sample_data").glob("*.pcd")), *sorted(shared.glob("*.pcd"))]
    time_against_frame(args.gripper, args.repeat)
    clock = StageClock(SECTIONS)
    heads = " ".join(f"{section:>6}" for section in SECTIONS)
    print(f"{'milliseconds (median)':38} {'points':>7} {'Open3D':>7} {'plan':>7} {'ratio':>6}  {heads}")
    for path in files:
        time_file(path, args.gripper, args.repeat, clock)


if __name__ == "__main__":
    main()
