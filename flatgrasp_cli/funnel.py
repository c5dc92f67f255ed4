"""The funnel: how many candidates each stage keeps, and the nearest miss of the stage that kept none."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model import GraspCandidates, Rejection, Stage, Trace


class Miss(NamedTuple):
    """Why a stage kept nothing, in words, and by a stable one where there are several causes."""

    reason: str
    cause: str


class NothingLeft(Exception):  # noqa: N818 (an ending, not an error)
    """Raised by the stage that removed the last candidate; carries the reason."""

    def __init__(self, rejection: Rejection) -> None:
        super().__init__(rejection.reason)
        self.rejection = rejection


class Funnel:
    """Counts candidates stage by stage; a stage that keeps none ends the method with `NothingLeft`.

    `trace` keeps what figures show of the way, and decides nothing.
    """

    def __init__(self, trace: Trace | None = None) -> None:
        self.stages: list[Stage] = []
        self.trace = trace or Trace()

    def count(self, stage: str, kept: int, reason: str) -> None:
        """Note that a stage kept `kept` candidates; `reason` explains none."""
        if kept == 0:
            raise self.nothing(stage, reason)
        self.stages.append(Stage(stage, kept))

    def nothing(self, stage: str, reason: str) -> NothingLeft:
        """Note that a stage kept nothing; returns the ending to raise."""
        self.stages.append(Stage(stage, 0))
        return NothingLeft(Rejection(stage, reason))

    def at_most(
        self, stage: str, pairs: GraspCandidates, values: FloatArray, limit: float, miss: Callable[[float], str | Miss]
    ) -> IntArray:
        """Indices of the pairs whose `values` (p,) are at most `limit`; `miss` words the nearest value beyond it."""
        (kept,) = (values <= limit).nonzero()
        self.stages.append(Stage(stage, len(kept)))
        self.trace.survivors[stage] = np.array([pairs.i.take(kept), pairs.j.take(kept)]).T
        if len(kept) == 0:
            nearest = float(values.min())
            finite = nearest if np.isfinite(nearest) else None
            words = miss(nearest)
            reason, cause = words if isinstance(words, Miss) else (words, None)
            raise NothingLeft(Rejection(stage=stage, reason=reason, value=finite, limit=float(limit), cause=cause))
        return kept
