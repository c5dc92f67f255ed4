"""What stands on a support plane: connected cells of its raster, one cluster an object."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.raster import LEVEL_WINDOW_M, Raster, fitting_cell_m, rasterise, smoothed

PLANE_SIGMAS = 3.0
POINT_SIGMAS = 2.5
MAD_TO_SIGMA = 1.4826
SMOOTH_CELLS = 3
HIGH_M = 0.02
"""Higher points count as this high in a mean, lest a single one that flies lift all cells around it."""
RING_M = 0.04
"""How far around a cluster the plane is looked for."""
RIM_M = 0.015
"""An object's middle lies at least this far inside the convex hull of the plane: what stands at its edge is cut off."""
MIN_POINTS = 30
MARGIN_M = 0.1
"""Points farther beyond the support plane's own are not looked at: a room behind the table."""
SECTORS, MIN_SECTORS = 16, 5
"""Directions around an object, and how many of them must show the support plane for it to stand there."""
LEAST_OUTSIDE = 0.3
"""Least share of the plane outside the objects' convex hulls; with less, the plane is part of an object."""


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """Indices of the points of each object, of those above the plane that belong to none, and of the plane's own.

    `lie_on_table` says whether there are objects, and enough of the plane around them not to be part of one;
    `extent_m` is the plane's diagonal.
    """

    members: tuple[IntArray, ...]
    clutter: IntArray
    table: IntArray
    lie_on_table: bool
    extent_m: float


def find_clusters(points: FloatArray, plane: SupportPlane, settings: SceneSettings) -> Clusters:
    """Objects among `points` (n, 3) that stand on `plane`, largest first."""
    from scipy.ndimage import label

    heights = plane.heights(points)
    planar = plane_frame(plane).to_local(points)[:, :2]
    flat = np.abs(heights) < PLANE_SIGMAS * plane.noise_m
    low, high = planar[flat].min(axis=0) - MARGIN_M, planar[flat].max(axis=0) + MARGIN_M
    near = np.flatnonzero(((planar > low) & (planar < high)).all(axis=1) & (heights > -PLANE_SIGMAS * plane.noise_m))
    planar, heights, flat = planar[near], heights[near], flat[near]

    raster = rasterise(planar, fitting_cell_m(planar[flat]))
    own = raster.mean(np.minimum(heights, HIGH_M))
    table = _largest((raster.count > 0) & (np.abs(own) < PLANE_SIGMAS * plane.noise_m))
    standing = _standing(raster, own, table, plane.noise_m, settings)
    labels, _ = label(_bridged(standing, settings.gap_m / raster.cell_m), structure=np.ones((3, 3)))
    labels = np.where(standing, labels, 0)
    chosen = _objects(raster, labels, table, settings)

    least = np.minimum(POINT_SIGMAS * plane.noise_m, 0.5 * own).ravel()[raster.cell]
    piece = np.where(heights > least, labels.ravel()[raster.cell], 0)  # the plane's points at an object's edge
    member = np.isin(piece, chosen)
    return Clusters(
        members=tuple(near[piece == name] for name in chosen),
        clutter=near[(piece > 0) & ~member],
        table=near[piece == 0],
        lie_on_table=bool(chosen) and _outside_share(labels, chosen, table) >= LEAST_OUTSIDE,
        extent_m=float(raster.cell_m * np.hypot(*np.ptp(np.argwhere(table), axis=0))),
    )


def _standing(raster: Raster, own: FloatArray, table: BoolArray, noise_m: float, settings: SceneSettings) -> BoolArray:
    """Which cells stand out of the plane, whose local level ripples: by their surroundings' mean and by their `own`."""
    window = 2 * round(0.5 * LEVEL_WINDOW_M / raster.cell_m) + 1
    smooth = smoothed(own, raster.count, SMOOTH_CELLS) - smoothed(own, table, window)
    scatter = MAD_TO_SIGMA * float(np.median(np.abs(smooth[table])))
    threshold = max(settings.min_height_m, settings.noise_factor * scatter)
    sure = POINT_SIGMAS * noise_m / np.sqrt(np.maximum(raster.count, 1))
    return np.asarray((raster.count > 0) & (smooth > threshold) & (own > np.maximum(threshold, sure)))


def _bridged(mask: BoolArray, gap_cells: float) -> BoolArray:
    from scipy.ndimage import binary_dilation

    reach = round(0.5 * gap_cells)
    return np.asarray(binary_dilation(mask, iterations=reach)) if reach else mask


def plane_frame(plane: SupportPlane) -> Frame:
    """A frame whose z axis is the plane's normal and whose origin lies in the plane."""
    helper = np.eye(3)[int(np.argmin(np.abs(plane.normal)))]
    x = np.cross(helper, plane.normal)
    x /= np.linalg.norm(x)
    return Frame(plane.offset_m * plane.normal, np.stack([x, np.cross(plane.normal, x), plane.normal]))


def _largest(mask: BoolArray) -> BoolArray:
    """The largest connected piece of `mask`, gaps of a cell bridged."""
    from scipy.ndimage import binary_dilation, label

    labels, _ = label(binary_dilation(mask, structure=np.ones((3, 3))), structure=np.ones((3, 3)))
    labels = np.where(mask, labels, 0)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return np.asarray(labels == np.argmax(sizes)) & mask


def _objects(raster: Raster, labels: IntArray, table: BoolArray, settings: SceneSettings) -> list[int]:
    """Names of the clusters that are objects, largest first: big enough, not too long, and amid the plane."""
    import shapely
    from scipy.ndimage import find_objects

    cells = np.bincount(labels.ravel())
    points = np.bincount(labels.ravel(), weights=raster.count.ravel())
    amid = _hull(table).buffer(-RIM_M / raster.cell_m)
    found = []
    for name, box in enumerate(find_objects(labels), start=1):
        if box is None or cells[name] * raster.cell_m**2 < settings.min_size_m**2 or points[name] < MIN_POINTS:
            continue
        if raster.cell_m * np.hypot(*(side.stop - side.start for side in box)) > settings.max_size_m:
            continue
        middle = np.argwhere(labels[box] == name).mean(axis=0) + [side.start for side in box]
        if shapely.contains_xy(amid, *middle) and _sectors(box, middle, table, RING_M / raster.cell_m) >= MIN_SECTORS:
            found.append(name)
    return sorted(found, key=lambda name: -int(cells[name]))


def _hull(mask: BoolArray) -> Any:
    """Convex hull of a mask's cells, as a shapely geometry: of the first and the last one in each row."""
    import shapely

    rows = np.flatnonzero(mask.any(axis=1))
    first = mask[rows].argmax(axis=1)
    last = mask.shape[1] - 1 - mask[rows, ::-1].argmax(axis=1)
    return shapely.MultiPoint(np.column_stack([np.tile(rows, 2), np.concatenate([first, last])])).convex_hull


def _sectors(box: tuple[slice, ...], middle: FloatArray, table: BoolArray, reach: float) -> int:
    """In how many directions from a cluster's `middle` (2,) the plane appears within `reach` cells of its `box`."""
    starts = [max(0, side.start - round(reach)) for side in box]
    ends = [side.stop + round(reach) for side in box]
    away = np.argwhere(table[starts[0] : ends[0], starts[1] : ends[1]]) + starts - middle
    angle = np.arctan2(away[:, 0], away[:, 1])
    return len(np.unique(np.floor(angle * SECTORS / (2 * np.pi)) % SECTORS))


def _outside_share(labels: IntArray, chosen: list[int], table: BoolArray) -> float:
    """Share of the plane's cells outside the convex hulls of the objects: that of a hollow object holds its floor."""
    import shapely

    cells = np.argwhere(table)
    inside = np.zeros(len(cells), dtype=np.bool_)
    for name in chosen:
        inside |= shapely.contains_xy(_hull(labels == name), cells)
    return float((~inside).mean())
