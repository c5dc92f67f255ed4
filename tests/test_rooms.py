"""What each room may speak of, where import-linter sees only what it imports; and what the package gives to Python."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import flatgrasp_cli

PACKAGE = Path(__file__).parent.parent / "flatgrasp_cli"
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


CORE = ("geometry", "model", "placing", "planner", "robot", "scene", "sensor")
OPTION = re.compile(r"--[a-z]")


def docstrings(path: Path) -> Iterator[str]:
    """Those of a module, its classes, functions and fields, and its comments."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
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
