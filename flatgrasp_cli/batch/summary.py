"""A batch in numbers: for each input, and for all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain, islice, zip_longest
from statistics import median
from typing import Any

from flatgrasp_cli.batch.inputs import Input
from flatgrasp_cli.batch.store import Store
from flatgrasp_cli.results.contracts.batch import SCHEMA_ID, BatchDocument, InputPart
from flatgrasp_cli.source_names import name_of

STRIP = 12
"""Frames of an input that a report shows."""
STEPS = ("read", "scene", "plan", "total")
NO_OBJECT = "scene"


@dataclass(slots=True)
class InputSummary:
    """What came of one input; `shown` are records of frames for a report, those without a grasp first.

    `median_ms` are those of frames that did not wait for libraries to load; `first_ms` took, each in a worker of its
    own, the frames that did.
    """

    source: str
    name: str
    error: str | None
    warnings: list[str]
    frames: int = 0
    grasped: int = 0
    total_ms: float | None = None
    median_ms: dict[str, float] = field(default_factory=dict)
    first_ms: list[float] = field(default_factory=list)
    stages: Counter[str] = field(default_factory=Counter)
    shown: list[tuple[int, dict[str, Any]]] = field(default_factory=list)

    def part(self) -> InputPart:
        """For JSON: all but the records."""
        return InputPart(
            source=name_of(self.source),
            results=f"{self.name}.jsonl" if self.frames else None,
            frames=self.frames,
            grasped=self.grasped,
            no_grasp_by_stage=dict(self.stages.most_common()),
            median_total_ms=self.total_ms,
            median_ms=self.median_ms,
            first_frames_ms=self.first_ms,
            error=self.error,
            warnings=self.warnings,
        )


def summarize(store: Store, inputs: Iterable[Input]) -> list[InputSummary]:
    """The inputs that were worked on to their end, failures first, then by the share of frames with a grasp."""
    found = [_of_input(store, item) for item in inputs if store.state(item) is not None]
    return sorted(found, key=lambda one: (one.error is None, one.grasped / one.frames if one.frames else 0.0, one.name))


def batch_values(inputs: list[InputSummary]) -> dict[str, Any]:
    """The whole batch, for JSON."""
    stages: Counter[str] = Counter()
    for one in inputs:
        stages.update(one.stages)
    document = BatchDocument(
        schema=SCHEMA_ID,
        inputs=len(inputs),
        failed=sum(one.error is not None for one in inputs),
        frames=sum(one.frames for one in inputs),
        grasped=sum(one.grasped for one in inputs),
        no_grasp_by_stage=dict(stages.most_common()),
        by_input=[one.part() for one in inputs],
    )
    return dict(document)


def _of_input(store: Store, item: Input) -> InputSummary:
    state = store.state(item)
    assert state is not None  # noqa: S101 - for the type checker
    summary = InputSummary(item.source, item.name, state.error, state.warnings)
    times: list[float] = []
    steady: list[dict[str, float]] = []
    examples: dict[str, list[tuple[int, dict[str, Any]]]] = {}
    for index, record in enumerate(store.records(item)):
        stage = None if record["status"] == "ok" else record["stage"] or NO_OBJECT
        summary.frames += 1
        summary.grasped += stage is None
        times.append(record["timing_ms"]["total"])
        if record["timing_ms"]["first"]:
            summary.first_ms.append(record["timing_ms"]["total"])
        else:
            steady.append(record["timing_ms"])
        if stage is not None:
            summary.stages[stage] += 1
        kept = examples.setdefault(stage or "", [])
        if len(kept) < STRIP:
            kept.append((index, record))
    summary.total_ms = round(median(times), 3) if times else None
    if steady:
        summary.median_ms = {step: round(median(timing[step] for timing in steady), 3) for step in STEPS}
    summary.shown = chosen(examples)
    return summary


def chosen(examples: dict[str, list[tuple[int, dict[str, Any]]]]) -> list[tuple[int, dict[str, Any]]]:
    """As many frames as a report shows: of each reason in turn, then those with a grasp, which have none."""
    grasped = examples.pop("", [])
    in_turn = (each for each in chain.from_iterable(zip_longest(*examples.values())) if each is not None)
    return list(islice(chain(in_turn, grasped), STRIP))
