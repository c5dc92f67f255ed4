"""Concave seams: where a surface bends toward the sensor, as it does where one thing rests on or against another."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray
from flatgrasp_cli.kernels import view as kernels
from flatgrasp_cli.scene.parting.view_grid import REACH_CELLS, Step, ViewGrid, shifted

LINES: tuple[Step, ...] = ((0, 1), (1, 0), (1, 1), (1, -1))


def seam_cells(grid: ViewGrid, normals: FloatArray, has_normal: BoolArray, seam_deg: float) -> BoolArray:
    """Cells (rows, columns) at which the surface has a concave bend of more than `seam_deg`.

    With normals n1, n2 at places x1, x2 on both sides, (n2 − n1) · (x2 − x1) / |x2 − x1| is 2 sin(β/2) for a bend by β,
    positive where the surface is convex.
    """
    sharpest = kernels.sharpest_bends(
        grid.places(), normals, has_normal.view(np.uint8), grid.depth, grid.jump_m, REACH_CELLS
    )
    return np.asarray(sharpest < -2 * np.sin(np.radians(0.5 * seam_deg)))


def color_seam_cells(grid: ViewGrid, colors: ByteArray, least: float) -> BoolArray:
    """Cells (rows, columns) beside which a smooth surface has `colors` (n, 3) that differ by more than `least`.

    They are told by a and b of CIE Lab, without the lightness: shadows make no seams.
    """
    lab = cv2.cvtColor((colors[None] / 255.0).astype(np.float32), cv2.COLOR_RGB2Lab)[0]
    count = np.maximum(np.bincount(grid.cell, minlength=grid.known.size), 1)
    a, b = (np.bincount(grid.cell, weights=lab[:, k], minlength=count.size) / count for k in (1, 2))
    hue = np.stack([a, b]).reshape(2, *grid.known.shape)
    found = np.zeros(grid.known.shape, dtype=np.bool_)
    for line in LINES:
        ahead = (REACH_CELLS * line[0], REACH_CELLS * line[1])
        back = (-ahead[0], -ahead[1])
        both = grid.known & grid.smooth_to(ahead) & grid.smooth_to(back)
        found |= both & (np.hypot(*(shifted(hue, ahead) - shifted(hue, back))) > least)
    return found


def surface_normals(grid: ViewGrid) -> tuple[FloatArray, BoolArray]:
    """Unit normals (3, rows, columns) toward the sensor, by planes through 3 × 3 cells, and where there are any."""
    normals = kernels.normals(grid.x, grid.y, grid.depth, grid.jump_m, 3)  # besides its own, three places make a plane
    return normals, np.asarray(normals.any(axis=0))
