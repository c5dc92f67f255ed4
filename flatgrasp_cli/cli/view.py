"""`flatgrasp view DOCUMENT|SOURCE`."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

from flatgrasp_cli.cli.defaults import context_of
from flatgrasp_cli.cli.outputs import NO_GRASP, Names, Warnings, say_written, writing
from flatgrasp_cli.cli.planning_options import planning_options
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.source_names import name_of
from flatgrasp_cli.whole_files import write_text

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.results.page import Frame

OF_READING = {
    "camera_pose",
    "base_frame",
    "intrinsics",
    "depth_unit",
    "depth_axes",
    "scale",
    "config",
    "verbose",
    "out",
}
"""Options that say how a cloud is read; a document has its plan from all others."""


@click.command("view", context_settings=context_of("view"))
@click.argument("source", metavar="DOCUMENT|SOURCE")
@planning_options
@click.option(
    "--out",
    "-o",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="The page, and no browser; if not given, STEM.html in the current folder, and a browser if there is one.",
)
def command(source: str, job: Job, out: Path | None) -> int:
    """Look at grasps in three dimensions: one page for a browser, which needs no network.

    Of a DOCUMENT that plan or batch wrote (.json, .jsonl) the page shows what it says, and the cloud that it was made
    of if that is still there; of a SOURCE, anything that plan reads, the grasps are planned now. Exit code 0: every
    frame has a grasp; 1: some frame has none, the page says why; 2: the page cannot be written; 3: the document or the
    source could not be read.
    """
    from flatgrasp_cli.results.page import page
    from flatgrasp_cli.results.saved import is_document, stem_of

    document = is_document(source)
    if document:
        _refuse_options()
    path = out or Path(f"{stem_of(source) if document else Names().of_source(source)}.html")
    watched = _Watched(_saved(source, job) if document else _planned(source, job))
    with writing(path):
        write_text(path, page(watched, f"flatgrasp: {name_of(source)}"))
    say_written([path])
    if out is None:
        _open_browser(path)
    return NO_GRASP if watched.refused else 0


class _Watched:
    """Frames on their way into the page, of which those without a grasp are counted."""

    def __init__(self, frames: Iterator[Frame]) -> None:
        self._frames = frames
        self.refused = 0

    def __iter__(self) -> Iterator[Frame]:
        for frame in self._frames:
            self.refused += frame.document.status != "ok"
            yield frame


def _planned(source: str, job: Job) -> Iterator[Frame]:
    """The frames of a source, planned now."""
    from flatgrasp_cli.results.document import to_document, to_json
    from flatgrasp_cli.results.page import Frame
    from flatgrasp_cli.results.saved import SavedDocument

    warnings = Warnings()
    for cloud, read_ms in job.clouds(source, colors=True):
        plan = job.plan(cloud)
        warnings.tell(plan, source)
        yield Frame(SavedDocument.model_validate_json(to_json(to_document(plan, read_ms))), plan.cloud)


def _saved(path: str, job: Job) -> Iterator[Frame]:
    """The frames of documents, with their clouds as far as they can be found."""
    from flatgrasp_cli.cli.clouds_again import CloudsAgain
    from flatgrasp_cli.results.page import Frame
    from flatgrasp_cli.results.saved import read_documents

    clouds = CloudsAgain(job, Path(path).parent)
    for document in read_documents(path):
        yield Frame(document, clouds.of(document))


def _refuse_options() -> None:
    """Refuse what would plan otherwise: a document has its plan."""
    context = click.get_current_context()
    given = [each for each in context.command.params if isinstance(each, click.Option) and each.name not in OF_READING]
    for each in given:
        if context.get_parameter_source(str(each.name)) is ParameterSource.COMMANDLINE:
            raise UsageError(
                f"{each.opts[0]} cannot change a document, which has its plan; give the source itself to plan anew"
            )


def _open_browser(path: Path) -> None:
    """Show the page to whoever sits at the terminal, where there is a screen to do so."""
    screen = sys.platform != "linux" or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    if screen and sys.stderr is not None and sys.stderr.isatty():
        import webbrowser

        webbrowser.open(path.resolve().as_uri())
