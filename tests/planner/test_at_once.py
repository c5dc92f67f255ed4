"""How much is worked on at once decides how long it takes, and nothing else."""

from __future__ import annotations

from typing import Any

import pytest

from flatgrasp_cli import load_gripper, load_settings, plan, to_document
from flatgrasp_cli.geometry import arrays
from flatgrasp_cli.scene import clusters
from tests.conftest import TABLE, Box, Camera

SCENE = Camera(pixels=(160, 120), focal=230.0).sees(TABLE, Box((0.0, 0.0, 0.03), (0.12, 0.04, 0.06), 20))


def document() -> dict[str, Any]:
    result = to_document(plan(SCENE, load_gripper("pr2"), load_settings("default", ("caging.certify=false",))))
    result.pop("timing_ms")
    return result


def test_what_is_worked_on_at_once_does_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = document()
    assert usual["objects"][0]["grasps"]
    for module in (arrays, clusters):
        monkeypatch.setattr(module, "IN_CACHE", max(1, arrays.IN_CACHE // 50))
    assert document() == usual
