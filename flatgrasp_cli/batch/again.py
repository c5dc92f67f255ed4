"""The frames of a finished batch once more, each with the cloud that it was planned on, which no result holds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from flatgrasp_cli.batch.inputs import Input
from flatgrasp_cli.batch.store import Store
from flatgrasp_cli.errors import FlatgraspError
from flatgrasp_cli.job import Job, collected_warnings
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.results.saved import SavedDocument, parse_document


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One frame: its document, also as the text of its line, and its cloud, None if it cannot be read any more."""

    document: SavedDocument
    text: str
    cloud: Cloud | None


def frames_of(job: Job, store: Store, item: Input) -> Iterator[Frame]:
    """The frames of an input, in order; the source is read again beside its documents."""
    clouds = _clouds(job, item.source)
    for number, line in enumerate(store.documents(item), 1):
        document = parse_document(line, f"{item.name}.jsonl: document {number}")
        cloud = next(clouds, None)
        yield Frame(document, line.rstrip("\n"), cloud if cloud is not None and document.is_of(cloud) else None)


def _clouds(job: Job, source: str) -> Iterator[Cloud]:
    """The clouds of a source as far as they can be read; what its readers warn of was said when it was planned."""
    clouds = job.clouds(source, colors=True)
    while True:
        with collected_warnings():
            try:
                cloud, _ = next(clouds)
            except (FlatgraspError, StopIteration):
                return
        yield cloud
