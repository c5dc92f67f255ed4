"""A batch in numbers: for each input, and for all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from flatgrasp_cli.batch.inputs import Input
from flatgrasp_cli.batch.store import SCHEMA, Store

STRIP = 12
"""Frames of an input that a report shows."""


@dataclass(slots=True)
class InputSummary:
    """What came of one input; `shown` are records of frames for a report, those without a grasp first."""

    source: str
    name: str
    error: str | None
    warnings: list[str]
    frames: int = 0
    grasped: int = 0
    total_ms: float | None = None
    stages: Counter[str] = field(default_factory=Counter)
    shown: list[tuple[int, dict[str, Any]]] = field(default_factory=list)

    def values(self) -> dict[str, Any]:
        """For JSON: all but the records."""
        return {
            "source": self.source,
            "results": f"{self.name}.jsonl" if self.frames else None,
            "frames": self.frames,
            "grasped": self.grasped,
            "no_grasp_by_stage": dict(self.stages.most_common()),
            "median_total_ms": self.total_ms,
            "error": self.error,
            "warnings": self.warnings,
        }


def summarize(store: Store, inputs: Iterable[Input]) -> list[InputSummary]:
    """The inputs that were worked on to their end, failures first, then by the share of frames with a grasp."""
    found = [_of_input(store, item) for item in inputs if store.state(item) is not None]
    return sorted(found, key=lambda one: (one.error is None, one.grasped / one.frames if one.frames else 0.0, one.name))


def batch_values(inputs: list[InputSummary]) -> dict[str, Any]:
    """The whole batch, for JSON."""
    stages: Counter[str] = Counter()
    for one in inputs:
        stages.update(one.stages)
    return {
        "schema": SCHEMA,
        "inputs": len(inputs),
        "failed": sum(one.error is not None for one in inputs),
        "frames": sum(one.frames for one in inputs),
        "grasped": sum(one.grasped for one in inputs),
        "no_grasp_by_stage": dict(stages.most_common()),
        "by_input": [one.values() for one in inputs],
    }


def _of_input(store: Store, item: Input) -> InputSummary:
    state = store.state(item)
    assert state is not None  # noqa: S101 - for the type checker
    summary = InputSummary(item.source, item.name, state.error, state.warnings)
    times: list[float] = []
    refused: list[tuple[int, dict[str, Any]]] = []
    grasped: list[tuple[int, dict[str, Any]]] = []
    for index, record in enumerate(store.records(item)):
        ok = record["status"] == "ok"
        summary.frames += 1
        summary.grasped += ok
        times.append(record["timing_ms"]["total"])
        if not ok:
            summary.stages[record["stage"] or "scene"] += 1
        kept = grasped if ok else refused
        if len(kept) < STRIP:
            kept.append((index, record))
    summary.total_ms = round(median(times), 3) if times else None
    summary.shown = [*refused, *grasped][:STRIP]
    return summary
