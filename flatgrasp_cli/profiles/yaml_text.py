"""YAML as profiles need it: every key once, nothing nested without end, lists as tuples."""

from __future__ import annotations

import re
from typing import Any

import yaml

MAX_DEPTH = 20
_Base: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml is ten times as fast


class NotYamlError(ValueError):
    """Text that is no YAML, or none that a profile needs; `place` is ":line:column" or empty."""

    def __init__(self, text: str, mark: Any = None) -> None:
        super().__init__(text)
        self.place = f":{mark.line + 1}:{mark.column + 1}" if mark else ""


def parsed(text: str) -> Any:
    """What a text of YAML says.

    Raises
    ------
    NotYamlError
        If it is no YAML, gives a key twice, refers to itself, or is nested too deeply.
    """
    try:
        _check_structure(text)
        return yaml.load(text, Loader=_Loader)  # noqa: S506 (a SafeLoader)
    except yaml.YAMLError as error:
        raise NotYamlError(str(getattr(error, "problem", error)), getattr(error, "problem_mark", None)) from error
    except NotYamlError:
        raise
    except ValueError as error:  # a number of thousands of digits, a day that no month has
        raise NotYamlError(str(error)) from error


def _check_structure(text: str) -> None:
    """Refuse what would take the loader's stack or memory: deep nesting, and aliases, which multiply what they name."""
    depth = 0
    for event in yaml.parse(text, Loader=_Base):
        if isinstance(event, yaml.AliasEvent):
            raise NotYamlError("aliases are not allowed", event.start_mark)
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > MAX_DEPTH:
            raise NotYamlError(f"nested more than {MAX_DEPTH} levels deep", event.start_mark)


class _Loader(_Base):  # type: ignore[misc]
    """Safe YAML in which a key given twice is an error: plain YAML keeps the last one without a word."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                continue  # a list as a key: the base class says so
            if key_node.value in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key_node.value!r} is given twice", key_node.start_mark
                )
            seen.add(key_node.value)
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping


def _tuple(loader: Any, node: yaml.SequenceNode) -> tuple[Any, ...]:
    return tuple(loader.construct_sequence(node, deep=True))


_Loader.add_constructor("tag:yaml.org,2002:seq", _tuple)
# YAML 1.1 takes 1e-3 for a word, YAML 1.2 and everybody else for a number
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"[-+]?\d+[eE][-+]?\d+$"), list("-+0123456789"))
