"""Bins, trays and boxes: what would hold water, and is too wide to be a bowl that a hand carries."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray, IntArray, true_entries
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import UNSEEN
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.kernels.flood import from_nearest
from flatgrasp_cli.model import Floor
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.support_plane import GOOD_PART

GAP_M = 0.04
"""Gaps that a sensor leaves in steep walls: these are as wide, at most, in real frames of bins."""
LEAST_WIDE_M, LEAST_STATED_M = 0.25, 0.1
"""Least width of a pool in a container: plates and pans have up to 0.22 m; less where somebody says that it is one."""
OUTSIDE = 2
"""What cells hold that water runs out of; others hold 1 if they are low, and 0."""
WALL_FOOT_M = 0.02
"""A finger finds no place between the wall and something so near to it."""


@dataclass(frozen=True, slots=True, eq=False)
class Container:
    """A bin in cells (rows, columns) of the `raster` of a support plane's `frame`: its `ground`, and what lies in it.

    `inside` is what lies away from its walls; these are `walls`, and their rims are `rim_m` high. They go down from
    what was seen of them in points `step_m` apart: no finger passes between them.
    """

    frame: Frame
    raster: Raster
    ground: BoolArray
    inside: BoolArray
    walls: BoolArray
    rim_m: float
    step_m: float

    def covers(self, points: FloatArray) -> BoolArray:
        """Which of `points` (n, 3) belong to the bin or lie in it."""
        x, y, _ = self.frame.to_local(points).T
        return np.asarray(self.ground.take(self.raster.cells(x, y)))

    def holds(self, points: FloatArray) -> BoolArray:
        """Which of `points` (n, 3) lie over the inside, away from the walls."""
        x, y, _ = self.frame.to_local(points).T
        return np.asarray(self.inside.take(self.raster.cells(x, y)))

    def has_in_walls(self, points: FloatArray) -> BoolArray:
        """Which of `points` (n, 3) lie where the walls stand, below their rims: these are the walls'."""
        x, y, height = self.frame.to_local(points).T
        return np.asarray(self.walls.take(self.raster.cells(x, y)) & (height < self.rim_m))

    def solid(self, points: FloatArray) -> FloatArray:
        """Points (k, 3) that fill walls from the highest of the `points` (n, 3) that were seen of them to the floor.

        The outer faces of walls are hidden behind their rims.
        """
        x, y, height = self.frame.to_local(points).T
        top = np.full(self.raster.size, -np.inf)
        np.maximum.at(top, self.raster.cells(x, y), height)
        row, column = true_entries(top.reshape(self.raster.shape) > self.step_m)
        places = self.raster.middles(row, column)
        tops = top.reshape(self.raster.shape)[row, column]
        levels = np.arange(0.0, float(tops.max(initial=0.0)), self.step_m)
        place, level = true_entries(levels < tops[:, None])
        return self.frame.to_world(np.column_stack([places[place], levels[level]]))


def find_container(points: FloatArray, floor: Floor, settings: SceneSettings) -> Container | None:
    """The container whose walls rise around what lies deeper; None if there is none.

    `points` (n, 3) stand on the `floor`; in mode `bin` somebody knows that there is one. Water is poured in, as high as
    the least object and then twice as high each time: low rims keep a hand out of things, and things hide the floor
    between higher ones. It runs out over the picture's edge, and in cells that were not seen it stands as in the
    nearest one that was. Of the rectangle around a container's pools it covers a good part: pockets of a heap are far
    apart.
    """
    least_m = LEAST_STATED_M if settings.mode == "bin" else LEAST_WIDE_M
    x, y, height = floor.frame.to_local(points).T
    if len(points) == 0 or min(np.ptp(x), np.ptp(y)) < least_m:
        return None
    raster = floor.levels.raster
    means = raster.rimmed(raster.mean(x, y, height, UNSEEN), UNSEEN)
    filled = _filled(np.where(means > UNSEEN, means, floor.levels.heights))
    level, highest = 0.5 * settings.min_size_m, float(filled.max())
    while (level := 2 * level) < highest:
        outside, pools = _poured(~_closed(filled >= level, GAP_M / raster.cell_m))
        if not pools.any():
            continue
        # a container is the ground that no water from outside reaches, walls and things and pools alike
        grounds = _connected(~outside)
        for ground in np.flatnonzero(np.bincount(grounds[pools])).tolist():
            pool = pools & (grounds == ground)
            inside = _rectangle(pool, least_m / raster.cell_m)
            if inside is not None and np.count_nonzero(pool) >= GOOD_PART * np.count_nonzero(inside):
                rim_m = float(np.median(filled[(grounds == ground) & ~inside & (filled >= level)]))
                return _container(floor, grounds == ground, inside, rim_m, settings.min_size_m)
    return None


def _container(floor: Floor, ground: BoolArray, inside: BoolArray, rim_m: float, step_m: float) -> Container:
    """The container on a `ground`, with the rectangle `inside` its walls, (rows, columns) each."""
    raster = floor.levels.raster
    return Container(
        frame=floor.frame,
        raster=raster,
        ground=ground,
        inside=_shrunk(inside, WALL_FOOT_M / raster.cell_m),
        walls=ground & ~inside,
        rim_m=rim_m,
        step_m=step_m,
    )


def _filled(heights: FloatArray) -> FloatArray:
    """`heights` (rows, columns) with that of the nearest seen cell in all that were not seen."""
    unseen = (heights == UNSEEN).view(np.uint8)
    _, nearest = cv2.distanceTransformWithLabels(unseen, cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL)
    found: FloatArray = from_nearest(heights, nearest, unseen)
    return found


def _closed(walls: BoolArray, gap: float) -> BoolArray:
    """Walls (rows, columns) without gaps that are no more than so many cells wide."""
    width = 2 * round(0.5 * gap) + 1
    padded = cv2.copyMakeBorder(walls.view(np.uint8), width, width, width, width, cv2.BORDER_CONSTANT, value=[0])
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, np.ones((width, width), np.uint8))
    return np.asarray(closed[width:-width, width:-width] > 0)


def _poured(low: BoolArray) -> tuple[BoolArray, BoolArray]:
    """The cells (rows, columns) under water that runs out over the edge, and those under water that stands."""
    around = cv2.copyMakeBorder(low.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=[1])
    cv2.floodFill(around, None, (0, 0), [OUTSIDE], flags=4)  # which takes a third of the time of naming all pools
    inner = around[1:-1, 1:-1]
    return np.asarray(inner == OUTSIDE), np.asarray(inner == 1)


def _shrunk(mask: BoolArray, cells: float) -> BoolArray:
    """A mask without the cells so near to its edge."""
    width = 2 * round(cells) + 1
    return np.asarray(cv2.erode(mask.view(np.uint8), np.ones((width, width), np.uint8)) > 0)


def _connected(mask: BoolArray) -> IntArray:
    """Names (rows, columns) from 1 of the connected pieces of a mask."""
    return np.asarray(cv2.connectedComponents(mask.view(np.uint8), connectivity=8)[1], dtype=np.intp)


def _rectangle(pool: BoolArray, least: float) -> BoolArray | None:
    """The cells of the smallest rectangle around a pool; None if it is narrower than `least` cells."""
    places = np.argwhere(pool)[:, ::-1].astype(np.float32)  # OpenCV's x is the column
    middle, sides, turn = cv2.minAreaRect(places)
    if min(sides) < least:
        return None
    inside: ByteArray = np.zeros(pool.shape, dtype=np.uint8)
    corners = cv2.boxPoints((middle, sides, turn))
    cv2.fillConvexPoly(inside, np.round(corners).astype(np.int32), 1)
    return inside > 0
