"""The clouds that documents were made of, read again where they still are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.errors import FlatgraspError
from flatgrasp_cli.source_names import path_of
from flatgrasp_cli.sources.selection import Moment

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.model import Cloud
    from flatgrasp_cli.results.saved import SavedDocument

BEFORE_NS = 10**9
"""A recording is looked through from so long before a document's time: it may have come down a moment earlier."""


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
        source, stamp_ns = document.source.path, document.source.stamp_ns
        if source != self._source:
            self._source, self._told = source, False
            self._clouds = iter(())
        if self._told:
            return None  # the whole source was looked through in vain: it would be for the others, too
        starts = [None] if stamp_ns is None else [stamp_ns - BEFORE_NS, None]
        for clouds in (self._clouds, *(self._read(document, start_ns) for start_ns in starts)):
            self._clouds = clouds  # the next document's is likely to come next
            found = next((cloud for cloud in clouds if document.is_of(cloud)), None)
            if found is not None:
                return found
        self._warn(f"{source}: does not hold the cloud of the document, in frame {document.frame_id!r}")
        return None

    def _read(self, document: SavedDocument, start_ns: int | None) -> Iterator[Cloud]:
        """Clouds of a source, in the document's frame where the recording's transforms lead there.

        They begin at `start_ns`, or with the first; only then it is said why they cannot be read.
        """
        job, source = self._job, self._place_of(document.source.path)
        try:
            job = replace(job, selection=replace(job.selection, topic=document.source.topic))
            first = next((cloud for cloud, _ in job.clouds(source)), None)
            if first is not None and first.frame_name != document.frame_id and job.workcell.base_frame is None:
                job = replace(job, workcell=replace(job.workcell, base_frame=document.frame_id))
            if start_ns is not None:
                job = replace(job, selection=replace(job.selection, start=Moment(start_ns, absolute=True)))
            yield from (cloud for cloud, _ in job.clouds(source, colors=True))
        except FlatgraspError as error:
            if start_ns is None:
                self._warn(str(error).partition("\n")[0])

    def _place_of(self, name: str) -> str:
        """Where the source of that name is; the name itself if it is nowhere."""
        paths = (name, path_of(name))
        places = (*paths, *(str(self._folder / Path(path).name) for path in paths))
        return next((place for place in places if Path(place).exists()), name)

    def _warn(self, text: str) -> None:
        if not self._told:
            self._told = True
            click.echo(
                f"flatgrasp: warning: {text}; the page has no cloud (--camera-pose and --base-frame place it)", err=True
            )
