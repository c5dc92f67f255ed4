"""Options of a request, which beat those that `serve` was started with."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from copy import copy
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from flatgrasp_cli.cli.defaults import SETTINGS, as_settings, option_key, overrides
from flatgrasp_cli.cli.jobs import SHORTCUTS, make_job, shortcuts
from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job

KEPT = 32
"""Sets of options whose jobs are kept: clients ask with the same ones again and again."""
OF_THE_PROCESS = {"config", "verbose"}
"""Options that no request has: where defaults come from, and what is said on stderr."""


class RequestOptions:
    """Makes jobs of requests' options over those of a command's `context`; each is made once and kept."""

    def __init__(self, context: click.Context, planning: frozenset[str]) -> None:
        values = {name: value for name, value in context.params.items() if name in planning}
        given = overrides(context, shortcuts(values), values["given"])
        self._settings = tuple(each.text for each in given)
        self._values = {name: value for name, value in values.items() if name not in SHORTCUTS}
        self._options = {option_key(each): _bare(each) for each in _own(context, planning)}
        self._command = click.Command("request", params=[*self._options.values()], add_help_option=False)
        self._kept = lru_cache(KEPT)(self._made)

    def job(self, options: Mapping[str, Any]) -> Job:
        """The job of a request's options.

        Raises
        ------
        UsageError
            If there is no such option, or a value is not of its kind.
        ProfileError
            If a profile or a setting is wrong.
        """
        return self._kept(json.dumps(options, sort_keys=True))

    def _made(self, options: str) -> Job:
        values = self._parsed(json.loads(options))
        settings = (*self._settings, *shortcuts(values).values(), *values.get("given", ()))
        return make_job(self._values | values, settings, values)

    def _parsed(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """The values that options say, by their parameters."""
        saying = {key: value for key, value in options.items() if value is not None and value is not False}
        arguments = [text for key, value in saying.items() for text in _arguments(self._option(key), value)]
        try:
            context = self._command.make_context("request", arguments)
        except click.UsageError as error:
            raise UsageError(f"options: {error.format_message()}") from error
        said = (name for name in context.params if context.get_parameter_source(name) is ParameterSource.COMMANDLINE)
        return {name: context.params[name] for name in said}

    def _option(self, key: str) -> click.Option:
        """The option of a key, which may have hyphens; nothing else becomes a word of a command line."""
        from flatgrasp_cli.profiles.faults import suggestion

        name = key.replace("-", "_")
        if name not in self._options:
            word = f"--{key.replace('_', '-')}"
            raise UsageError(f"options: {word}: no such option{suggestion(name, list(self._options))}")
        return self._options[name]


def _own(context: click.Context, planning: frozenset[str]) -> Iterator[click.Option]:
    """The options of a command that requests have, too."""
    for each in context.command.params:
        if isinstance(each, click.Option) and each.name in planning and option_key(each) not in OF_THE_PROCESS:
            yield each


def _bare(option: click.Option) -> click.Option:
    """An option that takes its value from nowhere but the arguments."""
    bare = copy(option)
    bare.envvar = None
    return bare


def _arguments(option: click.Option, value: Any) -> Iterator[str]:
    """An option as it stands on a command line; `true` is a flag's."""
    key = option_key(option)
    word = f"--{key.replace('_', '-')}"
    if value is True and not option.is_flag:
        raise UsageError(f"options: {word}: wants a value")  # the next option would be taken for it
    if value is True:
        yield word
    elif key == SETTINGS:
        yield from (f"{word}={text}" for text in _settings(value))
    elif isinstance(value, dict):
        raise UsageError(f"options: {key}: is a single value, no object")
    else:
        yield f"{word}={','.join(map(str, value)) if isinstance(value, list) else value}"


def _settings(value: Any) -> tuple[str, ...]:
    """Planner settings as KEY=VALUE, from an object as in a profile, or from a list of them."""
    if isinstance(value, dict):
        return tuple(as_settings(value))
    return tuple(map(str, value if isinstance(value, list) else [value]))
