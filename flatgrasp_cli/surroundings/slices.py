"""Beyond the paper: what stands above the fingertips, level by level.

The paper projects the whole object. Over a table the fingers reach down only so far, and in a heap only what stands out
can be gripped. So the method runs on the silhouette of what lies above each of several levels, and the best grasp wins.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.kernels.pieces import standing_out
from flatgrasp_cli.profiles.settings import DepthSettings

SAME_FOOTPRINT = 0.93
"""A part whose footprint is larger than this share of what it stands on needs no silhouette of its own: a rim of one
cell around a block of 10 cm is 8 % of it."""
MOST_ALIKE = 2
"""Largest number of slices with about the same footprint. It is more than one because close above what a part lies on,
its flanks do not look upright yet."""
MIN_POINTS = 30
"""Least number of points of an object, and of a part of it: with fewer, a silhouette is mostly noise."""
TOP_QUANTILE = 0.99
"""The share of an object's points that lie below its top: the others may be flying pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class Slice:
    """A connected part of an object above `level_m`: indices of its points."""

    level_m: float
    rows: IntArray


def top_of(heights: FloatArray) -> float:
    """How high an object reaches, metres, apart from single high points."""
    place = round(TOP_QUANTILE * (len(heights) - 1))
    return float(np.partition(heights, place)[place])


def lowest_tip(tops: FloatArray | float, settings: DepthSettings) -> FloatArray:
    """How low fingertips may go beside what is `tops` (…) high: the clearance, or less beside what is hardly higher.

    A hand that comes the clearance too high still holds a pen below its middle, where that is widest.
    """
    below_middle = 0.5 * np.asarray(tops) - settings.table_clearance_m
    return np.clip(below_middle, settings.min_clearance_m, settings.table_clearance_m)


def slices(local: FloatArray, cell_m: float, settings: DepthSettings) -> Iterator[Slice]:
    """Its pieces, if an object is several, then the parts of it that stand out, from the lowest level on.

    Z of `local` (n, 3) is the height over the plane. Pieces lie apart where what joins them was hidden, as a handle's
    foot behind a bowl; a silhouette is that of the largest.
    """
    top = top_of(local[:, 2])
    lowest = float(lowest_tip(top, settings))
    chart = HeightMap.of(local, cell_m)
    cell_of = chart.raster.cells(local[:, 0], local[:, 1])
    # for each cell: how many cells the last slice that it was in has, and how many slices had about so many
    below = np.full(chart.heights.shape, np.count_nonzero(np.isfinite(chart.heights)))
    taken = np.full(chart.heights.shape, MOST_ALIKE)
    levels = np.arange(lowest + settings.slice_step_m, top - settings.min_grip_m, settings.slice_step_m)
    for level in (-np.inf, *levels):
        _, labels, boxes, _ = cv2.connectedComponentsWithStats((chart.heights > level).view(np.uint8), connectivity=8)
        piece, points = standing_out(local, cell_of, labels.ravel(), level, len(boxes))
        pieces = 1 + np.flatnonzero(points[1:] >= MIN_POINTS)
        if level < lowest and len(pieces) < 2:
            continue  # the whole, in one piece
        for name in pieces.tolist():
            left, upper, width, height, footprint = boxes[name].tolist()
            box = slice(upper, upper + height), slice(left, left + width)
            part = labels[box] == name
            alike = footprint >= SAME_FOOTPRINT * below[box][part].min()
            if alike and taken[box][part].min() >= MOST_ALIKE:
                continue
            taken[box][part] = taken[box][part] + 1 if alike else 1
            below[box][part] = footprint
            yield Slice(max(float(level), lowest), np.flatnonzero(piece == name))
