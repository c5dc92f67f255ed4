"""`flatgrasp cage POLYGON|CLOUD`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.console import show
from flatgrasp_cli.cli.defaults import context_of
from flatgrasp_cli.cli.outputs import NO_GRASP, Names, Pictures, Warnings, say_refusal, say_written
from flatgrasp_cli.cli.planning_options import planning_options
from flatgrasp_cli.source_names import name_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flatgrasp_cli.geometry.arrays import FloatArray
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.model import ObjectPlan
    from flatgrasp_cli.profiles.settings import CagingSettings
    from flatgrasp_cli.proof.caging import Immobilisation


LISTED = 50
"""Grasps that are printed for people."""


@dataclass(frozen=True, slots=True)
class _Outline:
    """What is caged: `thing` is its number in its cloud, None for a polygon; `stem` names its files.

    `missing` says why there are no loops, where the planner knows more than that the points are too scattered.
    """

    stem: str
    source: str
    thing: int | None
    loops: tuple[FloatArray, ...]
    settings: CagingSettings
    missing: str | None = None


@click.command("cage", context_settings=context_of("cage"))
@click.argument("source", metavar="POLYGON|CLOUD")
@planning_options
@click.option("--out", "-o", type=click.Path(path_type=Path, file_okay=False), metavar="DIR", help="Draw a PNG there.")
@click.option("--json", "as_json", is_flag=True, help="Print one document a line.")
def command(source: str, job: Job, out: Path | None, as_json: bool) -> int:
    """Show all grasps of two point fingers on an outline, and within which openings each cages it.

    A POLYGON is a JSON list of [x, y] in any unit, counter-clockwise or not, holes after it as further lists; or CSV of
    x,y; "-" is standard input. Of a CLOUD it is every object's outline. After Allen, Burdick & Rimon (ICRA 2012).

    Exit code 0: a grasp on every outline; 1: none on some, or no object in some cloud; 2: some picture could not be
    drawn; 3: the source could not be read.
    """
    from flatgrasp_cli.proof.caging import immobilising_grasps
    from flatgrasp_cli.results.cages import cage_document
    from flatgrasp_cli.results.document import to_json

    code, pictures = 0, Pictures(out)
    for outlines in _outlines(source, job):
        for one in outlines:
            found = immobilising_grasps(one.loops, one.settings) if one.loops else ()
            document = cage_document(one.source, one.thing, one.loops, found, one.settings)
            document["reason"] = one.missing or document["reason"]
            if as_json:
                click.echo(to_json(document))
            else:
                _print(document)
            pictures.save(f"{one.stem}.cage", partial(_figure, one, found))
            code = code if found else NO_GRASP
        code = code if outlines else NO_GRASP
    say_written(pictures.written)
    return pictures.code or code


def _outlines(source: str, job: Job) -> Iterator[list[_Outline]]:
    """The polygon, or the outlines of all objects of each cloud; says on stderr when a cloud shows none."""
    from flatgrasp_cli.sources.polygon import is_polygon, read_polygon

    caging, names = job.settings.caging, Names()
    stem = names.of_source(source)
    if is_polygon(source):
        exact = {"tolerance_m": 0.0, "noise_m": 0.0, "told_apart_m": 0.0, "max_vertices": 1000}
        yield [
            _Outline(
                stem=stem,
                source=name_of(source),
                thing=None,
                loops=read_polygon(source),
                settings=caging.model_copy(update=exact),
            )
        ]
        return
    warnings = Warnings()
    for cloud, _ in job.clouds(source):
        plan, name = job.plan(cloud), names.of_frame(stem, cloud, source)
        warnings.tell(plan, source)
        if not plan.objects:
            say_refusal(plan)
        yield [_of_object(item, name, str(cloud.source), caging) for item in plan.objects]


def _of_object(item: ObjectPlan, name: str, source: str, caging: CagingSettings) -> _Outline:
    thing, outline = item.object.id, item.silhouette
    return _Outline(
        stem=f"{name}.{thing}",
        source=source,
        thing=thing,
        loops=outline.loops if outline else (),
        settings=caging,
        missing=item.rejection.reason if outline is None and item.rejection else None,
    )


def _print(document: dict[str, Any]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    name = document["source"] if document["object"] is None else f"{document['source']}, object {document['object']}"
    if not document["grasps"]:
        show(Text(f"{name}: {document['reason']}"))
        return
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    way = "max" if document["closing"] == "inward" else "min"
    for heading in ("rank", "width", "another\ngrasp from", "gets away\nfrom", "contacts\nx y   x y"):
        table.add_column(heading, justify="right", no_wrap=True)
    for grasp in document["grasps"][:LISTED]:
        cage = grasp["cage"]
        limits = [cage[f"basin_opening_{way}_m"], cage[f"opening_{way}_m"]]
        table.add_row(
            str(grasp["rank"]),
            f"{grasp['width_m']:.4g}",
            *("never" if limit is None else f"{limit:.4g}" for limit in limits),
            "   ".join(f"{x:.4g} {y:.4g}" for x, y in grasp["contacts"]),
        )
    more = len(document["grasps"]) - LISTED
    unit = "in the polygon's own unit" if document["object"] is None else "in metres"
    show(Text(f"{name}; lengths {unit}"), table, *([Text(f"and {more} more; --json lists them")] if more > 0 else []))


def _figure(outline: _Outline, found: tuple[Immobilisation, ...]) -> Figure | None:
    from flatgrasp_cli.results.figures.cage import cage_figure

    if not outline.loops:
        return None
    name = Path(outline.source).name
    title = name if outline.thing is None else f"{name}, object {outline.thing}"
    return cage_figure(outline.loops, found, title, in_metres=outline.thing is not None)
