"""The options of `flatgrasp simulate`, and what they say: the planner's job, the conditions, and what is grasped."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.completion import complete_profile
from flatgrasp_cli.cli.defaults import option
from flatgrasp_cli.cli.imports import importing
from flatgrasp_cli.cli.jobs import job_of
from flatgrasp_cli.cli.planning_options import (
    APPROACH_OPTIONS,
    CAGE_OPTIONS,
    DEFAULTS_OPTIONS,
    METHOD_OPTIONS,
    SCALE_OPTION,
)
from flatgrasp_cli.errors import SourceError

if TYPE_CHECKING:
    from flatgrasp_cli.profiles import Gripper
    from flatgrasp_cli.simulation.things import Thing
    from flatgrasp_cli.simulation.trial import Cell, Conditions

NO_ROBOT = "none"
PAPERS_OWN = ("teddy_bear", "electric_drill", "pistol", "spray_bottle", "pan")
ASSUMED_FORCE_N = 40.0
"""Of a hand whose force nobody states: half of what the weakest grippers with a data sheet press with, so that weight
and friction tell."""
MISS = re.compile(r"(?P<mm>\d+(?:\.\d+)?)mm(?:,(?P<deg>\d+(?:\.\d+)?)deg)?")


def _miss(_context: click.Context, _parameter: click.Parameter, text: str | None) -> tuple[float, float]:
    """Metres and degrees of "5mm,5deg"."""
    found = MISS.fullmatch(text or "0mm")
    if found is None:
        raise click.BadParameter(f"{text!r} is no miss; give millimetres and perhaps degrees, e.g. 5mm,5deg")
    return 1e-3 * float(found["mm"]), float(found["deg"] or 0.0)


OPTIONS = (
    *METHOD_OPTIONS,
    option(
        "--robot",
        default="ur5",
        show_default=True,
        metavar="NAME|FILE|none",
        shell_complete=complete_profile("robot"),
        help="Robot profile: the arm that carries the hand and the camera; none: both float.",
    ),
    click.option(
        "--trials", type=click.IntRange(min=1), default=10, show_default=True, help="Trials with each object."
    ),
    click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="What is random follows it."),
    click.option(
        "--objects-per-scene",
        "per_scene",
        type=click.IntRange(min=2),
        metavar="N",
        help="Heaps of so many of the objects, each cleared grasp by grasp; --trials is the number of heaps.",
    ),
    click.option(
        "--mu",
        type=click.FloatRange(0.01, 5),
        metavar="μ",
        help="Friction of the pads on the object; the gripper profile's if not given.",
    ),
    click.option("--mass", type=click.FloatRange(0.001, 100), metavar="KG", help="What each object weighs."),
    click.option(
        "--force",
        type=click.FloatRange(0.1, 10_000),
        metavar="N",
        help="How hard a jaw presses, newtons; the gripper profile's if not given.",
    ),
    click.option(
        "--sensor-tilt",
        "tilt_deg",
        type=click.FloatRange(0, 60),
        default=20.0,
        show_default=True,
        metavar="DEGREES",
        help="Angle of the camera's axis with the vertical.",
    ),
    click.option("--miss", callback=_miss, metavar="5mm,5deg", help="A hand that misses at random by as much (1 σ)."),
    SCALE_OPTION,
    *APPROACH_OPTIONS,
    *CAGE_OPTIONS,
    *DEFAULTS_OPTIONS,
)
JOB = ("gripper", "method", "given", "prefer", "require", "closing", "approach", "max_tilt", "verbose")
CONDITIONS = ("mu", "force", "tilt_deg", "miss", "seed")


def simulation_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options, and as `cell` and `things` what they and its argument `objects` say."""

    @wraps(command)
    def with_cell(objects: tuple[str, ...], robot: str, mass: float | None, scale: float, **options: Any) -> Any:
        job, chosen = ({name: options.pop(name) for name in names} for names in (JOB, CONDITIONS))
        cell = _cell(None if robot == NO_ROBOT else robot, job, chosen)
        things = [_thing(name, scale, mass) for name in objects or PAPERS_OWN]
        return command(cell=cell, things=things, **options)

    for each in reversed(OPTIONS):
        with_cell = each(with_cell)
    return with_cell


def _cell(robot: str | None, job: dict[str, Any], chosen: dict[str, Any]) -> Cell:
    with importing():
        from flatgrasp_cli.simulation.engine import load_mujoco

        load_mujoco()
        from flatgrasp_cli.simulation.trial import Cell
    planned = job_of({**job, "robot": robot})
    return Cell(planned, _conditions(planned.gripper, **chosen))


def _conditions(
    gripper: Gripper, mu: float | None, force: float | None, tilt_deg: float, miss: tuple[float, float], seed: int
) -> Conditions:
    from flatgrasp_cli.simulation.trial import Conditions

    known = force or gripper.max_force_n
    if known is None:
        click.echo(
            f"flatgrasp: warning: {gripper.name}: its profile has no max_force_n, {ASSUMED_FORCE_N:g} N are assumed; "
            "--force states it",
            err=True,
        )
    return Conditions(
        friction=mu or gripper.pad_friction,
        force_n=known or ASSUMED_FORCE_N,
        force_from="option" if force else "assumed" if known is None else "profile",
        tilt_deg=tilt_deg,
        miss_m=miss[0],
        miss_deg=miss[1],
        seed=seed,
    )


def _thing(name: str, scale: float, mass_kg: float | None) -> Thing:
    """A sample by its name, or the thing of a mesh file."""
    from pathlib import Path

    from flatgrasp_cli.simulation.meshes import mesh_file_thing
    from flatgrasp_cli.simulation.samples import SAMPLES
    from flatgrasp_cli.simulation.things import sample_thing

    if name in SAMPLES:
        return sample_thing(name, mass_kg)
    if not Path(name).is_file():
        raise SourceError(f"{name}: is neither a mesh file nor one of the paper's objects: {', '.join(SAMPLES)}")
    return mesh_file_thing(name, scale, mass_kg)
