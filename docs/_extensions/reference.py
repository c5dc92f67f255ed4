"""The parts of the pages that are made from the program, so that they cannot say anything else than it does.

A page has `<!-- from the program: NAME -->` where one of `PARTS` goes.
"""

from __future__ import annotations

import dataclasses
import importlib
import json
import re
import typing
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import click
from pydantic import BaseModel

import flatgrasp_cli
from flatgrasp_cli import model
from flatgrasp_cli.cli import cli
from flatgrasp_cli.model import Trace
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot, load_settings
from flatgrasp_cli.results.contracts.descriptions import DescribedSchema

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
MARK = re.compile(r"^<!-- from the program: (\w+) -->$", re.MULTILINE)
HELP_COLUMNS = 80
NO_REASON = (" | ", "[")
"""What comments have that show the values to choose from, or their form, which is described elsewhere on the page."""


def filled_in(page: str) -> str:
    """A page with every mark replaced by the part that it names."""
    return MARK.sub(lambda mark: PARTS[mark[1]](), page)


def commands() -> str:
    """What every command says of itself with --help."""
    return "\n\n".join(_help(cli, "flatgrasp"))


def _help(command: click.Command, words: str) -> Iterator[str]:
    settings = {**command.context_settings, "max_content_width": HELP_COLUMNS, "terminal_width": HELP_COLUMNS}
    context = click.Context(command, info_name=words, **settings)
    yield f"## {words}\n\n```text\n{command.get_help(context)}\n```"
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            assert inner is not None  # noqa: S101 (it has just been listed)
            yield from _help(inner, f"{words} {name}")


def settings() -> str:
    """Every planner setting: its default, what the paper has, what it means, and why it is what it is."""
    return "\n\n".join(_sections())


def _sections() -> Iterator[str]:
    default, paper = (load_settings(name).model_dump(mode="json") for name in ("default", "paper"))
    reasons = _comments(CONFIGS / "planner" / "default.yaml")
    schema = _schema(PlannerSettings)
    alone = {key: value for key, value in schema["properties"].items() if "$ref" not in value}
    yield "\n\n".join(
        ["## The profile itself", *(_entry(key, value, default[key], paper[key], "") for key, value in alone.items())]
    )
    for section, reference in schema["properties"].items():
        if section in alone:
            continue
        properties = schema["$defs"][reference["$ref"].rpartition("/")[2]]["properties"]
        entries = (
            _entry(
                f"{section}.{key}", value, default[section][key], paper[section][key], reasons.get((section, key), "")
            )
            for key, value in properties.items()
        )
        yield "\n\n".join([f"## {section}", _sentence(reference["description"]), *entries])


def _entry(key: str, described: dict[str, Any], default: Any, paper: Any, reason: str) -> str:
    """One setting as an item of a definition list."""
    differs = f", `{_yaml(paper)}` with `--method paper`" if paper != default else ""
    choices = " One of " + ", ".join(f"`{choice}`" for choice in described["enum"]) + "." if "enum" in described else ""
    because = f"\n\n  *{reason}*" if reason and not any(sign in reason for sign in NO_REASON) else ""
    return f"`{key}`: `{_yaml(default)}`{differs}\n: {_sentence(described['description'])}{choices}{because}"


def _comments(path: Path) -> dict[tuple[str, str], str]:
    """The comments beside the settings of a profile, by section and key."""
    found, section = {}, ""
    for line in path.read_text(encoding="utf-8").splitlines():
        key, comment = re.match(r"\s*(\w*)", line)[1], line.partition("#")[2].strip()  # type: ignore[index]
        if key and not line.startswith(" "):
            section = key
        elif key and comment:
            found[section, key] = comment
    return found


def profiles() -> str:
    """Every key of gripper and robot profiles."""
    return "\n\n".join([*_keys("Grippers", Gripper), *_keys("Robots", Robot)])


def _keys(title: str, model: type[BaseModel]) -> Iterator[str]:
    schema = _schema(model)
    yield f"## {title}"
    for key, value in _flat(schema, schema["properties"], ""):
        default = f": `{_yaml(value['default'])}`" if "default" in value else ""
        yield f"`{key}`{default}\n: {_sentence(value['description'])}"


def _flat(schema: dict[str, Any], properties: dict[str, Any], before: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every property with the name that leads to it, those of its own properties after it."""
    for key, value in properties.items():
        yield f"{before}{key}", value
        options = [value, *value.get("anyOf", [])]
        names = [option["$ref"].rpartition("/")[2] for option in options if "$ref" in option]
        within = schema.get("$defs", {}).get(names[0], {}) if names else {}
        yield from _flat(schema, within.get("properties", {}), f"{before}{key}.")


def _schema(model: type[BaseModel]) -> dict[str, Any]:
    return model.model_json_schema(mode="serialization", schema_generator=DescribedSchema)


def _yaml(value: Any) -> str:
    """A value as it is written in YAML on one line."""
    return value if isinstance(value, str) else json.dumps(value)


def _sentence(text: str) -> str:
    """A description as Markdown: its line breaks have no meaning."""
    return " ".join(text.split()).replace("None:", "`null`:").replace("*", r"\*")


def api() -> str:
    """Every public name, and the records that a plan is made of."""
    public = {name: getattr(flatgrasp_cli, name) for name in flatgrasp_cli.__all__}
    classes = [name for name, thing in public.items() if isinstance(thing, type)]
    functions = [name for name in public if name not in classes]
    walked = [record.__name__ for record in _records(Plan, {Trace})]  # a trace is for study, and not of the interface
    records = [name for name in walked if name in model.__all__ and name not in public]
    return "\n\n".join(
        [
            "## Functions",
            *(_documented("autofunction", f"flatgrasp_cli.{name}") for name in functions),
            "## Classes",
            *(_documented("autoclass", f"flatgrasp_cli.{name}") for name in classes),
            "## Records within a plan",
            *(_documented("autoclass", f"flatgrasp_cli.model.{name}") for name in records),
        ]
    )


def _documented(directive: str, name: str) -> str:
    return f"```{{eval-rst}}\n.. {directive}:: {name}\n```"


def _records(record: type, known: set[type]) -> Iterator[type]:
    """The dataclasses that a record's fields hold, directly or through others, each once and none of those known."""
    hints = typing.get_type_hints(record, vars(importlib.import_module(record.__module__)))
    for part in (part for hint in hints.values() for part in _parts(hint)):
        if isinstance(part, type) and dataclasses.is_dataclass(part) and part not in known:
            known.add(part)
            yield part
            yield from _records(part, known)


def _parts(hint: Any) -> Iterator[Any]:
    """The types that an annotation is made of."""
    yield hint
    for inner in typing.get_args(hint):
        yield from _parts(inner)


PARTS: dict[str, Callable[[], str]] = {part.__name__: part for part in (commands, settings, profiles, api)}
