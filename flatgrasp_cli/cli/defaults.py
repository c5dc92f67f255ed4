"""Defaults of the planning commands: the command line beats FLATGRASP_* variables, and these beat a file.

The file is YAML, the one of `--config`, else flatgrasp.yaml in $XDG_CONFIG_HOME or ~/.config. Its keys are the names of
the options that the planning commands share, underscores for hyphens; planner settings are under `set` as in a planner
profile, and what only one command has under that command's name. The variables are FLATGRASP_GRIPPER and the like;
FLATGRASP_PLAN_PLOTS for what only one command has.
"""

from __future__ import annotations

import difflib
import importlib
import json
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from flatgrasp_cli.errors import ProfileError

PREFIX = "FLATGRASP"
RECORDED = ("batch", "cage", "compare", "plan", "serve", "view")
"""The commands that plan what was recorded, which have most of their options in common."""
COMMANDS = (*RECORDED, "simulate")
SETTINGS = "set"
NO_DEFAULT = {"config", "help"}
OF_FILES = ("camera_pose", "gripper", "intrinsics", "method", "robot")
"""Options whose value may be a file's name; in the file of defaults it is relative to that."""
SUFFIXES = (".yaml", ".yml", ".json")
STORED = f"{__name__}.stored"
FILE, ENVIRONMENT, COMMAND_LINE = range(3)
RANKS = {ParameterSource.DEFAULT_MAP: FILE, ParameterSource.ENVIRONMENT: ENVIRONMENT}


@dataclass(frozen=True, slots=True)
class Stored:
    """The file of defaults, if there is one, and the planner settings in it as KEY=VALUE."""

    path: Path | None = None
    settings: tuple[str, ...] = ()


def context_of(command: str) -> dict[str, Any]:
    """The settings of a planning command's context: what its own options' variables begin with."""
    return {"auto_envvar_prefix": f"{PREFIX}_{command.upper()}"}


def option(*names: str, **more: Any) -> Callable[[Any], Any]:
    """Make an option that several commands share, which one variable sets for all of them."""
    variable = f"{PREFIX}_{max(names, key=len).lstrip('-').replace('-', '_').upper()}"
    return click.option(*names, allow_from_autoenv=False, **{"envvar": variable} | more)


def config_option(command: Any) -> Any:
    """Give a command the option --config, which is looked at before all others."""
    return option(
        "--config",
        metavar="FILE",
        is_eager=True,
        expose_value=False,
        callback=_use,
        help="YAML with defaults of these options, e.g. gripper: pr2; ~/.config/flatgrasp.yaml if not given.",
    )(command)


def _use(context: click.Context, _parameter: click.Parameter, given: str | None) -> None:
    """Read the file of defaults and let click look there for what nobody says."""
    _warn_of_variables()
    path = _users_file() if given is None else Path(given)
    if path is None:
        return
    from flatgrasp_cli.profiles.loading import read_yaml

    values = read_yaml(path, "file of defaults")
    _check_keys(path, values)
    settings = _checked_settings(path, values.pop(SETTINGS, None))
    own = values.get(str(context.command.name)) or {}
    options = {option_key(each): each for each in context.command.params}
    context.default_map = {
        str(options[key].name): _checked(context, path, key, options[key], value)
        for key, value in (values | own).items()
        if key in options and value is not None
    }
    context.meta[STORED] = Stored(path, settings)


def stored(context: click.Context) -> Stored:
    """What the file of defaults says of settings."""
    found: Stored = context.meta.get(STORED, Stored())
    return found


def _warn_of_variables() -> None:
    """Say on stderr which variables look like ours and set no option of any planning command."""
    ours = [name for name in os.environ if name.upper().startswith(f"{PREFIX}_")]
    if not ours:
        return
    known = {variable for name in COMMANDS for variable in _variables(name)} | {f"{PREFIX}_{SETTINGS.upper()}"}
    endings = [name.removeprefix(PREFIX) for name in sorted(known)]
    for name in sorted(set(ours) - known):
        near = difflib.get_close_matches(name.upper().removeprefix(PREFIX), endings, n=1)
        words = f"did you mean {PREFIX}{near[0]}?" if near else f"they are named like {PREFIX}_GRIPPER"
        click.echo(f"flatgrasp: warning: {name}: no option has this variable, it changes nothing; {words}", err=True)


def _variables(command: str) -> Iterator[str]:
    """The environment variables of a planning command's options."""
    for each in importlib.import_module(f"flatgrasp_cli.cli.{command}").command.params:
        if isinstance(each, click.Option):
            own = [f"{context_of(command)['auto_envvar_prefix']}_{str(each.name).upper()}"] * each.allow_from_autoenv
            yield from [each.envvar] if isinstance(each.envvar, str) else each.envvar or own


def _users_file() -> Path | None:
    """The user's own file of defaults; None if there is none."""
    home = os.environ.get("XDG_CONFIG_HOME", "")
    folder = Path(home) if Path(home).is_absolute() else Path("~/.config").expanduser()
    path = folder / "flatgrasp.yaml"
    return path if path.is_file() else None


def option_key(parameter: click.Parameter) -> str:
    """The long name of an option, as a key."""
    return max(parameter.opts, key=len).lstrip("-").replace("-", "_")


def _check_keys(path: Path, values: Mapping[Any, Any]) -> None:
    """Refuse a key that no planning command knows, or not in that place."""
    of = {name: _options(importlib.import_module(f"flatgrasp_cli.cli.{name}").command) for name in COMMANDS}
    shared = set.intersection(*(of[name] for name in RECORDED))
    for key, below in values.items():
        if key in COMMANDS and isinstance(below, dict):
            _check(path, f"{key}: ", below, of[key] - {SETTINGS})
        elif key in COMMANDS and below is not None:
            raise ProfileError(f"{path}: {key}: wants options of that command, e.g. {key}: {{top: 5}}")
    having = {key: [name for name in COMMANDS if key in of[name]] for key in set.union(*of.values()) - shared}
    for key in values:
        if key in having:
            raise ProfileError(f"{path}: {key}: not all commands have it; put it below {' or '.join(having[key])}:")
    _check(path, "", values, shared | set(COMMANDS))


def _options(command: click.Command) -> set[str]:
    """The keys of a command's options that may have a default."""
    return {option_key(each) for each in command.params if isinstance(each, click.Option)} - NO_DEFAULT


def _check(path: Path, place: str, values: Mapping[Any, Any], known: set[str]) -> None:
    from flatgrasp_cli.profiles.faults import suggestion

    for key in values:
        if key not in known:
            near = suggestion(str(key).replace("-", "_"), sorted(known))
            raise ProfileError(f"{path}: {place}{key}: unknown key{near} (allowed: {', '.join(sorted(known))})")


def _checked(context: click.Context, path: Path, key: str, parameter: click.Parameter, value: Any) -> Any:
    """A value as the command line would give it; lists are the numbers that it wants with commas between."""
    if isinstance(value, tuple):
        value = ",".join(map(str, value))
    if isinstance(value, dict):
        raise ProfileError(f"{path}: {key}: is a single value, not a list of keys")
    if key in OF_FILES and ("/" in str(value) or str(value).endswith(SUFFIXES)):
        value = str(path.parent / Path(value).expanduser())
    try:
        parameter.process_value(context, value)
    except click.BadParameter as error:
        raise ProfileError(f"{path}: {key}: {error.message}") from error
    return value


def _checked_settings(path: Path, values: Any) -> tuple[str, ...]:
    """The planner settings of a file of defaults as KEY=VALUE."""
    from flatgrasp_cli.profiles import load_settings

    if values is None:
        return ()
    if not isinstance(values, dict):
        raise ProfileError(f"{path}: {SETTINGS}: wants keys as in a planner profile, e.g. fingers: {{step_m: 0.004}}")
    settings = tuple(as_settings(values))
    try:
        load_settings(overrides=settings)
    except ProfileError as error:
        raise ProfileError(f"{path}: {SETTINGS}: {error}") from error
    return settings


def as_settings(values: Mapping[Any, Any], section: str = "") -> Iterator[str]:
    """Planner settings, nested as in a profile, as KEY=VALUE."""
    for key, value in values.items():
        if isinstance(value, dict):
            yield from as_settings(value, f"{section}{key}.")
        else:
            yield f"{section}{key}={json.dumps(value, default=str)}"


@dataclass(frozen=True, slots=True)
class Override:
    """A planner setting KEY=VALUE, and where it was said, as a rank: later ones win."""

    text: str
    rank: int


def overrides(context: click.Context, shortcuts: Mapping[str, str], given: tuple[str, ...]) -> list[Override]:
    """All planner settings that somebody said, those that win last.

    `shortcuts` are those of options of their own, by the option's parameter; `given` those of --set.
    """
    found = [Override(text, FILE) for text in stored(context).settings]
    found += [Override(text, ENVIRONMENT) for text in os.environ.get(f"{PREFIX}_SET", "").split()]
    for name, text in shortcuts.items():
        source = context.get_parameter_source(name)
        found.append(Override(text, RANKS.get(source, COMMAND_LINE) if source else COMMAND_LINE))
    found += [Override(text, COMMAND_LINE) for text in given]
    return sorted(found, key=lambda each: each.rank)


def tell(context: click.Context, settings: list[Override]) -> None:
    """Say on stderr what every option is, and where that comes from."""
    of_rank = {FILE: str(stored(context).path), ENVIRONMENT: "environment", COMMAND_LINE: "command line"}
    for each in context.command.params:
        source, value = context.get_parameter_source(str(each.name)), context.params.get(str(each.name))
        if value in (None, (), False) or source is None or not isinstance(each, click.Option):
            continue
        where = "default" if source is ParameterSource.DEFAULT else of_rank[RANKS.get(source, COMMAND_LINE)]
        if option_key(each) not in (SETTINGS, "verbose"):
            click.echo(f"flatgrasp: {option_key(each)}: {value} ({where})", err=True)
    for setting in settings:
        click.echo(f"flatgrasp: set {setting.text} ({of_rank[setting.rank]})", err=True)
