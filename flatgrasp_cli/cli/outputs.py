"""Where results go: files, JSON Lines on stdout, or a table."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.cli.console import show
from flatgrasp_cli.cli.imports import import_figures
from flatgrasp_cli.cli.progress import FrameProgress
from flatgrasp_cli.errors import FigureError, SourceError, UsageError
from flatgrasp_cli.source_names import STDIN, in_utf8, name_of
from flatgrasp_cli.whole_files import write_bytes, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flatgrasp_cli.model import Cloud
    from flatgrasp_cli.planning import Plan
    from flatgrasp_cli.results.exports.bag import Bag


NO_GRASP = 1
NAMED = 3
"""Files whose names are said; of more, how many, the first and the last."""


class Names:
    """File names for results, none of them twice."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def of_source(self, source: str) -> str:
        """The stem of a source's name, made safe; further sources of that name are numbered."""
        return self.unique(name_of(source) if source == STDIN else _safe(source) or "cloud")

    def of_frame(self, stem: str, cloud: Cloud, source: str) -> str:
        """The stem itself for a file with one cloud; else with the frame's time in seconds, or its own file's stem."""
        if cloud.source.path != name_of(source):
            return self.unique(f"{stem}.{_safe(cloud.source.path)}")
        if cloud.source.topic is None or cloud.source.stamp_ns is None:
            return stem
        return self.at(stem, cloud.source.stamp_ns)

    def at(self, stem: str, stamp_ns: int | None) -> str:
        """The stem with a frame's time in seconds, where that is known."""
        if stamp_ns is None:
            return self.unique(stem)
        seconds, ns = divmod(stamp_ns, 1_000_000_000)
        return self.unique(f"{stem}.{seconds}.{ns:09d}")

    def unique(self, name: str) -> str:
        """The name; one that was given before is numbered."""
        unique, n = name, 1
        while unique in self._taken:
            n += 1
            unique = f"{name}-{n}"
        self._taken.add(unique)
        return unique


def _safe(path: str) -> str:
    """The stem of a path's name with nothing in it that a file name should not have."""
    return re.sub(r"[^\w.+-]", "_", Path(path).stem)


class Pictures:
    """Draws PNGs into `folder` (None: none). One that cannot be drawn is said on stderr and costs nothing else."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self.written: list[Path] = []
        self.code = 0

    def save(self, name: str, draw: Callable[[], Figure | None]) -> None:
        """Write what `draw` draws, if it draws anything, as `name`.png."""
        if self._folder is None:
            return
        import_figures()
        from flatgrasp_cli.results.figures import as_png

        path = self._folder / f"{name}.png"
        try:
            content = as_png(draw)
        except FigureError as error:
            click.echo(f"flatgrasp: {path}: {error}", err=True)
            self.code = error.exit_code
            return
        if content is not None:
            with writing(path):
                write_bytes(path, content)
            self.written.append(path)


class Warnings:
    """Says on stderr what had to be assumed, once for each source and not for each of its frames."""

    def __init__(self) -> None:
        self._told: set[str] = set()

    def tell(self, plan: Plan, source: str) -> None:
        """Say the warnings of a plan that were not said of its source before."""
        for line in (f"{name_of(source)}: {warning.text}" for warning in plan.warnings):
            if line not in self._told:
                self._told.add(line)
                click.echo(f"flatgrasp: warning: {line}", err=True)


class Outputs:
    """Writes each plan as asked: into `folder` (None: no files) and a bag, and to stdout as JSON or as a table."""

    def __init__(
        self,
        folder: Path | None,
        as_json: bool,
        plots: str,
        progress: FrameProgress,
        *,
        wide: bool,
        bag: Bag | None = None,
    ) -> None:
        self._bag = bag
        self._folder, self._as_json, self._stages, self._wide = folder, as_json, plots == "stages", wide
        self._warnings, self._progress = Warnings(), progress
        self.refused = 0
        self.draws = folder is not None and plots != "none"
        self.pictures = Pictures(folder if self.draws else None)
        if folder is not None:
            with writing(folder):
                folder.mkdir(parents=True, exist_ok=True)

    def write(self, plan: Plan, source: str, stem: str, read_ms: float) -> None:
        """Write one plan of a source, pictures last; says on stderr when it has no grasp."""
        from flatgrasp_cli.results.document import to_document, to_json

        document = to_document(plan, read_ms)
        if self._folder is not None:
            path = self._folder / f"{stem}.grasps.json"
            with writing(path):
                write_text(path, [to_json(document, indent=2), "\n"])
            self.pictures.written.append(path)
        if self._bag is not None:
            self._add_to_bag(self._bag, to_json(document), plan)
        with self._progress.aside():
            self._warnings.tell(plan, source)
            if self._as_json:
                click.echo(to_json(document))
            elif plan.best is not None:
                self._print_table(plan)
            if plan.best is None:
                self.refused += 1
                say_refusal(plan)
        if self.draws:
            self._draw(plan, stem)

    @staticmethod
    def _add_to_bag(bag: Bag, text: str, plan: Plan) -> None:
        from flatgrasp_cli.results.saved import SavedDocument

        bag.add(SavedDocument.model_validate_json(text), text, plan.cloud)

    def _print_table(self, plan: Plan) -> None:
        from rich.text import Text

        from flatgrasp_cli.results.table import grasp_table, headline, refusals

        without = refusals(plan)
        show(Text(headline(plan)), grasp_table(plan, wide=self._wide), *([Text(without)] if without else []))

    def _draw(self, plan: Plan, stem: str) -> None:
        import_figures()
        from flatgrasp_cli.results.figures import arm_figure, final_figure, stage_figures

        self.pictures.save(f"{stem}.grasps", partial(final_figure, plan))
        self.pictures.save(f"{stem}.arm", partial(arm_figure, plan))
        for name, draw in stage_figures(plan) if self._stages else ():
            self.pictures.save(f"{stem}.stages/{name}", draw)


class Sources:
    """The sources of a command: with several, one that cannot be read is said, and the others get their answer."""

    def __init__(self, count: int) -> None:
        self._count = count
        self.code = 0

    @contextmanager
    def each(self) -> Iterator[None]:
        """Do what is to be done with one of them."""
        try:
            yield
        except SourceError as error:
            if self._count == 1:
                raise
            click.echo(f"flatgrasp: {error}", err=True)
            self.code = error.exit_code


def say_refusal(plan: Plan) -> None:
    """Say on stderr why a cloud has no grasp, and what would help."""
    from flatgrasp_cli.results.table import refusal

    for line in refusal(plan):
        click.echo(f"flatgrasp: {plan.cloud.source}: {line}", err=True)


def say_written(paths: list[Path]) -> None:
    """Say on stderr which files were written."""
    if len(paths) > NAMED:
        folder = f"{paths[0].parent}/" if paths[0].parent != Path() else "the current folder"
        said = f"{len(paths)} files to {folder}: {paths[0].name} … {paths[-1].name}"
    else:
        said = ", ".join(map(str, paths))
    if paths:
        click.echo(f"flatgrasp: wrote {in_utf8(said)}", err=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn an operating-system error while writing `path` into one that says what to do."""
    try:
        yield
    except OSError as error:
        raise UsageError(
            f"{path}: cannot be written: {error.strerror or error}; make room, or choose another folder with --out DIR"
        ) from error
