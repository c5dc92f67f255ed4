"""How long does one `flatgrasp plan` take as a process? Over what `import open3d` takes, in turn in one run.

    python benchmarks/start_up.py [--repeat 9] [FILE]

Without a file: sample_data/pan.pcd. Machines are noisy, so the figures to compare are ratios within one run: of the
processor's time, which other processes hardly change, and of the wall's. Bare imports say what part is no work.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parent.parent
IMPORT = [sys.executable, "-c"]
PLAN = [sys.executable, "-m", "flatgrasp_cli", "plan"]
OPEN3D = "import flatgrasp_cli.open3d_door as door; door.load_open3d()"
LIBRARIES = "import numpy, pydantic, yaml, click, cv2, shapely, numpy.random"


def seconds(command: list[str]) -> tuple[float, float]:
    """Processor and wall time of a process, to its end."""
    began = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=ROOT) as process:  # noqa: S603
        _, status, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - began
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(command)}: ended with {process.returncode}")
    return used.ru_utime + used.ru_stime, wall


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="?", default=str(ROOT / "sample_data" / "pan.pcd"))
    parser.add_argument("--repeat", type=int, default=9)
    args = parser.parse_args()
    source = str(Path(args.file).resolve())
    with tempfile.TemporaryDirectory() as folder:
        commands = {
            "import open3d": [*IMPORT, OPEN3D],
            "flatgrasp plan, with its picture": [*PLAN, source, "--out", folder],
            "  --plots none": [*PLAN, source, "--out", folder, "--plots", "none"],
            "  --json": [*PLAN, source, "--json"],
            "import of numpy, pydantic, OpenCV …": [*IMPORT, LIBRARIES],
            "  and of matplotlib's figure": [*IMPORT, f"{LIBRARIES}, matplotlib.figure"],
        }
        for command in commands.values():
            seconds(command)  # what is read from disk, and compiled, the first time
        rounds = [{name: seconds(command) for name, command in commands.items()} for _ in range(args.repeat)]
    print(f"{'median of ' + str(args.repeat):36} {'cpu s':>6} {'wall s':>6} {'ratio: cpu':>11} {'wall':>5}")
    for name in commands:
        cpu, wall = (median(each[name][k] for each in rounds) for k in (0, 1))
        ratios = [median(each[name][k] / each["import open3d"][k] for each in rounds) for k in (0, 1)]
        print(f"{name:36} {cpu:6.2f} {wall:6.2f} {ratios[0]:11.2f} {ratios[1]:5.2f}")


if __name__ == "__main__":
    main()
