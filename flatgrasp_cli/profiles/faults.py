"""What is wrong with a profile, in words."""

from __future__ import annotations

import difflib
import reprlib
import types
import typing
from collections.abc import Iterator
from itertools import groupby
from typing import Any

from pydantic import BaseModel, ValidationError


def explained(model: type[BaseModel], error: ValidationError) -> list[str]:
    """The faults in words, one for each key: the dotted key, its value, and what that would have to be."""
    found: dict[str, list[str]] = {}
    for problem in _with_lists_whole(error):
        # the place of a value that may be one thing or another goes on with the type that it is not: tuple[…]
        choice = next((k for k, part in enumerate(problem["loc"]) if "[" in str(part)), len(problem["loc"]))
        key, inside = (".".join(map(str, parts)) for parts in (problem["loc"][:choice], problem["loc"][choice + 1 :]))
        text = _explain(model, key, problem)
        if found.get(key) or not _shows_value(problem):
            found.setdefault(key, []).append(f"{inside}: {text}" if inside else text)
        else:
            found[key] = [f"{reprlib.repr(problem['input'])}: {text}"]
    return [": ".join(filter(None, (key, ", or ".join(texts)))) for key, texts in found.items()]


def _with_lists_whole(error: ValidationError) -> Iterator[Any]:
    """The faults as pydantic has them, but all values that a list lacks as one: how many it needs."""
    for place, each in groupby(error.errors(include_url=False), key=_short_list):
        problems: list[Any] = list(each)
        if place is None:
            yield from problems
        else:
            last = problems[-1]
            yield last | {"type": "too_few", "loc": place, "msg": f"needs {last['loc'][-1] + 1} values"}


def _short_list(problem: Any) -> Any:
    """Where the list is that a fault says lacks a value; None for other faults."""
    lacks = problem["type"] == "missing" and isinstance(problem["loc"][-1], int)
    return problem["loc"][:-1] if lacks else None


def _shows_value(problem: Any) -> bool:
    """Whether a fault is that of a key's value, and not that of the key."""
    return bool(problem["loc"]) and problem["type"] not in ("extra_forbidden", "missing")


def _explain(model: type[BaseModel], key: str, problem: Any) -> str:
    """What is wrong with a key or with its value, in words."""
    if problem["type"] == "extra_forbidden":
        *sections, word = key.split(".")
        allowed = _keys_at(model, ".".join(sections))
        return f"unknown key{suggestion(word, allowed)} (allowed: {', '.join(allowed)})"
    if problem["type"] == "missing":
        return "missing"
    if problem["type"] in ("model_type", "model_attributes_type"):
        return f"must be keys with values ({', '.join(_keys_at(model, key))})"
    if problem["type"] == "too_long":
        return f"takes {problem['ctx']['max_length']} values at most"
    text = str(problem["msg"]).removeprefix("Value error, ")
    return text.replace("Input should be", "must be").replace("a valid tuple", "a list")


def _keys_at(model: type[BaseModel], key: str) -> list[str]:
    return [name for name in _fields_at(model, key.split(".") if key else []) if name != "profile"]


def _fields_at(model: type[BaseModel], path: list[str]) -> list[str]:
    """Keys that the model has at a nested place."""
    for part in path:
        annotation = model.model_fields[part].annotation
        options = typing.get_args(annotation) if isinstance(annotation, types.UnionType) else (annotation,)
        model = next(option for option in options if isinstance(option, type) and issubclass(option, BaseModel))
    return list(model.model_fields)


def suggestion(word: str, known: list[str]) -> str:
    """Words that name the known word nearest to an unknown one; empty when none is near."""
    near = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""
