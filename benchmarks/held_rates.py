"""Which gripper holds what? All shipped grippers on a UR5 try all sample objects, as a table for the documentation.

    python benchmarks/held_rates.py [--trials 10] [--out docs/held_rates.md]

Once by a hand that goes where it should, once by one that misses by 5 mm and 5° (standard deviations). A cell is how
many trials were held of all; then how many of those were clean, if not all, and how many found no grasp. Prints the
seconds that a trial takes besides planning, on one core, as well.
"""

from __future__ import annotations

import os

for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ[f"{library}_NUM_THREADS"] = "1"

import argparse
import time
from pathlib import Path

from flatgrasp_cli import load_gripper, load_robot, load_settings
from flatgrasp_cli.job import Job
from flatgrasp_cli.placing import workcell
from flatgrasp_cli.profiles import list_profiles
from flatgrasp_cli.simulation.samples import SAMPLES
from flatgrasp_cli.simulation.summary import Row, row_of
from flatgrasp_cli.simulation.things import sample_thing
from flatgrasp_cli.simulation.trial import Cell, Conditions
from flatgrasp_cli.simulation.trials import trials_of

MISSES = {"A hand that goes where it should:": (0.0, 0.0), "A hand that misses by 5 mm and 5°:": (0.005, 5.0)}
"""Metres and degrees, by what the tables are called."""
ASSUMED_FORCE_N = 40.0
"""As `flatgrasp simulate` assumes it where a profile has none."""


def cell_of(gripper: str, miss: tuple[float, float]) -> Cell:
    """A UR5 with a gripper, its own friction and force, that misses by metres and degrees."""
    hand = load_gripper(gripper)
    conditions = Conditions(
        friction=hand.pad_friction,
        force_n=hand.max_force_n or ASSUMED_FORCE_N,
        tilt_deg=20.0,
        miss_m=miss[0],
        miss_deg=miss[1],
    )
    return Cell(Job(hand, load_settings(), workcell(load_robot("ur5"), None, None)), conditions)


def tried(cell: Cell, name: str, count: int) -> tuple[Row, float]:
    """The trials of one object in a row, and the seconds of processor time that they took besides planning."""
    began = time.process_time()
    trials = list(trials_of(cell, sample_thing(name), count))
    planning = sum(trial.plan.scene_ms + trial.plan.plan_ms for trial in trials) / 1e3
    return row_of(name, trials), time.process_time() - began - planning


def in_cell(row: Row) -> str:
    """A row in a cell of the table."""
    clean = f", {row.clean} clean" if row.clean < row.held else ""
    return f"{row.held}/{row.trials}{clean}" + (f", {row.no_grasp} no grasp" if row.no_grasp else "")


def table(rows: dict[str, list[Row]]) -> str:
    """The table in Markdown: a line a gripper, a column an object."""
    lines = ["| gripper | " + " | ".join(name.replace("_", " ") for name in SAMPLES) + " |"]
    lines.append("|---" * (1 + len(SAMPLES)) + "|")
    lines += [f"| `{gripper}` | " + " | ".join(map(in_cell, found)) + " |" for gripper, found in rows.items()]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    parts, seconds, trials = [], 0.0, 0
    for words, miss in MISSES.items():
        rows: dict[str, list[Row]] = {}
        for gripper in list_profiles("gripper"):
            cell = cell_of(gripper, miss)
            found = [tried(cell, name, args.trials) for name in SAMPLES]
            rows[gripper] = [row for row, _ in found]
            seconds += sum(took for _, took in found)
            trials += sum(row.trials for row, _ in found)
            for row in rows[gripper]:
                print(gripper, row.object, in_cell(row), *(f"{n} × {why}" for why, n in row.why), sep="; ", flush=True)
        parts.append(f"{words}\n\n{table(rows)}")
    print(*parts, f"{seconds / trials:.2f} s a trial besides planning", sep="\n")
    if args.out is not None:
        args.out.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
