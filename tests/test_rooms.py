"""What each room may speak of, where import-linter sees only what it imports; and what the package gives to Python."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

import pytest

import flatgrasp_cli
from tests.package_trees import FILES, PACKAGE, tree

T = TypeVar("T", ast.FunctionDef, ast.ClassDef, ast.Call)
GRASPING = re.compile(
    r"\bgrasps?\b|grasping|gripper|planner|robot'?s?\b|finger|support plane|\bhands?\b|\barms?\b|scene|silhouette",
    re.IGNORECASE,
)


def test_recordings_speak_of_nothing_that_is_grasped() -> None:
    files = sorted((PACKAGE / "recordings").rglob("*.py"))
    assert len(files) > 20
    found = {
        f"{path.relative_to(PACKAGE)}:{number}": line
        for path in files
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if GRASPING.search(line)
    }
    assert found == {}


CORE = (
    *("geometry", "kernels", "methods", "model", "placing", "planner", "planning", "proof"),
    *("ranking", "robot", "scene", "sensor", "surroundings"),
)
OPTION = re.compile(r"--[a-z]")


def docstrings(path: Path) -> Iterator[str]:
    """Those of a module, its classes, functions and fields, and its comments."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield node.value.value
    yield from (line.partition("#")[2] for line in path.read_text(encoding="utf-8").splitlines())


@pytest.mark.parametrize("room", CORE)
def test_the_core_knows_no_command_line(room: str) -> None:
    """Texts of warnings name the option that settles them; what explains the code does not."""
    files = sorted((PACKAGE / room).rglob("*.py"))
    assert files
    assert [text for path in files for text in docstrings(path) if OPTION.search(text)] == []


def test_every_public_name_is_there_and_documented() -> None:
    assert set(flatgrasp_cli.__all__) == set(flatgrasp_cli._HOMES)
    for name in flatgrasp_cli.__all__:
        value = getattr(flatgrasp_cli, name)
        assert value.__name__ == name
        assert value.__doc__, name
        assert not value.__doc__.startswith(f"{name}("), name  # what dataclasses write where nobody did


LONGEST_FILE, LONGEST_FUNCTION, MOST_POSITIONAL = 250, 40, 4


def test_files_are_read_in_one_sitting() -> None:
    lines = {path.name: len(path.read_text(encoding="utf-8").splitlines()) for path in FILES}
    assert {name: count for name, count in lines.items() if count > LONGEST_FILE} == {}


def nodes(path: Path, kind: type[T]) -> Iterator[T]:
    return (node for node in ast.walk(tree(path)) if isinstance(node, kind))


def test_functions_do_one_thing() -> None:
    """Their bodies, docstring and all: a command has a parameter for each of its options."""
    lines = {
        f"{path.name}:{node.name}": (node.end_lineno or 0) - node.body[0].lineno + 1
        for path in FILES
        for node in nodes(path, ast.FunctionDef)
    }
    assert {name: count for name, count in lines.items() if count > LONGEST_FUNCTION} == {}


def test_long_constructors_are_called_by_keyword() -> None:
    classes = {node.name for path in FILES for node in nodes(path, ast.ClassDef)}
    found = [
        f"{path.name}:{node.lineno} {node.func.id}"
        for path in FILES
        for node in nodes(path, ast.Call)
        if isinstance(node.func, ast.Name) and node.func.id in classes and len(node.args) > MOST_POSITIONAL
    ]
    assert found == []


@pytest.mark.parametrize("word", ["terrain", "support"])
def test_the_planner_has_no_branch_on_what_stands_around(word: str) -> None:
    """The paper knows no table: what it needs to know of one comes through `Surroundings`."""
    conditions = [
        f"{path.name}:{node.lineno}"
        for path in sorted((PACKAGE / "planner").rglob("*.py"))
        for node in ast.walk(tree(path))
        if isinstance(node, ast.If | ast.IfExp)
        if word in ast.unparse(node.test)
    ]
    assert conditions == []
