"""Where the picture ends, and the table: what lies there was seen in part, and nobody knows how it goes on."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.extents import bounds_of, mean_of
from flatgrasp_cli.geometry.height_map import UNSEEN
from flatgrasp_cli.geometry.hull import depths
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.geometry.scatter import median
from flatgrasp_cli.kernels.rim import on_rim
from flatgrasp_cli.model import Cloud, Floor
from flatgrasp_cli.scene.cells import SMOOTH_CELLS
from flatgrasp_cli.scene.clusters import SECTORS
from flatgrasp_cli.scene.faint import WINDOW_PX
from flatgrasp_cli.scene.masks import hull_of
from flatgrasp_cli.scene.parting.joints import MOST
from flatgrasp_cli.scene.parting.view_grid import image_of
from flatgrasp_cli.scene.support_plane import FINE_SAMPLE


def cut_off(cloud: Cloud, viewpoint: FloatArray, members: tuple[IntArray, ...], spacing_m: float) -> tuple[bool, ...]:
    """Which of the `members`, indices of points of the cloud, the edge of the picture from `viewpoint` (3,) cuts off.

    Without an image the picture is the smallest rectangle around the cloud, whose points lie `spacing_m` apart.
    """
    rows = np.concatenate([*members, np.empty(0, dtype=np.intp)])
    if cloud.pixels is not None:
        width = cloud.pixels.shape[1]
        pixel = np.flatnonzero(cloud.pixels.filled)
        chosen = spread_indices(len(pixel), FINE_SAMPLE)
        picture, own = (np.column_stack(np.divmod(pixel[some], width))[:, ::-1] for some in (chosen, rows))
        size = np.array(cloud.pixels.shape[::-1], dtype=np.float64)
        limits = (1 - MOST) * size, MOST * size  # stereo cameras leave up to 0.06 of it empty at a side
    else:
        sample = cloud.sample(FINE_SAMPLE)
        x, y, depth = image_of(np.concatenate([sample, cloud.points.take(rows, axis=0)]), viewpoint)
        both = np.column_stack([x, y]) * (median(depth) / spacing_m)
        _, _, turn = cv2.minAreaRect(both[on_rim(both[: len(sample)])].astype(np.float32))
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        picture, own = np.split(both @ np.array([[c, -s], [s, c]]), [len(sample)])
        limits = np.full(2, np.inf), np.full(2, -np.inf)
    at_edge = _at_edge(picture.astype(np.float64), own.astype(np.float64), limits)
    ends = np.cumsum([len(member) for member in members])[:-1]
    return tuple(int(np.count_nonzero(part)) >= SMOOTH_CELLS**2 for part in np.split(at_edge, ends))[: len(members)]


def at_table_edge(points: FloatArray, members: tuple[IntArray, ...], floor: Floor, edge_m: float) -> tuple[bool, ...]:
    """Which of the `members`, indices of `points` (n, 3), lie within `edge_m` of the edge of the seen floor.

    A hand stands half beyond it there, and things are what the table ends with.
    """
    raster = floor.levels.raster
    middles = np.array([mean_of(points.take(rows, axis=0)) for rows in members]).reshape(-1, 3)
    x, y, _ = floor.frame.to_local(middles).T
    places = np.column_stack(np.divmod(raster.cells(x, y), raster.shape[1]))
    inside = depths(hull_of(floor.levels.heights > UNSEEN), places) > edge_m / raster.cell_m
    return tuple((~inside).tolist())


def _at_edge(picture: FloatArray, own: FloatArray, limits: tuple[FloatArray, FloatArray]) -> BoolArray:
    """Which of the places `own` (k, 2), in pixels, lie at the sides of the picture that places (n, 2) fill.

    A side that is not lower, or higher, than the `limits` (2,), (2,) is none of the picture's. The picture ends along a
    straight line: most stretches of it hold points, or it is the end of a table, or of a thing that stands out.
    """
    low, high = bounds_of(picture)
    found = np.zeros(len(own), dtype=np.bool_)
    for axis in (0, 1):
        for end, is_side in ((low[axis], low[axis] <= limits[0][axis]), (high[axis], high[axis] >= limits[1][axis])):
            there = _near(own[:, axis], end)
            if not is_side or not there.any():
                continue
            along = picture[_near(picture[:, axis], end), 1 - axis] - low[1 - axis]
            stretch = np.floor(along / (high - low + 1)[1 - axis] * SECTORS)
            held = np.bincount(stretch.astype(np.intp), minlength=SECTORS)
            if 2 * np.count_nonzero(held) >= SECTORS:
                found |= there
    return found


def _near(values: FloatArray, end: float) -> BoolArray:
    """Which values, in pixels, lie so near to the picture's end that a sensor may have dropped what lies beyond."""
    return np.asarray(np.abs(values - end) <= WINDOW_PX)
