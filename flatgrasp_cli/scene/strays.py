"""Single points that belong to nothing: flying pixels, reflections, wrong numbers. They must not decide anything."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.extents import bounds_of
from flatgrasp_cli.geometry.raster import MAX_CELLS
from flatgrasp_cli.geometry.sampling import GOLDEN
from flatgrasp_cli.kernels import points as kernels
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.scene.support_plane import FINE_SAMPLE, REACH_M

TAIL_SHARE = 0.01
"""Share of a cloud's points, at either end of each axis, that may lie outside of the bulk."""
MANY = 3
"""So many points in a block of 3 × 3 × 3 cells are no strays: flying pixels come one by one or in pairs. And a place
that a sample holds more often is a repeated one: in millimetre steps two points may coincide, hardly four. So many
places that are there again tell of a cloud that holds each of its points several times."""


def without_far_strays(cloud: Cloud) -> Cloud:
    """The cloud without the points that lie farther from its bulk than the bulk is large, and farther than a metre.

    Objects stand within the bulk. With the strays, extents, rasters and range images would be mostly empty.
    """
    if len(cloud.points) == 0:
        return cloud
    columns = cloud.sample(FINE_SAMPLE).T
    tail = int(TAIL_SHARE * columns.shape[1])
    if _reaches_all(columns, tail, cloud.measured.corners):
        return cloud
    last = columns.shape[1] - 1 - tail
    low, high = (np.partition(columns, end, axis=1)[:, end] for end in (tail, last))
    margin = max(REACH_M, float(np.linalg.norm(high - low)))
    outside = kernels.outside(cloud.points, low - margin, high + margin)
    return cloud.without(outside) if len(outside) else cloud


def _reaches_all(columns: FloatArray, tail: int, corners: FloatArray) -> bool:
    """Whether more than a `tail` of a sample, columns (3, n), are within a metre of each side of the box around all.

    Then the bulk begins within a metre of it, and no point lies farther out.
    """
    return all(
        np.count_nonzero(own <= low + REACH_M) > tail < np.count_nonzero(own >= high - REACH_M)
        for own, low, high in zip(columns, *corners.tolist(), strict=True)
    )


def without_repeats(cloud: Cloud) -> Cloud:
    """The cloud with a single one of each point that it holds again and again.

    No sensor measures the same place repeatedly to the last digit. Such points are invalid ones, moved to the sensor's
    place or another by a transform, or copies that pad a cloud to a fixed length; or a frame was stored several times.
    """
    if _is_copied(cloud):
        _, first = np.unique(cloud.points, axis=0, return_index=True)
        return cloud.without(np.setdiff1d(np.arange(len(cloud.points)), first))
    sample = cloud.sample(FINE_SAMPLE)
    x, y, z = sample.T
    mixed = (x + GOLDEN * (y + GOLDEN * z)).astype(np.float32)  # the same for the same place, and hardly for another
    along = np.sort(mixed)
    repeated = along[MANY:][along[MANY:] == along[:-MANY]]
    if len(repeated) == 0:
        return cloud
    places, counts = np.unique(sample[np.isin(mixed, repeated)], axis=0, return_counts=True)
    again = [np.flatnonzero((cloud.points == place).all(axis=1))[1:] for place in places[counts > MANY]]
    return cloud.without(np.concatenate(again)) if again else cloud


def _is_copied(cloud: Cloud) -> bool:
    """Whether a cloud holds its points several times each; pixels of an image lie on different rays."""
    if cloud.pixels is not None or len(cloud.points) == 0:
        return False
    alike = (cloud.points.take(np.flatnonzero(cloud.points[:, 0] == x), axis=0) for x in cloud.sample(MANY)[:, 0])
    return all(len(points) > len(np.unique(points, axis=0)) for points in alike)


def lonely(points: FloatArray, cell_m: float) -> BoolArray:
    """Which of `points` (n, 3) have fewer than two others in the cells around them: cubes of side `cell_m`."""
    if len(points) == 0:
        return np.zeros(0, dtype=np.bool_)
    low, high = bounds_of(points)
    cell_m = max(cell_m, float(np.prod((high - low) + cell_m) / MAX_CELLS) ** (1 / 3))
    shape = ((high - low) / cell_m).astype(np.intp) + 3  # a rim, so that no neighbour lies outside
    place = ((points - low) / cell_m).astype(np.intp) + 1
    cell = (place[:, 0] * shape[1] + place[:, 1]) * shape[2] + place[:, 2]
    count = np.bincount(cell, minlength=int(np.prod(shape)))
    alone = count[cell] < MANY
    few = np.flatnonzero(alone)
    around = np.array([-1, 0, 1])
    steps = ((around[:, None, None] * shape[1] + around[:, None]) * shape[2] + around).ravel()
    alone[few] = count[cell[few, None] + steps].sum(axis=1) < MANY
    return np.asarray(alone, dtype=np.bool_)
