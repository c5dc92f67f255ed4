"""A page in three dimensions for each input, of the frames that the report shows."""

from __future__ import annotations

from collections.abc import Iterable

from flatgrasp_cli.batch.again import frames_of
from flatgrasp_cli.batch.inputs import Input
from flatgrasp_cli.batch.store import Store
from flatgrasp_cli.batch.summary import InputSummary
from flatgrasp_cli.job import Job
from flatgrasp_cli.results.page import Frame, page
from flatgrasp_cli.whole_files import write_text


def page_of(name: str) -> str:
    """The file of an input's page, by the name of its results."""
    return f"{name}.view.html"


def write_pages(job: Job, store: Store, inputs: Iterable[Input], found: Iterable[InputSummary]) -> None:
    """Write the page of every input that has frames."""
    shown = {one.name: {index for index, _ in one.shown} for one in found}
    for item in inputs:
        wanted = shown.get(item.name, set())
        frames = (
            Frame(each.document, each.cloud)
            for index, each in enumerate(frames_of(job, store, item))
            if index in wanted
        )
        if wanted:
            write_text(store.path(page_of(item.name)), page(frames, f"flatgrasp: {item.called}"))
