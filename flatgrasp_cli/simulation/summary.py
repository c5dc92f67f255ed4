"""Trials in numbers: how many were held, and between which rates the true one lies."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flatgrasp_cli.simulation.trial import Trial

CONFIDENCE_95 = 1.959964
"""Standard deviations that hold 95 % of a normal distribution."""


@dataclass(frozen=True, slots=True)
class Row:
    """The trials of one object: counts, why those failed that did, and the 95 % interval of the held rate."""

    object: str
    trials: int
    held: int
    clean: int
    no_grasp: int
    why: tuple[tuple[str, int], ...]
    interval: tuple[float, float]


def rows_of(trials: Iterable[Trial]) -> list[Row]:
    """A row for each object, in the order in which they came up."""
    by_object: dict[str, list[Trial]] = {}
    for trial in trials:
        by_object.setdefault(trial.object, []).append(trial)
    return [row_of(name, some) for name, some in by_object.items()]


def row_of(name: str, trials: Sequence[Trial]) -> Row:
    """Trials in one row."""
    held = [trial for trial in trials if trial.status == "held"]
    why = Counter(trial.reason for trial in trials if trial.reason is not None)
    return Row(
        object=name,
        trials=len(trials),
        held=len(held),
        clean=sum(trial.execution is not None and trial.execution.clean for trial in held),
        no_grasp=sum(trial.status == "no_grasp" for trial in trials),
        why=tuple(why.most_common()),
        interval=wilson(len(held), len(trials)),
    )


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """The 95 % interval of a rate after so many trials (E. B. Wilson, JASA 22, 1927); from 0 to 1 without any."""
    if trials == 0:
        return 0.0, 1.0
    share, z2 = successes / trials, CONFIDENCE_95**2
    middle = (share + z2 / (2 * trials)) / (1 + z2 / trials)
    half = CONFIDENCE_95 / (1 + z2 / trials) * math.sqrt(share * (1 - share) / trials + z2 / (4 * trials**2))
    return max(middle - half, 0.0), min(middle + half, 1.0)
