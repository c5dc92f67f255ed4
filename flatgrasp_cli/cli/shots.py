"""Pictures and the film of simulated trials."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from flatgrasp_cli.cli.outputs import Pictures, writing
from flatgrasp_cli.whole_files import write_bytes

if TYPE_CHECKING:
    from flatgrasp_cli.simulation.trial import Cell, Trial


class Shots:
    """Draws the first trial of each object that was held, else the first, and films the first of each."""

    def __init__(self, cell: Cell, folder: Path | None, film: Path | None, *, plots: bool) -> None:
        from flatgrasp_cli.simulation.snapshots import Recorder

        self._cell, self._film, self._plots = cell, film, plots
        self._pictures = Pictures((folder or Path()) if plots else None)
        self._drawn: dict[str, Trial] = {}
        self._filmed: dict[str, Trial] = {}
        if plots or film is not None:
            cell.recorder = Recorder()

    def take(self, trial: Trial) -> Trial:
        """Keep a trial if it is to be shown; returns it without its film, which is large."""
        self._filmed.setdefault(trial.object, trial)
        if self._drawn.get(trial.object, trial).status != "held":
            self._drawn[trial.object] = trial
        else:
            self._drawn.setdefault(trial.object, trial)
        return replace(trial, film=None)

    def finish(self) -> None:
        """Write what is to be shown."""
        if self._plots:
            from flatgrasp_cli.simulation.pictures import trial_figure

            for trial in self._drawn.values():
                if trial.film is not None:
                    self._pictures.save(f"{stem_of(trial)}.trial", partial(trial_figure, trial, trial.film))
        if self._film is not None:
            from flatgrasp_cli.simulation.pictures import film

            with writing(self._film):
                write_bytes(self._film, film(list(self._filmed.values())))
            self._pictures.written.append(self._film)

    @property
    def written(self) -> list[Path]:
        """The files that were written."""
        return self._pictures.written

    @property
    def code(self) -> int:
        """What the process ends with if a picture could not be drawn; else 0."""
        return self._pictures.code


def stem_of(trial: Trial) -> str:
    """The name of a trial's files: the object's and the trial's number, or the heap's and the attempt's."""
    if trial.in_heap:
        return f"heap.{trial.number:02d}.{trial.attempt:02d}"
    return f"{trial.object}.{trial.number:02d}"
