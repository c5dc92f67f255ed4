"""The clouds that documents were made of, read again where they still are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.errors import FlatgraspError

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.model import Cloud
    from flatgrasp_cli.results.saved import SavedDocument


class CloudsAgain:
    """Finds the cloud of one document after the other; those of one recording in the order of time.

    A source that is not where its document says is looked for beside the document, in `folder`.
    """

    def __init__(self, job: Job, folder: Path) -> None:
        self._job, self._folder = job, folder
        self._source = ""
        self._clouds: Iterator[Cloud] = iter(())
        self._told = False

    def of(self, document: SavedDocument) -> Cloud | None:
        """The cloud of a document; None, and a warning once, if it is not there, or is another one by now."""
        source = document.source.path
        if source != self._source:
            self._source, self._told = source, False
            self._clouds = self._read(document)
        for _ in range(2):  # documents need not be in order: the second time from the beginning
            found = next((cloud for cloud in self._clouds if document.is_of(cloud)), None)
            if found is not None:
                return found
            self._clouds = self._read(document)
        self._warn(f"{source}: does not hold the cloud of the document, in frame {document.frame_id!r}")
        return None

    def _read(self, document: SavedDocument) -> Iterator[Cloud]:
        """All clouds of a source, in the document's frame where the recording's transforms lead there."""
        job, source = self._job, document.source.path
        beside = self._folder / Path(source).name
        source = str(beside) if not Path(source).exists() and beside.exists() else source
        job = replace(job, selection=replace(job.selection, topic=document.source.topic))
        try:
            first = next((cloud for cloud, _ in job.clouds(source)), None)
            if first is not None and first.frame_name != document.frame_id and job.workcell.base_frame is None:
                job = replace(job, workcell=replace(job.workcell, base_frame=document.frame_id))
            yield from (cloud for cloud, _ in job.clouds(source, colors=True))
        except FlatgraspError as error:
            self._warn(str(error).partition("\n")[0])

    def _warn(self, text: str) -> None:
        if not self._told:
            self._told = True
            click.echo(
                f"flatgrasp: warning: {text}; the page has no cloud (--camera-pose and --base-frame place it)", err=True
            )
