"""What each room may speak of, where import-linter sees only what it imports."""

from __future__ import annotations

import re
from pathlib import Path

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
