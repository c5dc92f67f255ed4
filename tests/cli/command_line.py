"""What the tests of the command line share: the command as a process, and how documents are compared."""

from __future__ import annotations

import io
import json
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import pytest

from flatgrasp_cli.cli import run as run_here

PNG = b"\x89PNG\r\n\x1a\n"
COMMAND = [sys.executable, "-m", "flatgrasp_cli"]


def called(*arguments: str | Path) -> tuple[int, str]:
    """The exit code of the command line in this process, and what it prints, for fixtures that outlive a test."""
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(io.StringIO()) as out:
        patch.setattr(sys, "argv", ["flatgrasp", *map(str, arguments)])
        return run_here(), out.getvalue()


def documents(text: str) -> list[dict[str, Any]]:
    """JSON Lines."""
    assert text.endswith("\n")
    return [json.loads(line) for line in text.splitlines()]


def untimed(text: str) -> str:
    """A document as text without its times, its keys in their order."""
    document = json.loads(text)
    assert all(value >= 0 for value in document.pop("timing_ms").values())
    return json.dumps(document)


def answer(document: dict[str, Any]) -> Any:
    """What was found, wherever it was read from."""
    return document["status"], document["objects"], document["gripper"], document["settings"]


def modules(importtime: str) -> set[str]:
    """The top-level packages that `-X importtime` says were loaded."""
    rows = [line for line in importtime.splitlines() if line.startswith("import time:")]
    assert len(rows) > 50
    return {row.rsplit("|", 1)[1].strip().split(".")[0] for row in rows}
