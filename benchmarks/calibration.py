"""Does the probability that a grasp holds come true? Listed grasps of the sample objects, tried by a hand that misses.

    python benchmarks/calibration.py [--gripper pr2] [--scenes 3] [--tries 4] [--out docs/calibration]

Each sample object lies on a table in so many ways. Of the grasps that `plan` lists, the first, the last and some in
between are carried out by a floating hand, which misses at random as the settings' `uncertainty` has it; friction and
mass are random, too. It lifts by 20 cm, and holds an object whose centre of mass comes up by half of that or more.
Prints how often grasps of about the same probability were held, in eight groups of as many tries, the expected
calibration error (ECE: by how much those differ in the mean), the Brier score (of a guess that is the same for all
beside it), and the AUC (how probably a grasp that held had the larger probability than one that did not). With `--out`,
the table goes to a .md and its picture to a .png of that name.
"""

from __future__ import annotations

import os

for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ[f"{library}_NUM_THREADS"] = "1"

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, load_settings
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.job import Job
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.placing import workcell
from flatgrasp_cli.profiles.uncertainty import Uncertainty
from flatgrasp_cli.simulation.looking import Look
from flatgrasp_cli.simulation.samples import SAMPLES
from flatgrasp_cli.simulation.things import Thing, sample_thing
from flatgrasp_cli.simulation.trial import Cell, Conditions, Trial, carried_out
from flatgrasp_cli.simulation.trials import trials_of

GROUPS, RANKS = 8, 5
"""Groups of grasps in the table, and grasps of a scene that are tried."""
LIGHTEST, HEAVIEST = 0.5, 2.0
"""The mass is random between these multiples of the object's own."""
LIFT_M = 0.2
"""As high as things are long that hands hold."""
UNSURE = Uncertainty()


@dataclass(frozen=True)
class Outcome:
    """One try: how probable it was that the grasp holds, and whether it did; `rank` 0 is the best."""

    object: str
    rank: int
    probability: float
    held: bool


def cell_of(gripper: str, seed: int, friction: float, *, missing: bool) -> Cell:
    """A floating hand with that friction, that misses or does not."""
    hand = load_gripper(gripper)
    conditions = Conditions(
        friction=friction,
        force_n=hand.max_force_n or UNSURE.force_n,
        tilt_deg=30.0,
        miss_m=UNSURE.position_m if missing else 0.0,
        miss_deg=UNSURE.yaw_deg if missing else 0.0,
        seed=seed,
    )
    settings = load_settings("default", (f"depth.lift_m={LIFT_M}",))
    return Cell(Job(hand, settings, workcell(None, None, None), top=30), conditions)


def outcomes(gripper: str, thing: Thing, scenes: int, tries: int) -> Iterator[Outcome]:
    """What came of some of the grasps in each of the scenes with an object."""
    friction = load_gripper(gripper).pad_friction
    for trial in trials_of(cell_of(gripper, 0, friction, missing=False), thing, scenes):
        listed = trial.plan.objects[0].grasps if trial.plan.objects else ()
        ranks = {round(rank) for rank in np.linspace(0, len(listed) - 1, RANKS).tolist()} if listed else set[int]()
        rng = np.random.default_rng([trial.number, len(thing.name)])
        for rank in sorted(ranks):
            for _ in range(tries):
                mu = friction * rng.uniform(1 - UNSURE.friction_share, 1 + UNSURE.friction_share)
                heavy = replace(thing, mass_kg=thing.mass_kg * rng.uniform(LIGHTEST, HEAVIEST))
                held = _held(cell_of(gripper, 0, mu, missing=True), heavy, trial, listed[rank], rng)
                success = listed[rank].success
                assert success is not None  # noqa: S101 (the method knows the hand)
                yield Outcome(thing.name, rank, success.probability, held)


def _held(cell: Cell, thing: Thing, trial: Trial, grasp: Grasp, rng: np.random.Generator) -> bool:
    """Whether a grasp of the scene of a trial holds, carried out anew."""
    look = Look(Frame(trial.camera.position, axes_from_quaternion(trial.camera.orientation)), None)
    world = cell.world([thing])
    world.reset(cell.parked(look), cell.gripper.max_opening_m)
    world.put(0, trial.place.position, Rotation.from_quat(trial.place.orientation))
    world.settle(0.2)
    low = world.centers()[0, 2]
    done = carried_out(cell, world, look, rng, grasp)
    return done.status == "held" and bool(world.centers()[0, 2] - low > 0.5 * LIFT_M)


def table(found: list[Outcome]) -> tuple[str, FloatArray]:
    """The table in Markdown, and its groups (g, 3): mean probability, share held, number of tries."""
    chance, held = np.array([one.probability for one in found]), np.array([float(one.held) for one in found])
    parts = np.array_split(np.argsort(chance, kind="stable"), GROUPS)
    groups = np.array([[chance[part].mean(), held[part].mean(), len(part)] for part in parts if len(part)])
    ece = float((groups[:, 2] * np.abs(groups[:, 0] - groups[:, 1])).sum() / len(found))
    won, lost = chance[held > 0], chance[held == 0]
    auc = float((won[:, None] > lost).mean() + 0.5 * (won[:, None] == lost).mean()) if len(won) and len(lost) else 1.0
    first = np.array([one.held for one in found if one.rank == 0])
    lines = ["| said | held | tries |", "|---|---|---|"]
    lines += [f"| {said:.3f} | {share:.3f} | {int(count)} |" for said, share, count in groups]
    summary = (
        f"{len(found)} tries, {100 * held.mean():.1f} % held, of the first grasps {100 * first.mean():.1f} %; "
        f"ECE {ece:.3f}, Brier score {np.mean((chance - held) ** 2):.3f} (the same guess for all: "
        f"{held.mean() * (1 - held.mean()):.3f}), AUC {auc:.2f}."
    )
    return "\n".join([*lines, "", summary]) + "\n", groups


def picture(groups: FloatArray, path: Path) -> None:
    """The reliability diagram: what was said, and what was held."""
    from matplotlib.figure import Figure

    figure = Figure((4.5, 4.5), layout="constrained")
    axes = figure.add_subplot(xlabel="probability that was said", ylabel="share that was held", aspect="equal")
    axes.plot([0, 1], [0, 1], color="0.7", zorder=0)
    axes.scatter(groups[:, 0], groups[:, 1], s=groups[:, 2], color="#0072b2")
    axes.set(xlim=(0, 1.03), ylim=(0, 1.03))
    figure.savefig(path, dpi=120)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gripper", default="pr2")
    parser.add_argument("--scenes", type=int, default=3)
    parser.add_argument("--tries", type=int, default=4)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    found: list[Outcome] = []
    for name in SAMPLES:
        found += outcomes(args.gripper, sample_thing(name), args.scenes, args.tries)
        some = [one for one in found if one.object == name]
        print(f"{name}: {sum(one.held for one in some)} of {len(some)} held", flush=True)
    text, groups = table(found)
    print(text, end="")
    if args.out is not None:
        args.out.with_suffix(".md").write_text(text, encoding="utf-8")
        picture(groups, args.out.with_suffix(".png"))


if __name__ == "__main__":
    main()
