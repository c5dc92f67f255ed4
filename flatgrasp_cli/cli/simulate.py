"""`flatgrasp simulate [OBJECT|MESH]…`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from flatgrasp_cli.cli.console import show
from flatgrasp_cli.cli.defaults import context_of
from flatgrasp_cli.cli.outputs import say_written, writing
from flatgrasp_cli.cli.progress import bar, on_terminal
from flatgrasp_cli.cli.shots import Shots, stem_of
from flatgrasp_cli.cli.simulation_options import simulation_options
from flatgrasp_cli.whole_files import write_bytes, write_text

if TYPE_CHECKING:
    from flatgrasp_cli.simulation.things import Thing
    from flatgrasp_cli.simulation.trial import Cell, Trial

NOT_HELD = 1


def _gif(_context: click.Context, _parameter: click.Parameter, path: Path | None) -> Path | None:
    if path is not None and path.suffix.lower() != ".gif":
        raise click.BadParameter(f"{path}: a film is a GIF; give FILE.gif")
    return path


@click.command("simulate", context_settings=context_of("simulate"))
@click.argument("objects", metavar="[OBJECT|MESH]…", nargs=-1)
@simulation_options
@click.option(
    "--out",
    "-o",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Folder for what the camera saw, as PCD, and for the documents of trials and plans.",
)
@click.option("--plots", is_flag=True, help="Draw a trial of each object as the paper's figure 18 does, as PNG.")
@click.option(
    "--film",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.gif",
    callback=_gif,
    help="Film the first trial of each object.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one document an attempt, a line each, and no table.")
def command(
    cell: Cell,
    things: list[Thing],
    trials: int,
    per_scene: int | None,
    out: Path | None,
    plots: bool,
    film: Path | None,
    as_json: bool,
) -> int:
    """Will this gripper hold these things? Simulated trials, as in the paper's section IV.

    An OBJECT is one of the paper's: teddy_bear, electric_drill, pistol, spray_bottle, pan (these five if none is
    named), hammer, juice_box; a MESH is an STL, OBJ, PLY, OFF or glTF file. Each trial puts one on a table, in a random
    stable pose, looks at it with a simulated Asus Xtion, plans as `flatgrasp plan` does, and lets the hand go to the
    best grasp, close, lift and shake. Needs MuJoCo: pip install 'flatgrasp[simulate]'.

    Exit code 0: all were held; 1: some were not, the table says why; 2: wrong usage or a wrong profile; 3: a mesh could
    not be read.
    """
    outputs, shots, done = _Outputs(out, cell, as_json=as_json), Shots(cell, out, film, plots=plots), []
    for trial in _watched(_trials(cell, things, trials, per_scene), None if per_scene else trials * len(things)):
        outputs.write(trial)
        done.append(shots.take(trial))
    shots.finish()
    if not as_json:
        _print_table(done)
    say_written(shots.written)
    if shots.code:
        return shots.code
    return 0 if all(trial.status == "held" for trial in done) else NOT_HELD


def _trials(cell: Cell, things: list[Thing], count: int, per_scene: int | None) -> Iterator[Trial]:
    from flatgrasp_cli.simulation.trials import heaps_of, trials_of

    if per_scene is not None:
        yield from heaps_of(cell, things, per_scene, count)
        return
    for thing in things:
        yield from trials_of(cell, thing, count)


def _watched(trials: Iterator[Trial], total: int | None) -> Iterator[Trial]:
    """The trials, with a bar on a terminal."""
    if not on_terminal():
        yield from trials
        return
    with bar(transient=True) as progress:
        task = progress.add_task("", total=total)
        for trial in trials:
            progress.update(task, advance=1, description=f"{trial.object}: {trial.status}")
            yield trial


class _Outputs:
    """Where the documents go: to stdout, and with the clouds into `folder`, if there is one."""

    def __init__(self, folder: Path | None, cell: Cell, *, as_json: bool) -> None:
        self._folder, self._cell, self._as_json = folder, cell, as_json
        self._lines: list[str] = []
        if folder is not None:
            with writing(folder):
                folder.mkdir(parents=True, exist_ok=True)

    def write(self, trial: Trial) -> None:
        """Write what there is to be written of a trial."""
        from flatgrasp_cli.results.document import to_document, to_json
        from flatgrasp_cli.simulation.document import trial_document

        stem = stem_of(trial)
        cloud = None if self._folder is None else f"{stem}.pcd"
        line = to_json(trial_document(trial, self._cell.conditions, cloud))
        if self._as_json:
            click.echo(line)
        if self._folder is None:
            return
        from flatgrasp_cli.results.pcd import organised_pcd

        self._lines.append(f"{line}\n")
        with writing(self._folder):
            write_bytes(self._folder / f"{stem}.pcd", organised_pcd(trial.image))
            write_text(self._folder / f"{stem}.grasps.json", [to_json(to_document(trial.plan), indent=2), "\n"])
            write_text(self._folder / "trials.jsonl", self._lines)


def _print_table(trials: list[Trial]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    from flatgrasp_cli.simulation.summary import row_of, rows_of

    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("object", overflow="fold")
    for heading in ("trials", "held", "clean", "no\ngrasp", "rate, %\n(95 %)"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("why lost", overflow="fold")
    rows = rows_of(trials)
    for row in [*rows, *([row_of("all", trials)] if len(rows) > 1 else [])]:
        low, high = row.interval
        why = "; ".join(text if count == 1 else f"{count} × {text}" for text, count in row.why)
        counts = (row.trials, row.held, row.clean, row.no_grasp)
        table.add_row(Text(row.object), *map(str, counts), f"{100 * low:.0f}–{100 * high:.0f}", Text(why))
    show(table)
