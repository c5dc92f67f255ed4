"""`flatgrasp cage POLYGON|CLOUD`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.outputs import Names, Warnings, writing
from flatgrasp_cli.cli.planning_options import planning_options

if TYPE_CHECKING:
    from flatgrasp_cli.geometry.arrays import FloatArray
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.planner.caging import Immobilisation
    from flatgrasp_cli.profiles.settings import CagingSettings

NO_GRASP = 1
Outline = tuple[str, "int | None", "tuple[FloatArray, ...]", "CagingSettings"]


@click.command("cage")
@click.argument("source", metavar="POLYGON|CLOUD")
@planning_options
@click.option("--out", "-o", type=click.Path(path_type=Path, file_okay=False), metavar="DIR", help="Draw a PNG there.")
@click.option("--json", "as_json", is_flag=True, help="Print one document a line.")
def command(source: str, job: Job, out: Path | None, as_json: bool) -> int:
    """Show all grasps of two point fingers on an outline, and within which openings each cages it.

    A POLYGON is a JSON list of [x, y] in any unit, counter-clockwise or not, holes after it as further lists; or CSV of
    x,y. Of a CLOUD it is every object's outline. After Allen, Burdick & Rimon (ICRA 2012). Exit code 1: no such grasp.
    """
    from flatgrasp_cli.planner.caging import immobilising_grasps
    from flatgrasp_cli.results.cages import cage_document
    from flatgrasp_cli.results.document import to_json

    code, names = 0, Names()
    stem = names.of_source(source)
    for name, thing, loops, settings in _outlines(source, job):
        found = immobilising_grasps(loops, settings) if loops else ()
        document = cage_document(name, thing, loops, found, settings)
        if as_json:
            click.echo(to_json(document))
        else:
            _print(document)
        if out is not None and loops:
            _draw(loops, found, document, out / f"{stem if thing is None else f'{stem}.{thing}'}.cage.png")
        code = code if found else NO_GRASP
    return code


def _outlines(source: str, job: Job) -> Iterator[Outline]:
    """What is caged, its number in its cloud, its loops, and the settings for them."""
    from flatgrasp_cli.sources.polygon import is_polygon, read_polygon

    caging = job.settings.caging
    if is_polygon(source):
        exact = {"tolerance_m": 0.0, "noise_m": 0.0, "told_apart_m": 0.0, "max_vertices": 1000}
        yield source, None, read_polygon(source), caging.model_copy(update=exact)
        return
    warnings = Warnings()
    for cloud, _ in job.clouds(source):
        plan = job.plan(cloud)
        warnings.tell(plan, source)
        for item in plan.objects:
            outline = item.trace.silhouette
            yield str(cloud.source), item.object.id, outline.loops if outline else (), caging


def _print(document: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    name = document["source"] if document["object"] is None else f"{document['source']}, object {document['object']}"
    if not document["grasps"]:
        click.echo(f"{name}: {document['reason']}")
        return
    table = Table(title=escape(name), title_justify="left")
    way = "max" if document["closing"] == "inward" else "min"
    for heading in ("rank", "width", "another grasp from", "gets away from", "contacts"):
        table.add_column(heading, justify="right")
    for grasp in document["grasps"]:
        cage = grasp["cage"]
        limits = [cage[f"basin_opening_{way}_m"], cage[f"opening_{way}_m"]]
        table.add_row(
            str(grasp["rank"]),
            f"{grasp['width_m']:.4g}",
            *("never" if limit is None else f"{limit:.4g}" for limit in limits),
            "   ".join(f"{x:.4g} {y:.4g}" for x, y in grasp["contacts"]),
        )
    console = Console(width=None if sys.stdout.isatty() else 120)
    with console.capture() as text:
        console.print(table)
    click.echo(text.get(), nl=False)


def _draw(
    loops: tuple[FloatArray, ...], found: tuple[Immobilisation, ...], document: dict[str, Any], path: Path
) -> None:
    from flatgrasp_cli.results.figures import save_figure
    from flatgrasp_cli.results.figures.cage import cage_figure

    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        save_figure(cage_figure(loops, found, Path(document["source"]).name), path)
