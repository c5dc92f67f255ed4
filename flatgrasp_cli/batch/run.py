"""The coordinator: hands slices to an executor, keeps what comes back, and forgets it."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field

from flatgrasp_cli.batch.executors import Workers
from flatgrasp_cli.batch.inputs import Input, fingerprint
from flatgrasp_cli.batch.slices import Slice, slices_of
from flatgrasp_cli.batch.store import InputState, Store
from flatgrasp_cli.batch.work import Done, work
from flatgrasp_cli.job import Job

AHEAD = 2
"""Slices handed out for each worker, so that none waits for the coordinator."""
TRIES = 3
"""A slice whose worker dies is tried so often: it may be the slice that kills it."""


@dataclass(slots=True)
class Progress:
    """How far a batch is, for whoever watches; `say` takes warnings in words."""

    say: Callable[[str], None]
    watch: Callable[[Progress], None]
    inputs: int = 0
    inputs_done: int = 0
    inputs_failed: int = 0
    frames: int = 0
    frames_refused: int = 0
    planned: int = 0
    """Frames planned by this run, and not by one before it."""
    share: float = 0.0
    """Of the inputs, one at work counted by its slices."""


@dataclass(slots=True, eq=False)
class _Open:
    """An input at work."""

    fingerprint: str
    slices: int
    left: int


@dataclass(slots=True, eq=False)
class _Batch:
    job: Job
    plots: bool
    store: Store
    progress: Progress
    open: dict[Input, _Open] = field(default_factory=dict)
    tries: Counter[tuple[Input, int]] = field(default_factory=Counter)
    again: deque[Slice] = field(default_factory=deque)

    def pieces(self, inputs: Iterable[Input]) -> Iterator[Slice]:
        """All slices that are still to be done."""
        for item in inputs:
            mark = fingerprint(item.source)
            state = self.store.finished(item, mark)
            if state is not None:
                self._count(state, announce=False)
                continue
            if self.store.state(item) is not None:
                self.progress.say(f"{item.called}: has changed or failed before, and is planned again")
            slices = slices_of(item, self.job.selection)
            todo = [piece for piece in slices if not self.store.has_part(item, piece.index, mark)]
            self.open[item] = _Open(mark, len(slices), len(todo))
            if not todo:
                self._finish(item)
            yield from todo

    def keep(self, done: Done) -> None:
        """Store a slice, and its input if it was the last."""
        item = done.slice.input
        current = self.open[item]
        self.store.add(done, current.fingerprint)
        current.left -= 1
        self.progress.frames += len(done.frames)
        self.progress.planned += len(done.frames)
        self.progress.frames_refused += sum(frame.record["status"] != "ok" for frame in done.frames)
        if current.left == 0:
            self._finish(item)
        at_work = sum(1 - one.left / one.slices for one in self.open.values())
        self.progress.share = (self.progress.inputs_done + at_work) / self.progress.inputs
        self.progress.watch(self.progress)

    def lost(self, piece: Slice, error: BaseException) -> None:
        """Try a slice once more whose worker died; give it up when that keeps happening."""
        key = (piece.input, piece.index)
        self.tries[key] += 1
        reason = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        if self.tries[key] < TRIES:
            self.again.append(piece)
        else:
            self.keep(Done(piece, [], [], f"{piece.input.called}: cannot be planned, given up: {reason}"))

    def _finish(self, item: Input) -> None:
        state = self.store.finish(item, self.open.pop(item).slices)
        self._count(state, announce=True)

    def _count(self, state: InputState, *, announce: bool) -> None:
        self.progress.inputs_done += 1
        self.progress.inputs_failed += state.error is not None
        if not announce:
            self.progress.frames += state.frames
            self.progress.frames_refused += state.refused
            return
        for warning in state.warnings:
            self.progress.say(f"warning: {warning}")
        if state.error is not None:
            self.progress.say(state.error)


def run(job: Job, inputs: list[Input], store: Store, workers: Workers, progress: Progress, *, plots: bool) -> None:
    """Plan all inputs; what is done already is not done again. A few slices for each worker are in flight."""
    progress.inputs = len(inputs)
    batch = _Batch(job, plots, store, progress)
    pieces = batch.pieces(inputs)
    while _drain(batch, pieces, workers):
        pass  # the executor broke: the slices in flight are tried again on a new one


def _drain(batch: _Batch, pieces: Iterator[Slice], workers: Workers) -> bool:
    """Work until nothing is left, or the executor breaks; whether it broke."""
    waiting: dict[Future[Done], Slice] = {}
    broken = False
    with workers.open() as (pool, slots):
        while True:
            # a slice that may have killed its worker is tried alone: others in flight would be suspected with it
            alone = bool(batch.again) or any(batch.tries[piece.input, piece.index] for piece in waiting.values())
            while len(waiting) < (1 if alone else AHEAD * slots) and not broken:
                piece = batch.again.popleft() if batch.again else next(pieces, None)
                if piece is None:
                    break
                try:
                    waiting[pool.submit(work, batch.job, piece, batch.plots)] = piece
                except BrokenProcessPool as broke:
                    batch.lost(piece, broke)
                    broken = True
            if not waiting:
                return broken
            for future in wait(waiting, return_when=FIRST_COMPLETED).done:
                piece = waiting.pop(future)
                error = future.exception()
                if error is None:
                    batch.keep(future.result())
                else:
                    broken = broken or isinstance(error, BrokenProcessPool)
                    batch.lost(piece, error)
