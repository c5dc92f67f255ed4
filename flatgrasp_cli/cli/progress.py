"""Progress on stderr, on a terminal only."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.progress import Progress


def bar(*, transient: bool = False) -> Progress:
    """A bar with words beside it, and the time that is left."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), TaskProgressColumn(), TextColumn("{task.description}"), TimeRemainingColumn())
    # stdout is data, which goes where it was sent
    return Progress(*columns, console=Console(stderr=True), transient=transient, redirect_stdout=False)


def on_terminal() -> bool:
    """Whether somebody watches stderr."""
    return sys.stderr is not None and sys.stderr.isatty()


class FrameProgress:
    """Which frame of which source is planned; shown from the second one on, and gone at the end."""

    def __init__(self, sources: int) -> None:
        self._sources, self._frames = sources, 0
        self._bar: Progress | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Step aside while something is printed: stdout may be the same terminal."""
        if self._bar is None:
            yield
            return
        self._bar.stop()
        yield
        self._bar.start()

    def frame(self, source: int) -> None:
        """Note that a frame of the source of that number, from 0, is planned now."""
        self._frames += 1
        if not on_terminal() or self._sources == self._frames == 1:
            return
        if self._bar is None:
            self._bar = bar(transient=True)
            self._bar.add_task("", total=None if self._sources == 1 else self._sources)
            self._bar.start()
        of = "" if self._sources == 1 else f"source {source + 1} of {self._sources}, "
        self._bar.update(self._bar.task_ids[0], completed=source, description=f"{of}frame {self._frames}")
