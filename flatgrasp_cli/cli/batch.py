"""`flatgrasp batch SOURCE…`."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.cli.bag_options import BagFile, bag_options
from flatgrasp_cli.cli.defaults import context_of
from flatgrasp_cli.cli.outputs import say_written
from flatgrasp_cli.cli.planning_options import planning_options
from flatgrasp_cli.cli.progress import bar
from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.source_names import in_utf8

if TYPE_CHECKING:
    from flatgrasp_cli.batch.inputs import Input
    from flatgrasp_cli.batch.run import Progress
    from flatgrasp_cli.batch.store import Store
    from flatgrasp_cli.job import Job

NO_GRASP, INTERRUPTED = 1, 130
PLAIN_EVERY_S = 10.0


@click.command("batch", context_settings=context_of("batch"))
@click.argument("sources", metavar="SOURCE…", nargs=-1)
@click.option("--from-list", metavar="FILE|-", help="Read further sources from a file, or standard input, a line each.")
@planning_options
@click.option(
    "--out",
    "-o",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    required=True,
    help="Folder of results.",
)
@click.option("--jobs", "-j", type=click.IntRange(min=1), metavar="N", help="Worker processes; all cores if not given.")
@click.option("--cluster", metavar="ADDRESS|local", help="Work on a Dask cluster, e.g. tcp://host:8786.")
@click.option(
    "--plots",
    is_flag=True,
    help="Draw final grasps as PNG, too, and pages in 3-D.",
)
@bag_options
@click.option("--force", is_flag=True, help="Start over, instead of going on with what the folder holds.")
@click.option("--quiet", "-q", is_flag=True, help="No progress.")
def command(
    sources: tuple[str, ...],
    from_list: str | None,
    job: Job,
    bag: BagFile,
    out: Path,
    jobs: int | None,
    cluster: str | None,
    plots: bool,
    force: bool,
    quiet: bool,
) -> int:
    """Plan grasps on many clouds and recordings: files, folders, globs, and URLs (s3://, gs://, http://).

    Writes into DIR a NAME.jsonl for each SOURCE, grasps.parquet (without pyarrow grasps.csv), summary.json and
    report.html. Uses all cores. Stopped at any moment, the same command goes on where it was. Exit code 0: a grasp in
    every frame; 1: some frame has none; 3: some source could not be read.
    """
    from flatgrasp_cli.batch.executors import Workers
    from flatgrasp_cli.batch.run import Progress, run
    from flatgrasp_cli.batch.store import Store

    job = replace(job, selection=replace(job.selection, typed=frozenset()))  # among many, some may have no use for one
    inputs = _inputs((*sources, *_listed(from_list)))
    store = Store(out)
    if force or not store.concluded(inputs):
        bag.check_new()
    with _full_disk(out):
        store.prepare(job, plots, force=force)
        with _shown(quiet) as (say, watch):
            progress = Progress(say, watch)
            try:
                run(job, inputs, store, Workers(jobs or _cores(), cluster), progress, plots=plots)
            except KeyboardInterrupt:
                click.echo(
                    f"flatgrasp: stopped after {progress.frames} frames; the same command goes on from there", err=True
                )
                return INTERRUPTED
        if not store.concluded(inputs):
            _conclude(job, store, inputs)
    _fill(bag, job, store, inputs)
    if not quiet:
        click.echo(
            f"flatgrasp: {progress.frames - progress.frames_refused} of {progress.frames} frames with a grasp, "
            f"{progress.inputs_failed} of {progress.inputs} inputs failed; see {in_utf8(str(out / 'report.html'))}",
            err=True,
        )
    if progress.inputs_failed:
        return SourceError.exit_code
    return NO_GRASP if progress.frames_refused else 0


def _inputs(sources: tuple[str, ...]) -> list[Input]:
    from flatgrasp_cli.batch.inputs import find_inputs

    inputs = find_inputs(sources)
    if not inputs:
        raise UsageError("nothing to plan: name files, folders, globs or URLs, or give --from-list")
    return inputs


def _cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


def _listed(from_list: str | None) -> list[str]:
    """The lines of a file or of standard input that are not empty; a path may have bytes that are no UTF-8."""
    if from_list is None:
        return []
    if from_list == "-" and sys.stdin is None:
        raise UsageError("--from-list -: standard input is closed")
    try:
        content = sys.stdin.buffer.read() if from_list == "-" else Path(from_list).read_bytes()
    except OSError as error:
        raise UsageError(f"--from-list {from_list}: cannot be read: {error}") from error
    if b"\0" in content:
        raise UsageError(f"--from-list {from_list}: is no text in UTF-8 with a path or URL a line")
    lines = content.decode("utf-8", "surrogateescape").split("\n")
    return [line.strip() for line in lines if line.strip()]


def _conclude(job: Job, store: Store, inputs: list[Input]) -> None:
    """Write what is about the whole batch."""
    from flatgrasp_cli.batch.pages import write_pages
    from flatgrasp_cli.batch.report import Made, report
    from flatgrasp_cli.batch.summary import batch_values, summarize
    from flatgrasp_cli.batch.table import write_table

    found = summarize(store, inputs)
    values = batch_values(found)
    table = write_table(store, inputs)
    if store.made_with()["plots"]:
        write_pages(job, store, inputs, found)
    made = Made(store.made_with(), f"{datetime.now().astimezone():%Y-%m-%d %H:%M %Z}", table.parent, table.name)
    store.write("report.html", "".join(report(found, values, made)))
    store.write("summary.json", json.dumps(values, indent=2, ensure_ascii=False) + "\n")
    store.conclude(inputs)


def _fill(file: BagFile, job: Job, store: Store, inputs: list[Input]) -> None:
    """Write all frames into the bag, if one was asked for; their clouds are read once more."""
    from flatgrasp_cli.batch.again import frames_of

    if file.written:
        return
    with file.opened() as bag:
        if bag is None:
            return
        for frame in (frame for item in inputs for frame in frames_of(job, store, item)):
            bag.add(frame.document, frame.text, frame.cloud)
    say_written(file.written)


@contextmanager
def _full_disk(out: Path) -> Iterator[None]:
    """Turn a failure to write into an error that says what to do; what was written before it is whole."""
    try:
        yield
    except OSError as error:
        raise UsageError(
            f"{out}: cannot be written: {error.strerror or error}; make room and give the same command again, "
            "or choose another folder with --out DIR"
        ) from error


@contextmanager
def _shown(quiet: bool) -> Iterator[tuple[Callable[[str], None], Callable[[Progress], None]]]:
    """How to say and show things: a bar on a terminal, else a line now and then."""
    if quiet or not sys.stderr.isatty():
        watch: Callable[[Progress], None] = _ignore if quiet else _Plain()
        yield _say, watch
        return
    with _bar() as (say, watch):
        yield say, watch


def _say(text: str) -> None:
    click.echo(f"flatgrasp: {text}", err=True)


def _ignore(_progress: Progress) -> None:
    pass


class _Plain:
    """A line every ten seconds."""

    def __init__(self) -> None:
        self._began = self._said = time.monotonic()

    def __call__(self, progress: Progress) -> None:
        now = time.monotonic()
        if now - self._said >= PLAIN_EVERY_S:
            self._said = now
            rate = progress.planned / (now - self._began)
            _say(f"{100 * progress.share:.0f} %, {_numbers(progress)}, {rate:.1f} frames/s")


def _numbers(progress: Progress) -> str:
    return (
        f"{progress.frames} frames, {progress.frames_refused} without a grasp, "
        f"{progress.inputs_done} of {progress.inputs} inputs, {progress.inputs_failed} failed"
    )


@contextmanager
def _bar() -> Iterator[tuple[Callable[[str], None], Callable[[Progress], None]]]:
    began = time.monotonic()
    with bar() as shown:
        task = shown.add_task("", total=1.0)

        def watch(progress: Progress) -> None:
            rate = progress.planned / max(time.monotonic() - began, 1e-9)
            shown.update(task, completed=progress.share, description=f"{_numbers(progress)}, {rate:.1f} frames/s")

        yield partial(shown.console.print, markup=False, highlight=False), watch
