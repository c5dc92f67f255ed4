"""The pictures that are drawn whenever the documentation is built, and so are never older than the program."""

from __future__ import annotations

from pathlib import Path

import flow

from flatgrasp_cli import load_gripper, plan, read_clouds
from flatgrasp_cli.results.figures import as_png, stage_figures
from flatgrasp_cli.whole_files import write_bytes

SAMPLE = Path(__file__).resolve().parents[2] / "sample_data" / "teddy_bear.pcd"


def draw_all(folder: Path) -> None:
    """Draw the flow of data, and each stage of the method on the paper's teddy bear, as `folder`/STAGE.png."""
    folder.mkdir(exist_ok=True)
    (folder / "flow.svg").write_text(flow.svg(), encoding="utf-8")
    cloud = next(iter(read_clouds(str(SAMPLE))))
    for numbered, draw in stage_figures(plan(cloud, load_gripper("lacquey"))):
        content = as_png(draw)
        if content is not None:
            write_bytes(folder / f"{numbered.partition('_')[2]}.png", content)
