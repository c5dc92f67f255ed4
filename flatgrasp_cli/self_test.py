"""Whether an installation works: it plans a grasp on a shape that it makes itself, and draws it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.planning import Plan, plan
from flatgrasp_cli.profiles import load_gripper
from flatgrasp_cli.results.document import to_document, to_json

SENSOR = np.array([0.0, 0.0, 0.6])
TABLE_M, BOX_M, STEP_M = 0.4, (0.12, 0.04, 0.03), 0.002
"""The side of a table, a box on it, and how far points lie apart."""
WIDTH_ERROR_M = 2 * STEP_M
"""By how much the width of a box may be found wrong: on either side its outline runs within a step."""


@dataclass(frozen=True, slots=True)
class Check:
    """What was tried, whether it went well, and what was found, or why not."""

    trial: str
    sound: bool
    found: str


def self_test() -> Iterator[Check]:
    """Try what every command needs, one after the other."""
    for trial, attempt in TRIALS.items():
        began = time.perf_counter()
        try:
            found = attempt()
        except Exception as error:  # noqa: BLE001 (whatever is broken is what was asked for)
            yield Check(trial, sound=False, found=f"{type(error).__name__}: {error}")
        else:
            yield Check(trial, sound=True, found=f"{found}, {1e3 * (time.perf_counter() - began):.0f} ms")


def _open3d() -> str:
    return f"version {load_open3d().__version__}"


@cache
def _plan() -> Plan:
    return plan(Cloud(_points(), SENSOR), load_gripper("pr2"))


def _points() -> FloatArray:
    """A box on a table as the sensor sees it, straight from above."""
    ticks = np.arange(-TABLE_M / 2, TABLE_M / 2, STEP_M)
    x, y = (side.ravel() for side in np.meshgrid(ticks, ticks))
    length, width, height = BOX_M
    share = SENSOR[2] / (SENSOR[2] - height)  # the box hides of the table what lies below it, as seen from there
    on_box, hidden = (np.maximum(abs(x) / length, abs(y) / width) <= 0.5 * size for size in (1, share))
    z = np.where(on_box, height, 0.0)
    return np.asarray(np.column_stack([x, y, z])[on_box | ~hidden])


def _grasp() -> str:
    best = _plan().best
    if best is None:
        raise RuntimeError(f"no grasp on a box: {_plan().reason}")
    if abs(best.width_m - BOX_M[1]) > WIDTH_ERROR_M:
        raise RuntimeError(f"a box {1e3 * BOX_M[1]:g} mm wide was taken for {1e3 * best.width_m:.1f} mm")
    return f"{1e3 * best.width_m:.1f} mm wide"


def _document() -> str:
    return f"{len(to_json(to_document(_plan())))} characters"


def _picture() -> str:
    from flatgrasp_cli.results.figures import as_png, final_figure

    picture = as_png(lambda: final_figure(_plan()))
    if picture is None:
        raise RuntimeError("nothing was drawn")
    return f"{len(picture)} bytes"


TRIALS: dict[str, Callable[[], str]] = {
    "Open3D loads": _open3d,
    "a grasp on a box is found": _grasp,
    "its document is written": _document,
    "its picture is drawn": _picture,
}
