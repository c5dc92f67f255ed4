"""Makes the pictures in docs/: `python docs/make_pictures.py [NAME…]`, all of them without a name.

Names: frames
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from flatgrasp_cli import load_gripper
from flatgrasp_cli.results.figures import as_png
from flatgrasp_cli.results.figures.frames import frames_figure
from flatgrasp_cli.whole_files import write_bytes

FOLDER = Path(__file__).resolve().parent


def frames() -> None:
    """frames.png: the fingertips' frame and the flange's."""
    content = as_png(lambda: frames_figure(load_gripper("robotiq_2f_85"), opening_m=0.080, width_m=0.040))
    write_bytes(FOLDER / "frames.png", content or b"")


PICTURES: dict[str, Callable[[], None]] = {"frames": frames}


if __name__ == "__main__":
    for name in sys.argv[1:] or PICTURES:
        PICTURES[name]()
