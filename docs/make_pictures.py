"""Makes the pictures in docs/: `python docs/make_pictures.py [NAME…]`, all of them without a name.

Names: frames, teddy_bear, table_scene, robot, pan_cage, trial. frame_rate.png is made by benchmarks/frame_rate.py,
which needs a quiet machine. `drawn.json` keeps what each picture shows, and a test compares that with what the program
draws; but for trial's, which is simulated.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import drawn

from flatgrasp_cli import load_gripper
from flatgrasp_cli.cli import cli
from flatgrasp_cli.results.figures import as_png
from flatgrasp_cli.results.figures.frames import frames_figure
from flatgrasp_cli.whole_files import write_bytes

FOLDER = Path(__file__).resolve().parent
SAMPLES = FOLDER.parent / "sample_data"
LEVEL = "0,-0.05,0.7,0.9406,0,0,-0.3395"
"""A camera pose that brings the table scene level before an arm."""


def frames() -> None:
    """frames.png: the fingertips' frame and the flange's."""
    content = as_png(lambda: frames_figure(load_gripper("robotiq_2f_85"), opening_m=0.080, width_m=0.040))
    write_bytes(FOLDER / "frames.png", content or b"")


def teddy_bear() -> None:
    """teddy_bear.grasps.png: the first picture that a newcomer makes."""
    _of_command("plan", "teddy_bear", "grasps")


def table_scene() -> None:
    """table_scene.grasps.png: several objects on a table."""
    _of_command("plan", "table_scene", "grasps", "--gripper", "pr2")


def robot() -> None:
    """robot.grasps.png: the same before an arm."""
    options = ("--gripper", "robotiq_2f_85", "--robot", "ur5e", f"--camera-pose={LEVEL}")
    _of_command("plan", "table_scene", "grasps", *options, saved_as="robot.grasps.png")


def pan_cage() -> None:
    """pan.cage.png: the cage of a pan's handle."""
    _of_command("cage", "pan", "0.cage", saved_as="pan.cage.png")


def trial() -> None:
    """teddy_bear.trial.png: a simulated trial; physics may end a little otherwise on another machine."""
    with TemporaryDirectory() as out, redirect_stdout(io.StringIO()):
        options = ["--trials", "1", "--plots", "--force", "40", "--out", out]
        cli.main(["simulate", "teddy_bear", *options], standalone_mode=False)
        write_bytes(FOLDER / "teddy_bear.trial.png", (Path(out) / "teddy_bear.00.trial.png").read_bytes())


def _of_command(command: str, sample: str, kind: str, *options: str, saved_as: str | None = None) -> None:
    """Keep the picture of a kind that a command draws of a sample."""
    with TemporaryDirectory() as out:
        source = SAMPLES / f"{sample}.pcd"
        with redirect_stdout(io.StringIO()):
            cli.main([command, str(source), *options, "--out", out], standalone_mode=False)
        write_bytes(FOLDER / (saved_as or f"{sample}.{kind}.png"), (Path(out) / f"{sample}.{kind}.png").read_bytes())


PICTURES: dict[str, Callable[[], None]] = {
    draw.__name__: draw for draw in (frames, teddy_bear, table_scene, robot, pan_cage)
}
SIMULATED: dict[str, Callable[[], None]] = {"trial": trial}
"""Pictures of which no record is kept."""


if __name__ == "__main__":
    names = sys.argv[1:] or [*PICTURES, *SIMULATED]
    with drawn.recorded() as found:
        for name in names:
            if name not in SIMULATED:
                PICTURES[name]()
    drawn.keep(FOLDER, found)
    for name in names:
        if name in SIMULATED:
            SIMULATED[name]()
