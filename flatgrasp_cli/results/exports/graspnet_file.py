"""A GraspGroup of graspnetAPI: an array (n, 17) that `GraspGroup().from_npy` reads.

A row is score, width, height, depth, rotation (9, row by row), translation (3), object. Its hand approaches along x and
closes along y; the fingertips are `depth` beyond the translation.
"""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.results.saved import SavedDocument, SavedGrasp

COLUMNS = 17
DEPTH_M = 0.02
"""From a grasp's translation to its fingertips, metres: one of the four depths that GraspNet's own labels have."""


def content(documents: Sequence[SavedDocument]) -> bytes:
    """The file of one frame."""
    (document,) = documents
    rows = [_row(grasp, item.id, document.gripper.finger_width_m) for item, grasp in document.grasps]
    file = io.BytesIO()
    np.save(file, np.array(rows, dtype=np.float64).reshape(-1, COLUMNS))
    return file.getvalue()


def _row(grasp: SavedGrasp, thing: int, finger_width_m: float) -> FloatArray:
    tips = grasp.pose.pose
    x, y, z = axes_from_quaternion(tips.orientation)
    turn = np.column_stack([z, y, -x])
    place = tips.position - DEPTH_M * z
    return np.hstack([grasp.score, grasp.opening_m, finger_width_m, DEPTH_M, turn.ravel(), place, thing])
