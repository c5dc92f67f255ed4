"""Grasps that differ: a second choice next to the first is none for a robot that cannot get there."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flatgrasp_cli.geometry.polygon import cross
from flatgrasp_cli.model import GraspCandidates
from flatgrasp_cli.profiles.settings import VarietySettings


def differing(grasps: GraspCandidates, rows: Iterable[int], settings: VarietySettings, most: int) -> list[int]:
    """The first `most` of `rows`, best first, without those that are like an earlier one in place and angle.

    Non-maximum suppression: two grasps are alike if their hands are nearer than `apart_m` and their closing axes, taken
    either way, less than `apart_deg` from parallel.
    """
    center, axis = grasps.center, grasps.axis
    turned = np.sin(np.radians(settings.apart_deg))
    left, kept = np.fromiter(rows, dtype=np.intp), list[int]()
    while len(left) > 0 and len(kept) < most:
        best = int(left[0])
        kept.append(best)
        near = np.linalg.norm(center[left] - center[best], axis=1) < settings.apart_m
        alike = near & (np.abs(cross(axis[left], axis[best])) < turned)
        alike[0] = True
        left = left[~alike]
    return kept
