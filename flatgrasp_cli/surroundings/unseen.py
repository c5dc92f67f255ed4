"""Beyond the paper: what of an object that stands on a plane was hidden, as far as hands that come aslant may meet it.

What was hidden straight below its rim is taken to belong to the object, as a hand from straight above takes for
granted. A surface that rises up to its rim, as that of a cone or a tent does, has another side that falls: it is taken
for the mirror image of the side that was seen (Bohg et al., "Mind the gap: robotic grasping under incomplete
observation", ICRA 2011), as far as it was hidden.
"""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray, true_entries
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.surroundings.sight import FAR_M
from flatgrasp_cli.surroundings.walls import LEAST_SLOPE


def below_rim(local: FloatArray, cell_m: float) -> FloatArray:
    """Points (k, 3) straight below the rim of an object with points `local` (n, 3) over a plane, a cell apart."""
    chart = HeightMap.of(local, cell_m)
    raster = chart.raster
    cell = raster.cells(local[:, 0], local[:, 1])
    seen = (raster.count(cell) > 0).view(np.uint8)
    rim = (seen > 0) & (cv2.erode(seen, np.ones((3, 3), np.uint8)) == 0)
    order = np.argsort(-local[:, 2], kind="stable")
    _, first = np.unique(cell[order], return_index=True)
    tops = local[order[first]]  # the highest point of each cell
    return _columns(tops[rim.take(cell[order[first]])], cell_m)


def behind_ridges(local: FloatArray, viewpoint: FloatArray, cell_m: float, noise_m: float) -> FloatArray:
    """Points (k, 3) of the sides behind ridges and peaks of an object with points `local` (n, 3), a cell apart.

    Seen from `viewpoint` (3,), the surface rises up to them, and the side behind is the mirror image of it: along each
    line of sight in the plane it is as high as the highest that was seen as far before the ridge, or farther.
    """
    size_m = float(np.hypot(*np.ptp(local[:, :2], axis=0)))
    chart = HeightMap.around(local, cell_m, 0.5 * size_m).raised(local)
    row, column = true_entries(chart.heights == UNSEEN)
    places = chart.raster.middles(row, column)
    ray = viewpoint[:2] - places
    way = ray / np.maximum(np.linalg.norm(ray, axis=1), cell_m)[:, None]
    steps = cell_m * np.arange(int(1.5 * size_m / cell_m) + 2)
    heights = chart.over(*(places[:, None, k] + steps * way[:, None, k] for k in (0, 1)))
    gap = np.argmax(heights > UNSEEN, axis=1)
    hides = np.flatnonzero(heights[np.arange(len(gap)), gap] > UNSEEN)
    places, heights, gap = places[hides], heights[hides], gap[hides]
    shifted = gap[:, None] + np.arange(len(steps))
    seen = np.where(
        shifted < len(steps), np.take_along_axis(heights, np.minimum(shifted, len(steps) - 1), axis=1), UNSEEN
    )
    limb = int(0.5 * FAR_M / cell_m)
    peak = np.argmax(seen, axis=1)
    before = np.take_along_axis(seen, np.minimum(peak + limb, len(steps) - 1)[:, None], axis=1)[:, 0]
    top = np.take_along_axis(seen, peak[:, None], axis=1)[:, 0]
    rises = top - before > LEAST_SLOPE * limb * cell_m
    places, seen, gap = places[rises], seen[rises], gap[rises]
    crest = np.maximum.accumulate(seen[:, ::-1], axis=1)[:, ::-1]
    own = (crest >= seen[:, :1] - noise_m).sum(axis=1) - 1
    mirrored = own + gap
    inside = mirrored < len(steps)
    height = crest[np.arange(len(own)), np.minimum(mirrored, len(steps) - 1)]
    found = np.flatnonzero(inside & (height > 0))
    filled = np.zeros(chart.raster.shape, dtype=np.uint8)
    cell = chart.raster.cells(*places[found].T)
    filled.reshape(-1)[cell] = 1
    wide = limb | 1
    broad = cv2.morphologyEx(filled, cv2.MORPH_OPEN, np.ones((wide, wide), np.uint8)).take(cell) > 0
    return _columns(np.column_stack([places, height])[found[broad]], cell_m)


def _columns(tops: FloatArray, cell_m: float) -> FloatArray:
    """Points (k, 3) from the plane up to each of the `tops` (n, 3), so far apart."""
    levels = np.arange(0.0, float(tops[:, 2].max(initial=0.0)), cell_m)
    place, level = true_entries(levels < tops[:, 2:])
    return np.column_stack([tops[place, :2], levels[level]])
