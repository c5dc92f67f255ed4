"""`flatgrasp plan SOURCE…`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.cli.bag_options import BagFile, bag_options
from flatgrasp_cli.cli.defaults import context_of
from flatgrasp_cli.cli.outputs import NO_GRASP, Names, Outputs, Sources, say_written
from flatgrasp_cli.cli.planning_options import planning_options
from flatgrasp_cli.cli.progress import FrameProgress

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job


@click.command("plan", context_settings=context_of("plan"))
@click.argument("sources", metavar="SOURCE…", nargs=-1, required=True)
@planning_options
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
@bag_options
@click.option("--wide", is_flag=True, help="Print all columns, however wide the table gets.")
def command(
    sources: tuple[str, ...], job: Job, bag: BagFile, out: Path | None, as_json: bool, plots: str, wide: bool
) -> int:
    """Plan grasps on clouds, meshes, depth images, recordings, or "-" for standard input.

    Clouds are PCD or PLY; meshes PLY, STL, OBJ, OFF or glTF, sampled; depth images PNG, TIFF or .npy with --intrinsics,
    alone or a folder of them; recordings MCAP files, ROS 1 bags, or ROS 2 bags, folder or file. Writes STEM.grasps.json
    and STEM.grasps.png for each cloud, STEM.STAMP.grasps.* for each frame of a recording, STEM.IMAGE.grasps.* for each
    image of a folder, STEM.arm.png with --robot, and prints the best grasps. Exit code 0: a grasp for every cloud; 1:
    some cloud has none, the document says why; 2: some file could not be written or picture drawn; 3: some source could
    not be read.
    """
    names, reading = Names(), Sources(len(sources))
    bag.check_new()
    with FrameProgress(len(sources)) as progress, bag.opened() as opened:
        outputs = Outputs(out if as_json else out or Path(), as_json, plots, progress, wide=wide, bag=opened)
        for number, source in enumerate(sources):
            _refuse_terminal(source)
            stem = names.of_source(source)
            with reading.each():
                for cloud, read_ms in job.clouds(source, colors=outputs.draws or opened is not None):
                    progress.frame(number)
                    outputs.write(job.plan(cloud), source, names.of_frame(stem, cloud, source), read_ms)
    say_written([*outputs.pictures.written, *bag.written])
    return reading.code or outputs.pictures.code or (NO_GRASP if outputs.refused else 0)


def _refuse_terminal(source: str) -> None:
    if source == "-" and sys.stdin is not None and sys.stdin.isatty():
        raise click.UsageError("'-' reads a cloud from standard input, which is a terminal; pipe a file into it")
