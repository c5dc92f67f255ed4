"""What the benchmarks take times with."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from types import ModuleType
from typing import Any


def milliseconds(function: Callable[[], object]) -> float:
    """Wall time of one call."""
    began = time.perf_counter()
    function()
    return 1e3 * (time.perf_counter() - began)


class StageClock:
    """Times calls by wrapping them, in `ms` by stage; scene and planner carry no clocks themselves."""

    def __init__(self, stages: Mapping[str, Iterable[tuple[ModuleType | type, str]]]) -> None:
        self.ms: dict[str, float] = defaultdict(float)
        for stage, calls in stages.items():
            for module, name in calls:
                setattr(module, name, self._timed(getattr(module, name), stage))

    def _timed(self, function: Callable[..., Any], stage: str) -> Callable[..., Any]:
        def timed(*args: Any, **kwargs: Any) -> Any:
            began = time.perf_counter()
            try:
                return function(*args, **kwargs)
            finally:
                self.ms[stage] += 1e3 * (time.perf_counter() - began)

        return timed
