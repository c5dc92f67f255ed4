"""The command line: one file a command, no logic of its own. Only this package prints.

Exit codes: 0 a grasp in every frame, 1 some frame has none, 2 wrong usage or profile, 3 an input cannot be read,
130 interrupted; 0 when the reader of a pipe leaves.
"""

from __future__ import annotations

import importlib
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import click

from flatgrasp_cli.errors import FlatgraspError, UsageError
from flatgrasp_cli.interrupts import INTERRUPTED
from flatgrasp_cli.threads import one_thread_each

COMMANDS = {
    "batch": "Plan grasps on many recordings, on all cores or a cluster.",
    "cage": "Show all grasps that cage an outline or a cloud's objects.",
    "compare": "Compare our grasps with those of two point fingers (Allen et al. 2012).",
    "doctor": "Check the installation: versions, extras, a self-test.",
    "export": "Write grasps in the formats of Isaac, GraspNet and MoveIt, or as a table.",
    "inspect": "Show what clouds and recordings hold.",
    "plan": "Plan grasps on point clouds.",
    "profiles": "List, show and check gripper, robot and planner profiles.",
    "schema": "Print the JSON Schema of each kind of document that flatgrasp writes.",
    "serve": "Answer requests to plan, a line each, on standard input or a socket.",
    "simulate": "Try a gripper on objects in a simulation, as the paper does.",
    "view": "Look at grasps in three dimensions, in a browser.",
}
STDOUT = 1


class _ReaderLeftError(Exception):
    """The reader of a pipe has seen enough. Nothing is wrong, but click would end with 1."""


@contextmanager
def _leaving_reader() -> Iterator[None]:
    try:
        yield
    except BrokenPipeError as error:
        raise _ReaderLeftError from error


class _LazyGroup(click.Group):
    """Imports a command's module only when it is run, so that --help answers at once."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 (click's signature)
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(f"flatgrasp_cli.cli.{cmd_name}").command
        return command

    def make_context(self, *args: Any, **kwargs: Any) -> click.Context:
        with _leaving_reader():
            return super().make_context(*args, **kwargs)

    def invoke(self, ctx: click.Context) -> Any:
        with _leaving_reader():
            return super().invoke(ctx)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _say_version(context: click.Context, _parameter: click.Parameter, asked: bool) -> None:
    if asked and not context.resilient_parsing:
        from flatgrasp_cli import __version__
        from flatgrasp_cli.kernels import STATE

        click.echo(f"flatgrasp {__version__} ({STATE})")
        context.exit()


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_say_version, help="Print the version."
)
def cli() -> None:
    """Find where a two-finger gripper should close on a flat unknown object, and why there.

    Plans grasps on recorded point clouds by the method of Lei & Wisse 2016.
    """


def _abandon_stdout() -> None:
    """Keep Python from flushing into a broken stdout at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), STDOUT)


def run() -> int:
    """Run the process's command line; errors become one or two lines on stderr and the exit code that is returned."""
    one_thread_each()
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # looking for some reads every package's metadata
    logging.basicConfig(format="flatgrasp: %(levelname)s: %(message)s", level=logging.WARNING, stream=sys.stderr)
    logging.addLevelName(logging.WARNING, "warning")
    try:
        code = cli.main(standalone_mode=False, prog_name="flatgrasp")
        if sys.stdout is not None:  # it is None when the shell closed it
            sys.stdout.flush()
    except FlatgraspError as error:
        click.echo(f"flatgrasp: {error}", err=True)
        code = error.exit_code
    except click.ClickException as error:
        error.show()
        code = error.exit_code
    except (click.Abort, KeyboardInterrupt):
        click.echo("flatgrasp: interrupted", err=True)
        code = INTERRUPTED
    except (_ReaderLeftError, BrokenPipeError):
        _abandon_stdout()
        code = 0
    except OSError as error:
        _abandon_stdout()
        click.echo(f"flatgrasp: the output cannot be written: {error.strerror or error}", err=True)
        code = UsageError.exit_code
    return code if isinstance(code, int) else 0
