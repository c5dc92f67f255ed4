"""What lies on what: a thing that others lie on is grasped after them."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.scatter import median
from flatgrasp_cli.kernels.sorting import from_above
from flatgrasp_cli.model import Floor
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.support_plane import GOOD_PART


def least_drop_m(settings: SceneSettings) -> float:
    """How much lower what a thing lies on is than the thing, metres, at least: by half of the least object."""
    return 0.5 * settings.min_size_m


def supported_by(
    points: FloatArray, members: tuple[IntArray, ...], floor: Floor, drop_m: float
) -> tuple[tuple[int, ...], ...]:
    """For each of the `members`, indices of `points` (n, 3), the numbers of those that lie on it.

    Seen from above, a thing is surrounded by the one that it lies on, and that is lower there, by at least `drop_m`,
    than most of what was seen of the thing.
    """
    if len(members) < 2:
        return ((),) * len(members)
    owner, height = _from_above(points, members, floor)
    below: list[tuple[int, ...]] = [() for _ in members]
    for name in range(len(members)):
        mine = owner == name
        if mine.any() and (under := _under(mine, owner, height, drop_m)) is not None:
            below[under] = (*below[under], name)
    return tuple(below)


def _from_above(points: FloatArray, members: tuple[IntArray, ...], floor: Floor) -> tuple[IntArray, FloatArray]:
    """Which member each cell (rows, columns) of the floor shows from above, their number where none, and how high."""
    raster = floor.levels.raster
    rows = np.concatenate(members)
    names = np.repeat(np.arange(len(members)), [len(own) for own in members])
    x, y, z = floor.frame.to_local(points.take(rows, axis=0)).T
    cell = raster.cells(x, y)
    owner, height = np.full(raster.size, len(members)), np.full(raster.size, -np.inf)
    from_above(cell, np.ascontiguousarray(z), names, owner, height)
    return owner.reshape(raster.shape), height.reshape(raster.shape)


def _under(mine: BoolArray, owner: IntArray, height: FloatArray, drop_m: float) -> int | None:
    """The member that the one whose cells are `mine` lies on."""
    reach = 2  # the cells beside a thing may hold points of both
    rows, columns = np.flatnonzero(mine.any(axis=1)), np.flatnonzero(mine.any(axis=0))
    box = tuple(slice(max(0, ends[0] - reach), ends[-1] + reach + 1) for ends in (rows, columns))
    mine, owner, height = mine[box], owner[box], height[box]
    size = 2 * reach + 1
    ring = (cv2.dilate(mine.view(np.uint8), np.ones((size, size), np.uint8)) > 0) & ~mine
    lower = ring & np.isfinite(height) & (height < median(height[mine]) - drop_m)
    if not lower.any():
        return None
    counts = np.bincount(owner[lower])
    under = int(counts.argmax())
    return under if counts[under] >= GOOD_PART * np.count_nonzero(ring) else None
