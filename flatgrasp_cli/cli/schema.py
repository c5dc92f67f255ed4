"""`flatgrasp schema [NAME]`."""

from __future__ import annotations

import json

import click

from flatgrasp_cli.results.contracts import KINDS

HELP = """Print the JSON Schema of a kind of document that flatgrasp writes; of plan's if none is named.

\b
"""


@click.command("schema", help=HELP + "\n".join(f"{name:<15} {kind.about}" for name, kind in KINDS.items()))
@click.argument("name", metavar="[NAME]", type=click.Choice(tuple(KINDS)), default="plan")
def command(name: str) -> None:
    """Print the JSON Schema of a kind of document."""
    from flatgrasp_cli.results.contracts import json_schema

    click.echo(json.dumps(json_schema(name), indent=2))
