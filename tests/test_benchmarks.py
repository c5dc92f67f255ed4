"""Benchmarks wrap the stages of the method by their names, which nothing but running them would miss."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parent.parent / "benchmarks"


@pytest.mark.parametrize(("benchmark", "stages"), [("frame_rate", "STAGES"), ("plan_speed", "SECTIONS")])
def test_the_stages_that_are_timed_are_there(benchmark: str, stages: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    timed = getattr(importlib.import_module(benchmark), stages)
    calls = [call for of_stage in timed.values() for call in of_stage]
    assert len(calls) > 10
    assert [name for place, name in calls if not callable(getattr(place, name, None))] == []
