"""Beyond the paper: what stands above the fingertips, level by level.

The paper projects the whole object. Over a table the fingers reach only so far down, and in a heap only what stands out
can be gripped: so the method runs on the outline of what lies above each of several levels, and the best grasp wins.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.profiles.settings import DepthSettings

SAME_FOOTPRINT = 0.93
"""A part whose footprint has this share of what it stands on needs no outline of its own."""
MOST_ALIKE = 2
"""Slices of about one footprint: close above what it lies on, a part's flanks do not look upright yet."""
MIN_POINTS = 30
TOP_QUANTILE = 0.99


@dataclass(frozen=True, slots=True, eq=False)
class Slice:
    """A connected part of an object above `level_m`: indices of its points."""

    level_m: float
    rows: IntArray


def top_of(heights: FloatArray) -> float:
    """How high an object reaches, single high points aside."""
    place = round(TOP_QUANTILE * (len(heights) - 1))
    return float(np.partition(heights, place)[place])


def lowest_tip(tops: FloatArray | float, settings: DepthSettings) -> FloatArray:
    """How low fingertips may go beside what is `tops` (…) high: the clearance, less where that is hardly higher."""
    share = np.maximum(settings.min_clearance_m, np.multiply(tops, settings.low_object_share))
    return np.asarray(np.minimum(settings.table_clearance_m, share))


def slices(local: FloatArray, cell_m: float, settings: DepthSettings) -> list[Slice]:
    """The whole object, and the parts of it that stand out; `local` (n, 3) has heights over the plane as z."""
    top = top_of(local[:, 2])
    lowest = float(lowest_tip(top, settings))
    found = [Slice(lowest, np.arange(len(local)))]
    chart = HeightMap.of(local, cell_m)
    cell_of = chart.raster.cells(local[:, 0], local[:, 1])
    below = np.full(chart.heights.shape, np.count_nonzero(np.isfinite(chart.heights)))  # footprint that cells belong to
    taken = np.full(chart.heights.shape, MOST_ALIKE)  # slices with about that footprint
    for level in np.arange(lowest + settings.slice_step_m, top - settings.min_grip_m, settings.slice_step_m):
        _, labels, boxes, _ = cv2.connectedComponentsWithStats((chart.heights > level).view(np.uint8), connectivity=8)
        piece = np.where(local[:, 2] > level, labels.ravel()[cell_of], 0)
        points = np.bincount(piece, minlength=len(boxes))
        for name in (1 + np.flatnonzero(points[1:] >= MIN_POINTS)).tolist():
            left, upper, width, height, footprint = boxes[name].tolist()
            box = slice(upper, upper + height), slice(left, left + width)
            part = labels[box] == name
            alike = footprint >= SAME_FOOTPRINT * below[box][part].min()
            if alike and taken[box][part].min() >= MOST_ALIKE:
                continue
            taken[box][part] = taken[box][part] + 1 if alike else 1
            below[box][part] = footprint
            found.append(Slice(float(level), np.flatnonzero(piece == name)))
    return found
