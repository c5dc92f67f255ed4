"""`flatgrasp schema`."""

from __future__ import annotations

import json

import click


@click.command("schema")
def command() -> None:
    """Print the JSON Schema of the documents that `flatgrasp plan` writes."""
    from flatgrasp_cli.results.contracts import json_schema

    click.echo(json.dumps(json_schema(), indent=2))
