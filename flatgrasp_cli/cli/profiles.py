"""`flatgrasp profiles list|show|check`."""

from __future__ import annotations

from pathlib import Path

import click

from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.source_names import in_utf8

KINDS = ("gripper", "robot", "planner")


@click.group("profiles")
def command() -> None:
    """List, show and check gripper, robot and planner profiles."""


@command.command("list")
@click.argument("kind", type=click.Choice(KINDS), required=False)
def list_command(kind: str | None) -> None:
    """List the shipped profiles, one a line: its kind and its name."""
    from flatgrasp_cli.profiles import list_profiles

    for each in (kind,) if kind else KINDS:
        for name in list_profiles(each):
            click.echo(f"{each}\t{name}")


@command.command("show")
@click.argument("name", metavar="NAME|FILE")
def show_command(name: str) -> None:
    """Print a profile's YAML, comments and sources included: a start for your own."""
    from flatgrasp_cli.profiles import list_profiles, load_profile, profile_path

    if "/" in name or name.endswith((".yaml", ".yml")):
        path = Path(name)
    else:
        kinds = [kind for kind in KINDS if name in list_profiles(kind)]
        if not kinds:
            known = ", ".join(sorted(each for kind in KINDS for each in list_profiles(kind)))
            raise ProfileError(f"no profile named {name!r}\nknown: {known}; or give the path of your own .yaml file")
        path = profile_path(kinds[0], name)
    load_profile(path)
    click.echo(path.read_text(encoding="utf-8"), nl=False)


@command.command("check")
@click.argument("files", metavar="FILE…", nargs=-1, required=True, type=click.Path(path_type=Path))
def check_command(files: tuple[Path, ...]) -> int:
    """Check profiles of your own; lists every fault, exit code 2 when there is one."""
    from flatgrasp_cli.profiles.loading import problems_in

    code = 0
    for path in files:
        try:
            problems = [f"{path}: {problem}" for problem in problems_in(path)]
        except ProfileError as error:
            problems = [str(error)]
        click.echo("\n".join(problems) or f"{in_utf8(str(path))}: ok", err=bool(problems))
        code = ProfileError.exit_code if problems else code
    return code


@command.command("from-urdf")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
def from_urdf_command(file: Path) -> None:
    """Print a gripper profile made of a URDF: a start for your own.

    Opening, finger width and thickness, length, and how far the tips come out as they close are measured on the URDF's
    shapes. What a URDF cannot say is commented; a value that is missing is null, and `profiles check` asks for it.
    """
    from flatgrasp_cli.profiles.urdf import read_urdf
    from flatgrasp_cli.results.gripper_yaml import gripper_yaml
    from flatgrasp_cli.sources.gripper_urdf import measured

    hand = measured(read_urdf(file))
    click.echo(gripper_yaml(hand, in_utf8(file.name)), nl=False)
    if hand.palm is None:
        click.echo(
            f"flatgrasp: warning: {file}: nothing of it stands still, so how large the palm is, how far it is from the "
            "flange, and how long fingers are is not known: put them in for null",
            err=True,
        )
