"""The options that choose frames of a recording, the same for every command that reads one."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.sources.selection import Selection

OPTIONS = (
    click.option("--topic", metavar="NAME", help="Topic of a recording; the only one with clouds if not given."),
    click.option("--start", metavar="TIME", help="From this time on: seconds from the start, or ISO 8601."),
    click.option("--end", metavar="TIME", help="Before this time."),
    click.option("--at", metavar="TIME", help="Only the first frame at or after this time."),
    click.option("--every", metavar="N|SECONDSs", help="Every N-th frame (5), or one frame a period (0.5s)."),
    click.option("--count", type=click.IntRange(min=1), metavar="N", help="At most so many frames of each recording."),
    click.option("--strict", is_flag=True, help="The first damage in a recording is an error, not a warning."),
)
NAMES = ("topic", "start", "end", "at", "every", "count", "strict")


def frame_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options, and the `Selection` that they say as its argument `selection`."""

    @wraps(command)
    def with_selection(**options: Any) -> Any:
        chosen = {name: options.pop(name) for name in NAMES}
        return command(selection=_selection(**chosen), **options)

    for option in reversed(OPTIONS):
        with_selection = option(with_selection)
    return with_selection


def _selection(
    topic: str | None,
    start: str | None,
    end: str | None,
    at: str | None,
    every: str | None,
    count: int | None,
    strict: bool,
) -> Selection:
    from flatgrasp_cli.sources.selection import Every, Selection, parse_every, parse_moment

    if at is not None and (start, end, every, count) != (None, None, None, None):
        raise UsageError("--at names one frame; leave out --start, --end, --every and --count")
    return Selection(
        topic=topic,
        start=None if start is None else parse_moment(start),
        end=None if end is None else parse_moment(end),
        at=None if at is None else parse_moment(at),
        every=Every() if every is None else parse_every(every),
        count=count,
        strict=strict,
    )
