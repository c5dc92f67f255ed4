"""What stands on a support plane: connected cells of its raster, one cluster for each object."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray, IntArray
from flatgrasp_cli.geometry.broad import broad_pieces
from flatgrasp_cli.geometry.frames import Frame, frame_on_plane
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.geometry.hull import depths
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.geometry.sampling import even_sample
from flatgrasp_cli.geometry.scatter import deviation
from flatgrasp_cli.kernels.rim import ends
from flatgrasp_cli.kernels.windows import means, of_cells
from flatgrasp_cli.model import Cloud, Floor, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.cells import LEVEL_WINDOW_M, SMOOTH_CELLS, SortedPoints, fitting_cell_m, usual
from flatgrasp_cli.scene.masks import hull_of, span_of
from flatgrasp_cli.scene.strays import lonely
from flatgrasp_cli.scene.support_plane import FINE_SAMPLE, GOOD_PART, NEAR_M, SIGMAS, flatness_m
from flatgrasp_cli.surroundings.slices import MIN_POINTS

SECTORS = 16
"""Directions around an object. In a good part of them the support plane is seen if the object stands on it: seen
obliquely before a wall, a third are left. As good a part of the plane must lie outside the objects' convex hulls, or it
is a part of an object: the floor of a pan, whose rim stands around it."""


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """Indices of the points of each object and of those above the plane that belong to none; and the plane itself.

    Objects that touched have the same of the `groups`; None is that of those that stand apart. `container` are the
    indices of the points of a bin around the objects, whose walls are `solid` (k, 3). `floor` is what was seen of the
    plane with nothing on it. `lie_on_table` tells whether there are objects, and enough of the plane around them not to
    be part of one; `extent_m` is the plane's diagonal.
    """

    members: tuple[IntArray, ...]
    clutter: IntArray
    floor: Floor
    lie_on_table: bool
    extent_m: float
    groups: tuple[int | None, ...] = ()
    container: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    solid: FloatArray = field(default_factory=lambda: np.empty((0, 3)))


def find_clusters(cloud: Cloud, plane: SupportPlane, settings: SceneSettings) -> Clusters | None:
    """The objects of a cloud on `plane`, largest first; None if no cell shows the plane itself."""
    frame, flat_m = frame_on_plane(plane.normal, plane.offset_m), flatness_m(plane, settings)
    coarse_m = settings.least_part_m / SMOOTH_CELLS  # shadows and gaps are as wide as parts
    raster, points = _raster(cloud, frame, flat_m, coarse_m), cloud.points
    # heights are cut off, lest a single flying point lift the mean of all cells around it
    found = SortedPoints.of(points, frame, raster, (-flat_m, settings.least_part_m))
    own = of_cells(found.total, found.count)
    table = _broad((found.count > 0) & (np.abs(own) < flat_m), settings.least_part_m / found.raster.cell_m)
    if not table.any():
        return None
    standing = _standing(found, own, table, plane.noise_m, settings)
    labels = _labels(_bridged(standing, 0.5 * settings.min_size_m / raster.cell_m)) * standing
    above = np.flatnonzero(standing)
    chosen = _objects(found, labels, above, table, settings)

    # from here on only the points in cells that stand out, which are few, without the plane's at an object's edge
    floor = np.full(standing.shape, np.inf)
    floor.flat[above] = np.minimum(flat_m, 0.5 * own.take(above))
    rows, heights = found.standing(floor)
    among = np.flatnonzero(~lonely(points.take(rows, axis=0), SMOOTH_CELLS * found.raster.cell_m))
    rows, heights = rows[among], heights[among]
    piece = labels.ravel()[found.cell[rows]]
    return Clusters(
        members=tuple(rows[piece == name] for name in chosen),
        clutter=rows[~np.isin(piece, chosen)],
        floor=_floor(frame, found, rows, heights, settings.least_part_m),
        lie_on_table=bool(chosen) and _outside_share(labels, chosen, table) >= GOOD_PART,
        extent_m=float(found.raster.cell_m * np.hypot(*span_of(table))),
    )


def _raster(cloud: Cloud, frame: Frame, flat_m: float, coarse_m: float) -> Raster:
    """A raster of the plane and a margin around it, as far as there are points, laid out by an even sample of them."""
    sample = cloud.sample(FINE_SAMPLE)
    x, y, heights = frame.to_local(sample).T
    flat = np.abs(heights) < flat_m
    sides = [(x, x[flat]), (y, y[flat])]
    low = np.array([max(every_one.min(), own.min() - NEAR_M) for every_one, own in sides])
    high = np.array([min(every_one.max(), own.max() + NEAR_M) for every_one, own in sides])
    return Raster.over(low, high, fitting_cell_m(x[flat], y[flat], coarse_m, len(cloud.points) / len(sample)))


def _floor(frame: Frame, found: SortedPoints, rows: IntArray, heights: FloatArray, width_m: float) -> Floor:
    """The cells with points of the plane, at the mean height of those around them: a cell's own is mostly noise.

    They are those in a square of `width_m`, no wider than a finger with its clearance. `rows` are the points that are
    not the plane's, at `heights`.
    """
    cell = found.cell[rows].astype(np.intp)
    count, total = found.count - found.raster.count(cell), found.total - found.raster.total(cell, heights)
    level = means(total, count, 2 * round(0.5 * width_m / found.raster.cell_m) + 1)
    levels = HeightMap(found.raster, np.where(count > 0, level, UNSEEN))
    return Floor(frame, levels, found.raster.cell_m / float(np.sqrt(usual(count))))


def _standing(
    found: SortedPoints, own: FloatArray, table: BoolArray, noise_m: float, settings: SceneSettings
) -> BoolArray:
    """Which cells stand out of the plane, whose level ripples: by the mean of their surroundings and by their `own`."""
    window = 2 * round(0.5 * LEVEL_WINDOW_M / found.raster.cell_m) + 1
    level = means(np.where(table, own, 0.0), table.astype(np.intp), window)
    smooth = means(found.total, found.count, SMOOTH_CELLS) - level
    of_table = np.flatnonzero(table)
    scatter = deviation(smooth.take(even_sample(of_table, FINE_SAMPLE)))
    # the highest that noise alone makes of so many (Donoho & Johnstone 1994)
    highest = scatter * np.sqrt(2 * np.log(len(of_table)))
    threshold = max(settings.min_height_m, highest)
    standing: BoolArray = (smooth > threshold) & (own > threshold)
    few = np.flatnonzero(standing)
    standing.flat[few] = own.take(few) > SIGMAS * noise_m / np.sqrt(found.count.take(few))
    return standing


def _bridged(mask: BoolArray, gap_cells: float) -> ByteArray:
    """The mask grown on all sides by half of the gap that is to be bridged, into which not half of a finger fits."""
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    return np.asarray(cv2.dilate(mask.view(np.uint8), cross, iterations=round(0.5 * gap_cells)))


def _labels(mask: Any) -> IntArray:
    """Numbers (rows, columns) from 1 for the connected pieces of a mask of bytes."""
    return np.asarray(cv2.connectedComponents(mask, connectivity=8)[1], dtype=np.int32)


def _broad(mask: BoolArray, cells: float) -> BoolArray:
    """The connected pieces of `mask`, gaps of a cell bridged, that are somewhere as wide as so many `cells`.

    Shadows and things cut a table in pieces. What only crosses its plane, as a wall does, is narrow there.
    """
    bridged = cv2.dilate(mask.view(np.uint8), np.ones((3, 3), np.uint8))
    return np.asarray(broad_pieces(np.asarray(bridged), 2 * round(0.5 * cells) + 1) & mask)


def _objects(
    found: SortedPoints, labels: IntArray, cell: IntArray, table: BoolArray, settings: SceneSettings
) -> list[int]:
    """Names of the clusters that are objects, largest first: large enough, and amid the plane.

    `cell` (k,) are the flat indices of those with `labels` (rows, columns).
    """
    row, column = np.divmod(cell, labels.shape[1])
    name_of = labels.ravel()[cell]
    cells = np.bincount(name_of)
    points = np.bincount(name_of, weights=found.count.ravel()[cell])
    large = (cells * found.raster.cell_m**2 >= settings.min_size_m**2) & (points >= MIN_POINTS)
    least_part = settings.least_part_m / found.raster.cell_m
    hull, chosen = hull_of(table), []
    for name in np.flatnonzero(large).tolist():
        own = np.stack([row[name_of == name], column[name_of == name]])
        low, high = own.min(axis=1), own.max(axis=1) + 1
        middle = own.mean(axis=1)
        if depths(hull, middle[None])[0] <= 0.5 * least_part:
            continue  # so near to the edge of a view, half of such a part is cut off
        if _sectors(low, high, middle, table, least_part) >= GOOD_PART * SECTORS:
            chosen.append(name)
    return sorted(chosen, key=lambda name: -int(cells[name]))


def _sectors(low: IntArray, high: IntArray, middle: FloatArray, table: BoolArray, reach: float) -> int:
    """In how many directions from a cluster's `middle` (2,) the plane is seen within `reach` cells of its box."""
    start, end = np.maximum(low - round(reach), 0), high + round(reach)
    row, column = np.nonzero(table[start[0] : end[0], start[1] : end[1]])
    angle = np.arctan2(row + start[0] - middle[0], column + start[1] - middle[1])
    sector = np.floor(angle * SECTORS / (2 * np.pi)) % SECTORS
    return int(np.count_nonzero(np.bincount(sector.astype(np.intp), minlength=SECTORS)))


def _outside_share(labels: IntArray, chosen: list[int], table: BoolArray) -> float:
    """Share of the plane's cells outside the objects' convex hulls: a hollow object's floor lies inside its own."""
    covered = np.zeros(table.shape, dtype=np.uint8)
    for name in chosen:
        rows, first, last = ends((labels == name).view(np.uint8))
        both = np.column_stack([np.concatenate([first, last]), np.tile(rows, 2)])  # OpenCV's x is the column
        cv2.fillConvexPoly(covered, cv2.convexHull(both.astype(np.int32)), 1)
    return 1.0 - int(np.count_nonzero(table & (covered > 0))) / max(1, int(np.count_nonzero(table)))
