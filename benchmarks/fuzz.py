"""Does any input bring the command line down? Mutates small inputs of every format and runs the real commands on them.

    python benchmarks/fuzz.py [--minutes 10] [--seed 0] [--only pcd ply mcap bag polygon gripper robot settings]

Each input is planned, inspected or checked in a process forked for it, with 20 s of time, and 1 GB of memory more than
the imports take. It must end with exit code 0, 1, 2 or 3; print JSON without NaN and nothing else; and say what is
wrong in words: no traceback, no warning of a library. Inputs that fail are kept, each with what it printed.
"""

from __future__ import annotations

import argparse
import importlib
import io
import json
import os
import pkgutil
import random
import re
import resource
import signal
import struct
import sys
import tempfile
import time
import traceback
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from flatgrasp_cli.threads import one_thread_each

one_thread_each()
import numpy as np
from mutations import mutant

import flatgrasp_cli
from flatgrasp_cli.cli import run
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.open3d_door import load_open3d

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = ROOT / "sample_data"
MEMORY_BYTES, SECONDS = 1 << 30, 20
GRIPPER = ("--gripper", "pr2")
CHATTER = ("Traceback", "Warning", "[Open3D", "OpenCV", "Fatal", "terminate")


@dataclass(frozen=True)
class Format:
    """Files of one format: the suffix of its mutants, the seeds, and the commands to run ("FILE" is the mutant)."""

    suffix: str
    seeds: tuple[bytes, ...]
    commands: tuple[tuple[str, ...], ...]
    text: bool = False


def plate() -> FloatArray:
    """Points (800, 3) of a plate, 120 × 40 × 10 mm, 0.8 m in front of the sensor."""
    half = np.array([0.06, 0.02, 0.005])
    points: FloatArray = np.random.default_rng(0).uniform(-half, half, (800, 3)) + np.array([0, 0, 0.8])
    return points


def pcd_seeds() -> tuple[bytes, ...]:
    """PCD files: text, binary, compressed."""
    points = plate()
    head = (
        b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 800\nHEIGHT 1\n"
        b"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 800\nDATA "
    )
    rows = "\n".join(" ".join(f"{value:.4f}" for value in row) for row in points[:200].tolist())
    text = head.replace(b"800", b"200") + b"ascii\n" + rows.encode() + b"\n"
    values = points.astype("<f4")
    return text, head + b"binary\n" + values.tobytes(), head + b"binary_compressed\n" + packed(values.T.tobytes())


def packed(data: bytes) -> bytes:
    """The body of a compressed PCD: both sizes, and LZF's plainest code, runs of 32 bytes as they are."""
    runs = (data[begin : begin + 32] for begin in range(0, len(data), 32))
    code = b"".join(bytes([len(run) - 1]) + run for run in runs)
    return struct.pack("<2I", len(code), len(data)) + code


def ply_seeds() -> tuple[bytes, ...]:
    """PLY files: text, binary of both ends first, with faces."""
    points = plate()
    vertex = b"element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
    rows = "\n".join(" ".join(f"{value:.4f}" for value in row) for row in points[:100].tolist()).encode()
    faces = b"element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    return (
        b"ply\nformat ascii 1.0\n" + vertex % 100 + faces + rows + b"\n3 0 1 2\n3 1 2 3\n",
        b"ply\nformat binary_little_endian 1.0\n" + vertex % 800 + b"end_header\n" + points.astype("<f4").tobytes(),
        b"ply\nformat binary_big_endian 1.0\n" + vertex % 800 + b"end_header\n" + points.astype(">f4").tobytes(),
        b"ply\nformat binary_little_endian 1.0\n" + vertex % 3 + faces + points[:3].astype("<f4").tobytes() + bytes(26),
    )


def polygon_seeds() -> tuple[bytes, ...]:
    """A notched outline, and one with a hole."""
    notched = [[0, 0], [80.5, 0], [80, 60], [60, 60], [60, 20], [20, 20], [20, 60], [0, 60]]
    return json.dumps(notched).encode(), json.dumps([notched, [[5, 5], [5, 10], [10, 10]]]).encode()


def configs(kind: str, *names: str) -> tuple[bytes, ...]:
    """Shipped profiles without their comments, which mutants would only hide in."""
    texts = ((ROOT / "configs" / kind / f"{name}.yaml").read_text(encoding="utf-8") for name in names)
    return tuple(re.sub(r" *#.*", "", text).encode() for text in texts)


def formats(cloud: Path) -> dict[str, Format]:
    """What is fuzzed; profiles are planned with on `cloud`."""
    plan = ("plan", "FILE", "--json", *GRIPPER)
    clouds = (plan, ("inspect", "FILE", "--json"), ("cage", "FILE", "--json", *GRIPPER))
    recordings = (plan, ("plan", "FILE", "--json", "--base-frame", "base_link", *GRIPPER), clouds[1])
    check, use = ("profiles", "check", "FILE"), ("plan", str(cloud), "--json")
    mcaps = [path.read_bytes() for path in (SAMPLES / "pan_foxglove.mcap", *sorted(SAMPLES.glob("pan_ros2/*.mcap")))]
    pose = ("--camera-pose", "0.4,0.1,1.2,1,0,0,0")
    return {
        "pcd": Format(".pcd", pcd_seeds(), clouds),
        "ply": Format(".ply", ply_seeds(), clouds),
        "mcap": Format(".mcap", tuple(mcaps), recordings),
        "bag": Format(".bag", ((SAMPLES / "pan_ros1.bag").read_bytes(),), recordings),
        "polygon": Format(".json", polygon_seeds(), (("cage", "FILE", "--json"),), text=True),
        "gripper": Format(
            ".yaml", configs("grippers", "pr2", "lacquey"), (check, (*use, "--gripper", "FILE")), text=True
        ),
        "robot": Format(
            ".yaml", configs("robots", "ur5"), (check, (*use, *GRIPPER, *pose, "--robot", "FILE")), text=True
        ),
        "settings": Format(
            ".yaml", configs("planner", "default", "paper"), (check, (*use, *GRIPPER, "--method", "FILE")), text=True
        ),
    }


def verdict(command: list[str], folder: Path, limit: int) -> tuple[int, str]:
    """Exit code of a command in a process of its own, and what is wrong with how it ended, or nothing."""
    out, err = folder / "stdout", folder / "stderr"
    child = os.fork()
    if child == 0:
        become(command, out, err, limit)
    _, status = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(status)
    said = err.read_text(encoding="utf-8", errors="replace")
    if code == -signal.SIGALRM:
        return code, f"not done after {SECONDS} s"
    if code not in (0, 1, 2, 3):
        return code, f"exit code {code}\n{said}"
    if any(word in said for word in CHATTER):
        return code, said
    if command[0] in ("plan", "inspect", "cage"):
        try:
            for line in out.read_text(encoding="utf-8").splitlines():
                json.loads(line, parse_constant=lambda name: 1 // (name == ""))
        except (ValueError, ZeroDivisionError) as error:
            return code, f"stdout is no JSON: {error!r}\n{said}"
    return code, ""


def become(command: list[str], out: Path, err: Path, limit: int) -> None:
    """Be the command, in a process that was forked for it."""
    for number, path in ((1, out), (2, err)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
    sys.stdout, sys.stderr = (io.TextIOWrapper(io.FileIO(n, "w"), write_through=True) for n in (1, 2))
    sys.argv = ["flatgrasp", *command]
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    signal.alarm(SECONDS)
    code = 70
    try:
        code = run()
        sys.stdout.flush()
    except BaseException:  # noqa: BLE001 - that it happened is what is looked for
        traceback.print_exc()
    os._exit(code)


def load_everything() -> int:
    """Import what any command may; how much memory, in bytes, a process may then take."""
    for module in pkgutil.walk_packages(flatgrasp_cli.__path__, "flatgrasp_cli."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    for name in ("cv2", "rich.table", "scipy.ndimage", "scipy.sparse.csgraph", "scipy.spatial", "shapely"):
        importlib.import_module(name)
    load_open3d()
    pages = Path("/proc/self/statm")
    if not pages.exists():
        return resource.RLIM_INFINITY
    return int(pages.read_text(encoding="ascii").split()[0]) * resource.getpagesize() + MEMORY_BYTES


@dataclass(frozen=True)
class Fuzzer:
    """Damages files in `folder`, and keeps in `kept` those on which a command falls."""

    folder: Path
    kept: Path
    limit: int
    rng: random.Random

    def fuzz(self, name: str, kind: Format, seconds: float) -> Counter[str]:
        """Fuzz one format for so long; how often a command ended with which exit code, or fell."""
        end, ended = time.monotonic() + seconds, Counter[str]()
        while time.monotonic() < end:
            path = self.folder / f"mutant{kind.suffix}"
            path.write_bytes(mutant(kind.seeds, text=kind.text, rng=self.rng))
            for command in kind.commands:
                words = [str(path) if word == "FILE" else word for word in command]
                code, fault = verdict(words, self.folder, self.limit)
                ended[str(code)] += 1
                if fault:
                    ended["fell"] += 1
                    self.keep(f"{name}-{ended['fell']:03d}", path, command, fault)
                if command[0] == "profiles" and code != 0:
                    break  # a faulty profile is no use to plan with
        return ended

    def keep(self, name: str, path: Path, command: tuple[str, ...], fault: str) -> None:
        """Keep an input with the command and what it printed."""
        self.kept.mkdir(parents=True, exist_ok=True)
        (self.kept / f"{name}{path.suffix}").write_bytes(path.read_bytes())
        (self.kept / f"{name}.txt").write_text(f"{' '.join(command)}\n{fault}", encoding="utf-8")


def main() -> None:
    """Fuzz every format for its share of the time, and print how the commands ended."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", nargs="+", metavar="FORMAT")
    parser.add_argument("--keep", type=Path, default=Path("fuzz-findings"), metavar="DIR", help="for inputs that fail")
    chosen = parser.parse_args()
    limit = load_everything()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        cloud = folder / "plate.pcd"
        cloud.write_bytes(pcd_seeds()[1])
        kinds = formats(cloud)
        names = chosen.only or list(kinds)
        fuzzer = Fuzzer(folder, chosen.keep, limit, random.Random(chosen.seed))  # noqa: S311
        fell = 0
        for name in names:
            ended = fuzzer.fuzz(name, kinds[name], 60 * chosen.minutes / len(names))
            fell += ended["fell"]
            print(f"{name:9}", *(f"{key}: {ended[key]:6}" for key in sorted(ended)), sep="  ", flush=True)
    print(f"{fell} failures" + (f", see {chosen.keep}" if fell else ""))
    sys.exit(fell > 0)


if __name__ == "__main__":
    main()
