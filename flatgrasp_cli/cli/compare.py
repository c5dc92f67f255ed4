"""`flatgrasp compare CLOUD…`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.console import show
from flatgrasp_cli.cli.defaults import context_of
from flatgrasp_cli.cli.outputs import NO_GRASP, Names, Pictures, Sources, Warnings, say_refusal, say_written
from flatgrasp_cli.cli.planning_options import planning_options

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flatgrasp_cli.job import Job
    from flatgrasp_cli.methods.comparison import Comparison
    from flatgrasp_cli.planning import Plan


WIDEST_NAME = 24
"""Names of sources up to this long are never broken, longer ones are: the reasons beside them keep a sixth of a line of
80 columns."""


@click.command("compare", context_settings=context_of("compare"))
@click.argument("sources", metavar="CLOUD…", nargs=-1, required=True)
@planning_options
@click.option("--out", "-o", type=click.Path(path_type=Path, file_okay=False), metavar="DIR", help="Draw PNGs there.")
@click.option("--json", "as_json", is_flag=True, help="Print one document an object a line.")
def command(sources: tuple[str, ...], job: Job, out: Path | None, as_json: bool) -> int:
    """Compare our grasps with those of two point fingers (Allen, Burdick & Rimon 2012), as the paper's figure 21 does.

    Says which of theirs the gripper cannot carry out, and why. Draws STEM.compare.png of each object with --out.

    Exit code 0: ours finds a grasp in every cloud; 1: in some cloud it finds none, stderr says why; 2: some picture
    could not be drawn; 3: some source could not be read.
    """
    from flatgrasp_cli.methods.comparison import compare
    from flatgrasp_cli.results.document import to_json

    names, reading, pictures = Names(), Sources(len(sources)), Pictures(out)
    warnings, rows, code = Warnings(), [], 0
    for source in sources:
        stem = names.of_source(source)
        with reading.each():
            for cloud, _ in job.clouds(source):
                plan, name = job.plan(cloud), names.of_frame(stem, cloud, source)
                warnings.tell(plan, source)
                for pair in (compare(item, plan.gripper, plan.settings) for item in plan.objects):
                    rows.append(_row(str(cloud.source), pair))
                    if as_json:
                        click.echo(to_json(rows[-1]))
                    pictures.save(f"{name}.{pair.ours.object.id}.compare", partial(_figure, pair, plan))
                if plan.best is None:
                    say_refusal(plan)
                    code = NO_GRASP
    if rows and not as_json:
        _print(rows)
    say_written(pictures.written)
    return reading.code or pictures.code or code


def _row(source: str, pair: Comparison) -> dict[str, Any]:
    from flatgrasp_cli.proof import is_caged
    from flatgrasp_cli.results.contracts.compare import SCHEMA_ID, CompareDocument, OursPart, PointFingersPart

    best = pair.ours.grasps[0] if pair.ours.grasps else None
    widths = [] if pair.theirs is None else pair.theirs.distance.tolist()
    document = CompareDocument(
        schema=SCHEMA_ID,
        source=source,
        object=pair.ours.object.id,
        ours=None if best is None else OursPart(width_m=best.width_m, caged=is_caged(best.cage)),
        point_fingers=[
            PointFingersPart(width_m=width_m, executable=verdict is None, reason=verdict)
            for width_m, verdict in zip(widths, pair.verdicts, strict=True)
        ],
    )
    return dict(document)


def _print(rows: list[dict[str, Any]]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    longest = max(len(Path(row["source"]).name) for row in rows)
    table.add_column("source", overflow="fold", no_wrap=longest <= WIDEST_NAME, max_width=WIDEST_NAME)
    for heading in ("object", "our best\nmm", "caged", "point\nfingers", "the hand\ncan"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("why not the first that it cannot", overflow="fold")
    for row in rows:
        theirs = row["point_fingers"]
        reason = next((each["reason"] for each in theirs if each["reason"]), "")
        ours = row["ours"]
        table.add_row(
            Text(Path(row["source"]).name),
            str(row["object"]),
            f"{1000 * ours['width_m']:.1f}" if ours else "none",
            {True: "yes", False: "no"}[ours["caged"]] if ours else "",
            str(len(theirs)),
            str(sum(each["executable"] for each in theirs)),
            Text(reason),
        )
    show("Lei & Wisse 2016 and two point fingers (Allen et al. 2012)", table)


def _figure(pair: Comparison, plan: Plan) -> Figure | None:
    from flatgrasp_cli.results.figures.comparison import comparison_figure

    if pair.theirs is None:
        return None
    return comparison_figure(plan, pair.ours, pair.theirs.contacts, pair.verdicts, Path(plan.cloud.source.path).name)
