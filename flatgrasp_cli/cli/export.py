"""`flatgrasp export DOCUMENT… --format FORMAT`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.cli.outputs import NO_GRASP, Names, say_written, writing
from flatgrasp_cli.results.exports import FORMATS
from flatgrasp_cli.whole_files import write_bytes

if TYPE_CHECKING:
    from flatgrasp_cli.results.saved import SavedDocument

HELP = """Write the grasps of documents in the format of another program.

A DOCUMENT is what plan or batch wrote, STEM.grasps.json or NAME.jsonl, or "-" for standard input. Writes STEM.ENDING
into DIR, and of several frames one file for each with its time in the name, but one table for all. Exit code 0: every
frame has a grasp; 1: some frame has none, and its file is empty; 2: the gripper's profile lacks what the format needs;
3: some document could not be read.

\b
"""
LIST = "\n".join(f"{name:<9} STEM{each.ending}: {each.about}" for name, each in FORMATS.items())


@click.command("export", help=HELP + LIST)
@click.argument("documents", metavar="DOCUMENT…", nargs=-1, required=True)
@click.option("--format", "name", type=click.Choice(tuple(FORMATS)), required=True, help="Which format.")
@click.option(
    "--out",
    "-o",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path(),
    metavar="DIR",
    help="Folder of the files; the current one if not given.",
)
def command(documents: tuple[str, ...], name: str, out: Path) -> int:
    """Write the grasps of documents in the format of another program."""
    from flatgrasp_cli.results.exports import exported
    from flatgrasp_cli.results.saved import read_documents

    written, refused, names = list[Path](), 0, Names()
    for path in documents:
        frames = list(read_documents(path))
        refused += sum(frame.status != "ok" for frame in frames)
        for stem, group in _files(path, frames, names, together=FORMATS[name].many_frames):
            file = out / f"{stem}{FORMATS[name].ending}"
            content = exported(name, group)
            with writing(file):
                write_bytes(file, content)
            written.append(file)
    say_written(written)
    if refused:
        click.echo(f"flatgrasp: {refused} frame{'s' * (refused > 1)} without a grasp; the document says why", err=True)
    return NO_GRASP if refused else 0


def _files(
    path: str, frames: list[SavedDocument], names: Names, *, together: bool
) -> Iterator[tuple[str, list[SavedDocument]]]:
    """Stem and frames of each file that one document makes."""
    from flatgrasp_cli.results.saved import stem_of

    stem = stem_of(path)
    if together or len(frames) == 1:
        yield names.unique(stem), frames
        return
    for frame in frames:
        yield names.at(stem, frame.source.stamp_ns), [frame]
