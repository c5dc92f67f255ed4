"""Grasps that differ: a second choice next to the first is none for a robot that cannot get there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flatgrasp_cli.geometry.arrays import IntArray
from flatgrasp_cli.kernels import variety
from flatgrasp_cli.model import GraspCandidates
from flatgrasp_cli.profiles.settings import VarietySettings


def differing(
    grasps: GraspCandidates, rows: Sequence[int] | IntArray, settings: VarietySettings, most: int
) -> list[int]:
    """The first `most` of `rows`, best first, without those that are like an earlier one in place and angle.

    Non-maximum suppression: two grasps are alike if their hands are nearer than `apart_m` and their closing axes, taken
    either way, less than `apart_deg` from parallel.
    """
    turned = float(np.sin(np.radians(settings.apart_deg)))
    order = np.array(rows, dtype=np.intp)
    kept: list[int] = variety.differing(grasps.center, grasps.axis, order, settings.apart_m, turned, most).tolist()
    return kept
