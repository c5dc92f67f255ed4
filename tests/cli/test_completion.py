"""The shell completes commands, options and profiles."""

from __future__ import annotations

import pytest
from click.shell_completion import BashComplete

from flatgrasp_cli.cli import cli


@pytest.mark.parametrize(
    ("words", "incomplete", "found"),
    [
        ([], "pl", {"plan"}),
        (["plan"], "--gri", {"--gripper"}),
        (["plan", "--gripper"], "robotiq", {"robotiq_2f_140", "robotiq_2f_85"}),
        (["serve", "--robot"], "ur5", {"ur5", "ur5e"}),
        (["plan", "--method"], "pa", {"paper"}),
        (["plan", "--gripper"], "mine.y", {"mine.y"}),
    ],
)
def test_completions(words: list[str], incomplete: str, found: set[str]) -> None:
    completer = BashComplete(cli, {}, "flatgrasp", "_FLATGRASP_COMPLETE")
    assert {each.value for each in completer.get_completions(words, incomplete)} == found
