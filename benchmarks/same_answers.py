"""Do two installations give the same answers? Documents of the same clouds, key by key.

    python benchmarks/same_answers.py OLD/bin/flatgrasp NEW/bin/flatgrasp sample_data/*.pcd [-- --gripper pr2]

Objects, ranks, refusals and words have to be equal, and numbers within 1e-6 (metres, radians, parts of 1); where sums
are made in another order, last digits differ. All else is listed. Exit code 1 if anything is.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator
from itertools import zip_longest
from pathlib import Path
from typing import Any

TOLERANCE = 1e-6
LISTED = 8
"""Differences shown of each document."""


def documents(program: Path, path: Path, options: list[str]) -> list[Any]:
    """What a program says of a file; of one that it refuses, how it does."""
    command = [str(program), "plan", str(path.resolve()), "--json", *options]
    # elsewhere: python -m would run the program of a checkout that is the current folder
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=program.parent)  # noqa: S603
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    for line in lines:
        line.pop("timing_ms")
    return [*lines, {"exit code": done.returncode, "stderr": done.stderr}]


def differences(old: Any, new: Any, where: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Every place where two documents differ, and what stands there in each."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted(old.keys() | new.keys()):
            yield from differences(old.get(key), new.get(key), f"{where}.{key}")
    elif isinstance(old, list) and isinstance(new, list):
        for index, (one, other) in enumerate(zip_longest(old, new)):
            yield from differences(one, other, f"{where}[{index}]")
    elif not same(old, new):
        yield where, old, new


def same(old: Any, new: Any) -> bool:
    """Whether two values are equal, numbers within the tolerance."""
    if isinstance(old, int | float) and isinstance(new, int | float):
        return abs(old - new) <= TOLERANCE
    return bool(old == new)


def main() -> int:
    """Compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=lambda text: Path(text).resolve())
    parser.add_argument("new", type=lambda text: Path(text).resolve())
    parser.add_argument("clouds", nargs="+", type=Path)
    split = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    args, options = parser.parse_args(sys.argv[1:split]), sys.argv[split + 1 :]
    differing = 0
    for path in args.clouds:
        found = list(differences(documents(args.old, path, options), documents(args.new, path, options)))
        differing += bool(found)
        for where, old, new in found[:LISTED]:
            print(f"{path}{where}: {str(old)[:60]} → {str(new)[:60]}")
        if len(found) > LISTED:
            print(f"{path}: and {len(found) - LISTED} more")
    print(f"{len(args.clouds)} clouds, {differing} of them with other answers")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
