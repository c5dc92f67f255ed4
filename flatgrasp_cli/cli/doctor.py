"""`flatgrasp doctor`."""

from __future__ import annotations

import platform
import textwrap
from typing import TYPE_CHECKING

import click

from flatgrasp_cli import __version__
from flatgrasp_cli.cli.console import COLUMNS
from flatgrasp_cli.kernels import STATE

if TYPE_CHECKING:
    from flatgrasp_cli.installation import Package

UNSOUND = 1


@click.command("doctor")
def command() -> int:
    """Check the installation: versions, extras, and a grasp on a shape that is built in.

    Exit code 0: all is well; 1: a package is missing or too old, or the self-test failed. What is wrong is on stderr,
    too. An extra that is not installed is no fault.
    """
    click.echo(f"flatgrasp {__version__}, Python {platform.python_version()}, {platform.system()} {platform.machine()}")
    click.echo(f"kernels: {STATE}")
    faults = []
    for part in (_packages, _self_test):
        try:
            faults += part()
        except ImportError as error:
            faults.append(f"{error}; pip install --force-reinstall flatgrasp")
    for fault in faults:
        click.echo(f"flatgrasp: {fault}", err=True)
    return UNSOUND if faults else 0


def _packages() -> list[str]:
    """Print what is installed, of the project's own and by extra; returns what is wrong with it."""
    from flatgrasp_cli.installation import packages

    found = packages()
    if not found:
        click.echo("packages: not known: this is a source tree that was never installed")
        return []
    _say("packages: " + _listed([each for each in found if each.extra is None]), indent=2)
    click.echo("extras:")
    for extra in sorted({each.extra for each in found if each.extra}):
        its = [each for each in found if each.extra == extra]
        lacking = any(each.installed is None for each in its)
        _say(f"{extra}: {_listed(its)}" + f"; pip install 'flatgrasp[{extra}]'" * lacking, indent=4)
    return [_fault(each) for each in found if not each.sound and (each.extra is None or each.installed)]


def _self_test() -> list[str]:
    """Print what the self-test finds; returns what is wrong."""
    from flatgrasp_cli.self_test import self_test

    click.echo("self-test:")
    faults = []
    for check in self_test():
        _say(f"{'ok' if check.sound else 'failed':8}{check.trial}: {check.found}", indent=8)
        if not check.sound:
            faults.append(f"self-test: {check.trial}: {check.found}")
    return faults


def _listed(found: list[Package]) -> str:
    return ", ".join(f"{each.name} {each.installed or 'missing'}" for each in found)


def _fault(package: Package) -> str:
    wanted = f"{package.name}{package.wanted}"
    state = f"{package.installed} is installed" if package.installed else "it is missing"
    return f"{package.name}: {wanted} is wanted, {state}; pip install '{wanted}'"


def _say(text: str, indent: int) -> None:
    lines = textwrap.wrap(text, COLUMNS - 2, subsequent_indent=" " * indent, break_on_hyphens=False)
    click.echo("\n".join(f"  {line}" for line in lines))
