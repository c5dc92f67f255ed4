"""Tables and text for people: as wide as the terminal; in a pipe 80 columns, or as many as COLUMNS says."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

COLUMNS, LINES = 80, 24
NARROWEST = 12
"""Characters of a column that may be broken anywhere: a name's pieces are readable down to about that."""


def show(*parts: RenderableType) -> None:
    """Print text and tables to stdout: text is wrapped between words, columns of numbers (`no_wrap`) never."""
    from rich.console import Console
    from rich.table import Table

    width = shutil.get_terminal_size((COLUMNS, LINES)).columns
    console = Console(width=width, highlight=False)
    with console.capture() as text:  # rich would end the process with 1 when the reader of a pipe leaves
        for part in parts:
            console.width = max(width, _keep_numbers_whole(part)) if isinstance(part, Table) else width
            console.print(part)
    lines = text.get().splitlines()
    click.echo("\n".join(line.rstrip() for line in lines))


def _keep_numbers_whole(table: Table) -> int:
    """Give the columns of numbers the width of their longest; returns the width that the table needs at least.

    Columns that `fold` need no more than `NARROWEST`, however long a word in them is.
    """
    from rich.cells import cell_len
    from rich.console import Console
    from rich.measure import Measurement

    for column in table.columns:
        if column.no_wrap:
            lines = [line for cell in (column.header, *column.cells) for line in str(cell).splitlines()]
            column.min_width = max(map(cell_len, lines), default=0)
    wide = Console(width=10_000)
    folding = [column for column in table.columns if column.overflow == "fold" and not column.no_wrap]
    longest = [column.max_width for column in folding]
    for column in folding:
        column.max_width = min(column.max_width or NARROWEST, NARROWEST)
    needed = Measurement.get(wide, wide.options, table).minimum
    for column, before in zip(folding, longest, strict=True):
        column.max_width = before
    return needed
