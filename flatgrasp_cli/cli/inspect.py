"""`flatgrasp inspect SOURCE…`."""

from __future__ import annotations

import json
from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.console import show
from flatgrasp_cli.cli.image_options import image_options, of_images
from flatgrasp_cli.cli.outputs import Sources

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

    from flatgrasp_cli.sources.summary import CloudSummary, Summary, TopicSummary

KNOWN_FROM = {
    "option": "stated",
    "projection": "the centre of projection of the organised cloud",
    "viewpoint": "as the file states",
    "inverse_viewpoint": "the inverse of the pose that the file states",
    "frame": "the origin of the cloud's own frame",
    "transforms": "by the recording's transforms",
    "visibility": "the only place that fits the cloud's shape",
    "up": "only the way up is known",
    "assumed": "assumed",
    "all_sides": "seen from all sides",
}
LISTED = 10
"""Kinds of problems that are printed for people."""


@click.command("inspect")
@click.argument("sources", metavar="SOURCE…", nargs=-1, required=True)
@image_options
@click.option("--json", "as_json", is_flag=True, help="Print one line of JSON for each source.")
def command(sources: tuple[str, ...], as_json: bool, **images: Any) -> int:
    """Show what clouds and recordings hold: topics, rates, frames, and the first cloud of each topic with clouds."""
    from flatgrasp_cli.sources.selection import Selection
    from flatgrasp_cli.sources.summary import summarize

    selection = Selection(**of_images(**images))
    reading = Sources(len(sources))
    for source in sources:
        with reading.each():
            summary = summarize(source, selection)
            if as_json:
                click.echo(json.dumps(_document(summary), allow_nan=False))
            else:
                _print(summary)
    return reading.code


def _document(summary: Summary) -> dict[str, Any]:
    from flatgrasp_cli.results.contracts import schema_id

    # not made as its contract's type, which takes as long to load as the rest of this command
    return {"schema": schema_id("inspect"), **asdict(summary), "duration_s": summary.duration_s}


def _print(summary: Summary) -> None:
    parts: list[RenderableType] = [
        f"[bold]{_plain(summary.path)}[/bold] · {_plain(summary.container)}{_time(summary)}",
        *([_topics(summary.topics)] if summary.topics else []),
        *([f"frames: {_plain(', '.join(summary.frames))}"] if summary.frames else []),
    ]
    for cloud in summary.clouds:
        parts += _cloud(cloud)
    for problem, count in list(summary.problems.items())[:LISTED]:
        parts.append(f"problem: {_plain(problem)}{f' ({count} times)' if count > 1 else ''}")
    if len(summary.problems) > LISTED:
        parts.append(f"and {len(summary.problems) - LISTED} more kinds of problems; --json lists them")
    show(*parts)


def _time(summary: Summary) -> str:
    if summary.start_ns is None or summary.duration_s is None:
        return "" if summary.clouds else " · no messages"
    start = datetime.fromtimestamp(summary.start_ns / 1e9, UTC)
    return f" · {summary.duration_s:.3f} s from {start:%Y-%m-%dT%H:%M:%S.%f}Z"


def _topics(topics: tuple[TopicSummary, ...]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    for heading in ("topic", "type", "encoding"):
        table.add_column(heading, overflow="fold")
    for heading in ("count", "Hz"):
        table.add_column(heading, justify="right", no_wrap=True)
    for topic in topics:
        count = "?" if topic.count is None else str(topic.count)
        rate = "" if topic.rate_hz is None else f"{topic.rate_hz:.1f}"
        table.add_row(_plain(topic.name), _plain(topic.type), _plain(topic.encoding), count, rate)
    return table


def _cloud(cloud: CloudSummary) -> list[str]:
    from flatgrasp_cli.model import UNNAMED_FRAME

    where = f"first cloud on {cloud.topic}" if cloud.topic else "cloud"
    frame = "" if cloud.frame_id == UNNAMED_FRAME else f" in {cloud.frame_id}"
    size = " × ".join(str(side) for side in cloud.shape[::-1] if side != 1) or "1"
    lines = [_plain(where + frame), f"  points: {size}, {100 * cloud.nan_share:.1f} % not measured"]
    if cloud.fields:
        lines.append(f"  fields: {_plain(' '.join(cloud.fields))}")
    if cloud.low_m is not None and cloud.high_m is not None:
        sides = zip("xyz", cloud.low_m, cloud.high_m, strict=True)
        lines.append("  extent: " + ", ".join(f"{axis} {low:.3f} … {high:.3f} m" for axis, low, high in sides))
    lines.append(f"  sensor: {_where(cloud.sensor)}")
    return lines + [f"  warning: {_plain(warning)}" for warning in cloud.warnings]


def _where(sensor: dict[str, Any]) -> str:
    """Where the sensor was, and how that is known."""
    known = KNOWN_FROM[sensor["known_from"]]
    if sensor["position"] is not None:
        return f"at {' '.join(f'{value:z.3f}' for value in sensor['position'])} m, {known}"
    if sensor["direction"] is not None:
        return f"toward {' '.join(f'{value:z.2f}' for value in sensor['direction'])}, {known}"
    return known


def _plain(text: str) -> str:
    from rich.markup import escape

    from flatgrasp_cli.recordings.containers import printable

    return escape(printable(text))
