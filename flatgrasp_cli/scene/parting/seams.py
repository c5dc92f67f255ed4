"""Concave seams: where a surface bends toward the sensor, as it does where one thing rests on or against another."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray
from flatgrasp_cli.scene.parting.view_grid import REACH_CELLS, Step, ViewGrid, neighbours, shifted

LINES: tuple[Step, ...] = ((0, 1), (1, 0), (1, 1), (1, -1))


def seam_cells(grid: ViewGrid, normals: FloatArray, has_normal: BoolArray, seam_deg: float) -> BoolArray:
    """Cells (rows, columns) at which the surface has a concave bend of more than `seam_deg`.

    With normals n1, n2 at places x1, x2 on both sides, (n2 − n1) · (x2 − x1) / |x2 − x1| is 2 sin(β/2) for a bend by β,
    positive where the surface is convex.
    """
    places, sharpest = grid.places(), np.zeros(grid.known.shape)
    for line in LINES:
        ahead = (REACH_CELLS * line[0], REACH_CELLS * line[1])
        back = (-ahead[0], -ahead[1])
        both = grid.smooth_to(ahead) & grid.smooth_to(back)
        both &= shifted(has_normal, ahead) & shifted(has_normal, back)
        way = shifted(places, ahead) - shifted(places, back)
        turn = shifted(normals, ahead) - shifted(normals, back)
        length = np.maximum(np.sqrt((way**2).sum(axis=0)), 1e-9)
        sharpest = np.where(both, np.minimum(sharpest, (turn * way).sum(axis=0) / length), sharpest)
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
    """Unit normals (3, rows, columns) toward the sensor, by planes through 3 × 3 cells, and where there are any.

    A plane a·X = 1 has the inverse depth a·(x, y, 1) in the image, which is fitted by least squares.
    """
    inverse = np.where(grid.known, 1.0 / np.where(grid.known, grid.depth, 1.0), 0.0)
    x, y = np.where(grid.known, grid.x, 0.0), np.where(grid.known, grid.y, 0.0)
    values = np.stack([x, y, inverse])
    count, sums = grid.known.astype(np.float64), np.zeros((8, *grid.known.shape))
    for step in neighbours():
        seen = grid.smooth_to(step)
        count += seen
        du, dv, dw = off = (shifted(values, step) - values) * seen
        sums[:3] += off
        sums[3] += du * du
        sums[4:6] += dv * off[:2]
        sums[6:] += dw * off[:2]
    u, v, w, uu, uv, vv, uw, vw = sums
    count = np.maximum(count, 1.0)
    uu, uv, vv = uu - u * u / count, uv - u * v / count, vv - v * v / count
    uw, vw = uw - u * w / count, vw - v * w / count
    spread = uu * vv - uv * uv
    has_normal = grid.known & (count > len(values)) & (spread > 1e-3 * (uu + vv) ** 2)
    spread = np.where(has_normal, spread, 1.0)
    along_x, along_y = (uw * vv - vw * uv) / spread, (vw * uu - uw * uv) / spread
    level = inverse + (w - along_x * u - along_y * v) / count - along_x * x - along_y * y
    normals = -np.stack([along_x, along_y, level])
    length = np.maximum(np.sqrt((normals**2).sum(axis=0)), 1e-12)
    return normals / length, np.asarray(has_normal)
