"""`flatgrasp plan SOURCE…`."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.cli.completion import complete_profile
from flatgrasp_cli.cli.mounting import mounting
from flatgrasp_cli.cli.outputs import Names, Outputs
from flatgrasp_cli.cli.recordings import frame_options
from flatgrasp_cli.errors import SourceError

if TYPE_CHECKING:
    from flatgrasp_cli.model import Cloud
    from flatgrasp_cli.sources.selection import Selection

NO_GRASP = 1


def _positive(_context: click.Context, _parameter: click.Parameter, value: float) -> float:
    if not 0 < value < math.inf:  # false for NaN, too
        raise click.BadParameter(f"{value} is not a positive number")
    return value


@click.command("plan")
@click.argument("sources", metavar="SOURCE…", nargs=-1, required=True)
@click.option(
    "--gripper",
    "-g",
    default="lacquey",
    show_default=True,
    metavar="NAME|FILE",
    shell_complete=complete_profile("gripper"),
    help="Gripper profile; `flatgrasp profiles list` shows them.",
)
@click.option(
    "--method",
    default="default",
    show_default=True,
    metavar="default|paper|FILE",
    shell_complete=complete_profile("planner"),
    help="Planner settings: ours, or the paper's to the letter.",
)
@click.option(
    "--set",
    "overrides",
    multiple=True,
    metavar="KEY=VALUE",
    help="Override a planner setting, e.g. --set fingers.step_m=0.004. Repeatable.",
)
@click.option(
    "--scene",
    type=click.Choice(["auto", "object", "table"]),
    help="One object alone, or objects on a support plane; auto: as the cloud says.",
)
@click.option(
    "--object",
    "select",
    metavar="all|nearest|largest|X,Y",
    help="Which objects of a scene to plan: nearest to the sensor, largest, or nearest to a place.",
)
@click.option("--up", metavar="X,Y,Z", help="Direction of the support plane's normal; else the biggest plane in view.")
@click.option("--crop", metavar="XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX", help="Region of interest in metres.")
@click.option(
    "--robot",
    metavar="NAME|FILE",
    shell_complete=complete_profile("robot"),
    help="Robot profile: keep only grasps that it reaches, with joint angles.",
)
@click.option(
    "--camera-pose",
    metavar="FILE|X,Y,Z,QX,QY,QZ,QW",
    help="Pose of the cloud's frame in the base frame, in which all answers are then given.",
)
@click.option(
    "--base-frame",
    metavar="NAME",
    help="Give all answers in this frame: that of the camera pose, or one of the recording's own; the robot's if there "
    "is one.",
)
@frame_options
@click.option(
    "--scale",
    type=float,
    callback=_positive,
    default=1.0,
    show_default=True,
    help="Metres in one unit of the source; 0.001 for millimetres.",
)
@click.option(
    "--top",
    type=click.IntRange(min=1),
    default=10,
    show_default=True,
    metavar="K",
    help="How many grasps to keep, best first.",
)
@click.option(
    "--out",
    "-o",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Folder for JSON and PNG files; the current one unless --json is given.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one document a line to stdout, no table.")
@click.option(
    "--plots",
    type=click.Choice(["final", "stages", "none"]),
    default="final",
    show_default=True,
    help="The final grasp as PNG, or every stage of the method, or nothing.",
)
def command(
    sources: tuple[str, ...],
    gripper: str,
    method: str,
    overrides: tuple[str, ...],
    scene: str | None,
    select: str | None,
    up: str | None,
    crop: str | None,
    robot: str | None,
    camera_pose: str | None,
    base_frame: str | None,
    selection: Selection,
    scale: float,
    top: int,
    out: Path | None,
    as_json: bool,
    plots: str,
) -> int:
    """Plan grasps on point clouds: PCD or PLY files, recordings, or "-" for standard input.

    A recording is an MCAP file, a ROS 1 bag, or a ROS 2 bag, folder or file. Writes STEM.grasps.json and
    STEM.grasps.png for each cloud, STEM.STAMP.grasps.* for each frame of a recording, and prints the best grasps. Exit
    code 0: a grasp for every cloud; 1: some cloud has none, the document says why; 3: some source could not be read.
    """
    from flatgrasp_cli.planning import plan
    from flatgrasp_cli.profiles import load_gripper, load_settings

    asked = {"scene.mode": scene, "scene.select": _list(select), "scene.up": _list(up), "scene.crop": _list(crop)}
    scene_settings = tuple(f"{key}={value}" for key, value in asked.items() if value is not None)
    hand, settings = load_gripper(gripper), load_settings(method, (*scene_settings, *overrides))
    arm = mounting(robot, camera_pose, base_frame)
    outputs = Outputs(out if as_json else out or Path(), as_json, plots)
    selection = replace(selection, base_frame=arm.looked_up, colors=outputs.draws)
    names = Names()
    code = 0
    for source in sources:
        try:
            stem = names.of_source(source)
            for cloud, read_ms in _timed(source, scale, selection):
                placed = arm.placed(cloud)
                name = names.of_frame(stem, cloud)
                outputs.write(plan(placed, hand, settings, top=top, robot=arm.robot), name, read_ms)
        except SourceError as error:
            if len(sources) == 1:
                raise
            click.echo(f"flatgrasp: {error}", err=True)  # the other sources still get their answer
            code = error.exit_code
    return code or (NO_GRASP if outputs.refused else 0)


def _list(text: str | None) -> str | None:
    """Turn "a,b,c" into the YAML list that a setting of several numbers wants; a word as it is."""
    if text is None:
        return None
    return f"[{text}]" if "," in text else text or "''"  # an empty word is no null


def _timed(source: str, scale: float, selection: Selection) -> Iterator[tuple[Cloud, float]]:
    """The clouds of a source with the milliseconds that reading each took."""
    from flatgrasp_cli.sources import read_clouds

    if source == "-" and sys.stdin is not None and sys.stdin.isatty():
        raise click.UsageError("'-' reads a cloud from standard input, which is a terminal; pipe a file into it")
    clouds = read_clouds(source, scale, selection)
    while True:
        began = time.perf_counter()
        cloud = next(clouds, None)
        if cloud is None:
            return
        yield cloud, 1e3 * (time.perf_counter() - began)
