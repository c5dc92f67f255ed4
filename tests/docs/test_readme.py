"""The README does not lie: its Python runs, its options and files exist."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import click
import pytest

from flatgrasp_cli.cli import cli

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^\$ (.*flatgrasp.*?)(?:\s+#.*)?$", README, flags=re.MULTILINE)


def test_the_python_example_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    example = re.search(r"```python\n(.*?)```", README, flags=re.DOTALL)
    assert example is not None
    exec(example.group(1), {})  # noqa: S102
    assert "[" in capsys.readouterr().out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_shown_exists(command: str) -> None:
    ours = next(part for part in command.split(" | ") if part.startswith("flatgrasp "))
    words = shlex.split(ours.split(" > ", maxsplit=1)[0])[1:]
    context = click.Context(cli)
    found = cli.get_command(context, words[0])
    assert found is not None
    if isinstance(found, click.Group):
        assert found.get_command(context, words[1]) is not None
        return
    known = {option for parameter in found.params for option in parameter.opts}
    assert {word for word in words if word.startswith("--")} <= known


def test_every_linked_file_exists() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []
