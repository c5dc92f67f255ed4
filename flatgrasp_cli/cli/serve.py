"""`flatgrasp serve`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.cli.defaults import context_of
from flatgrasp_cli.cli.imports import importing
from flatgrasp_cli.cli.planning_options import NAMES, planning_options
from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.serving import Answerer, Place


@click.command("serve", context_settings=context_of("serve"))
@planning_options
@click.option(
    "--listen",
    metavar="HOST:PORT",
    help="Answer on a socket instead of standard input, any number of clients; port 0 is any free one.",
)
@click.option("--remote", is_flag=True, help="Let HOST be one that other machines reach; there is no password.")
@click.pass_context
def command(context: click.Context, job: Job, listen: str | None, remote: bool) -> None:  # noqa: ARG001 (checked so)
    """Answer requests to plan: one line of JSON in, one line out, without starting up again.

    A request is {"id": 7, "source": "cloud.pcd", "options": {"gripper": "pr2"}}, with "data" instead of "source" for
    a file's content in base64. Options are those of `plan`; the ones given here are their defaults. The answer has the
    request's id and the same documents as `plan --json`; `flatgrasp schema request` and `flatgrasp schema answer`
    describe both. A wrong request gets an answer that says what is wrong, and nothing else stops.

    Ends with exit code 0 at the end of standard input.
    """
    from flatgrasp_cli.cli.requests import RequestOptions

    place = None if listen is None else _place(listen, remote)
    if place is None and remote:
        raise UsageError("--remote says who may connect; it needs --listen HOST:PORT")
    with importing():
        from flatgrasp_cli.serving import Answerer

    answerer = Answerer(RequestOptions(context, frozenset(NAMES)).job)
    if place is None:
        _answer_stdin(answerer)
    else:
        from flatgrasp_cli.serving import listen as answer_clients

        answer_clients(place, answerer, lambda text: click.echo(f"flatgrasp: {text}", err=True))


def _place(listen: str, remote: bool) -> Place:
    from flatgrasp_cli.serving import parse_place

    place = parse_place(listen)
    if not (place.loopback or remote):
        raise UsageError(
            f"--listen {listen}: other machines reach that, and could have any file of yours planned on, without a "
            "password; use 127.0.0.1, or say --remote"
        )
    return place


def _answer_stdin(answerer: Answerer) -> None:
    from flatgrasp_cli.serving import requests_in

    if sys.stdin is None:
        raise UsageError("requests come on standard input, which is closed; use --listen HOST:PORT")
    for line in requests_in(sys.stdin.buffer):
        click.echo(answerer.answer(line))
