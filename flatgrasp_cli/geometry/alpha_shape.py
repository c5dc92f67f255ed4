"""α-shapes: the concave hull of a planar point set (Edelsbrunner, Kirkpatrick & Seidel, IEEE T-IT 29(4), 1983).

Its boundary is what a disc of radius α touches when it rolls around the points, and inside each hole that is wide
enough for it. The disc's centre then runs along the line at distance α from the nearest point. A distance transform
finds that line, in order, and with it the points: so the silhouette's vertices are points, and no triangulation is
made.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.extents import bounds_of
from flatgrasp_cli.geometry.polygon import signed_area
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.kernels.rolling import marked, outermost, without_notches

CELLS_PER_ALPHA = np.sqrt(2)
"""A disc of radius α, wherever it lies, holds a whole cell of side α/√2: the one around its centre."""
PIXELS_PER_ALPHA, MAX_PIXELS = 6.0, 60_000
"""Resolution of the distance transform. A point that the disc would touch on less than a pixel's way may be missed."""
MARGIN = 1.1
"""A disc rolls around the points within so many times α of them."""
FILLINGS = 3


class CellGrid:
    """Points (n, 2) sorted into square cells of side α/√2, with one empty cell around them all.

    Raises
    ------
    ValueError
        If α is so small against the points' extent that the cells would not fit into memory.
    """

    def __init__(self, points: FloatArray, alpha_m: float) -> None:
        columns = np.ascontiguousarray(points.T)  # (2, n): reductions run fast over a long last axis
        cell_m = alpha_m / CELLS_PER_ALPHA
        x, y = columns
        raster = Raster.around(points, cell_m)
        if raster.cell_m > cell_m:
            raise ValueError(f"cells of {cell_m} m are too many for points {np.ptp(columns, axis=1).max()} m apart")
        self.cell = raster.cells_within(x, y)
        self.occupied: BoolArray = raster.count(self.cell) > 0

    def largest_piece(self) -> tuple[BoolArray, float]:
        """The connected cells with the most points, as a mask over the points (n,), and their share of the points."""
        count, labels = cv2.connectedComponents(self.occupied.view(np.uint8), connectivity=8)
        if count == 2:  # the empty cells, and one piece: as a rule
            return np.ones(len(self.cell), dtype=np.bool_), 1.0
        piece = labels.ravel()[self.cell]
        counts = np.bincount(piece)
        member = piece == np.argmax(counts)
        return member, float(counts.max() / len(piece))


def alpha_region(points: FloatArray, alpha_m: float) -> Any:
    """The α-shape of `points` (n, 2), as a shapely polygon with holes: its largest piece, None without area."""
    import shapely

    low, high = bounds_of(points)
    pixel_m = _pixel_m(high - low, alpha_m)
    if _deepest_m(high - low, alpha_m) < pixel_m:
        hull = shapely.convex_hull(shapely.MultiPoint(points))
        return hull if hull.geom_type == "Polygon" else None
    rings, outer = _rolled_around(points, alpha_m, pixel_m)
    largest = max(range(len(rings)), key=lambda k: abs(signed_area(rings[k])) if outer[k] < 0 else -1.0)
    holes = [
        _filled(_turning(ring, -1.0), alpha_m) for ring, shell in zip(rings, outer, strict=True) if shell == largest
    ]
    shell = _filled(_turning(rings[largest], 1.0), alpha_m)
    if len(shell) < 3:
        return None
    holes = [hole for hole in holes if len(hole) >= 3]
    shape = shapely.Polygon(shell, holes)
    if not shape.is_valid:  # the disc rolled along both sides of a row of points
        solid, rest = _repaired(shell), shapely.union_all([_repaired(hole) for hole in holes])
        left = shapely.difference(solid, rest)
        pieces = [part for part in shapely.get_parts(shapely.get_parts(left)) if part.geom_type == "Polygon"]
        shape = max(pieces, key=lambda part: float(shapely.Polygon(part.exterior).area), default=None)
    return shape if shape is not None and shape.area > 0 else None


def _repaired(ring: FloatArray) -> Any:
    """The valid polygons within a `ring` (k, 2), without the lines and points in which it touches itself.

    By its structure: what shapely makes of its lines can have a negative area, on which overlays fail. If that is not
    valid yet, as happens to rings that touch themselves within rounding, once more by its lines.
    """
    import shapely

    found = shapely.make_valid(shapely.Polygon(ring), method="structure", keep_collapsed=False)
    return found if found.is_valid else shapely.make_valid(found)


def _pixel_m(size: FloatArray, alpha_m: float) -> float:
    """Side of the pixels by which a disc rolls around points within a rectangle of `size` (2,), metres."""
    by_memory = np.sqrt(np.prod(size + 2 * MARGIN * alpha_m) / MAX_PIXELS)
    return max(min(alpha_m, float(np.hypot(*size))) / PIXELS_PER_ALPHA, float(by_memory))


def _deepest_m(size: FloatArray, alpha_m: float) -> float:
    """How deep, at most, a disc sinks in between two points within a rectangle of `size` (2,), metres."""
    half = 0.5 * float(np.hypot(*size))
    return alpha_m if half >= alpha_m else alpha_m - float(np.sqrt(alpha_m**2 - half**2))


def _rolled_around(points: FloatArray, alpha_m: float, pixel: float) -> tuple[list[FloatArray], list[int]]:
    """The points (k, 2) that a disc touches, ring by ring and in order; and each hole's outer ring, −1 for those."""
    low, high = bounds_of(points)
    low, high = low - MARGIN * alpha_m, high + MARGIN * alpha_m
    width, height = ((high - low) / pixel + 3).astype(np.intp).tolist()
    empty = np.ones((height, width), dtype=np.uint8)
    place = marked(points, low, pixel, empty)
    distance, nearest = cv2.distanceTransformWithLabels(empty, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    covered = (distance <= alpha_m / pixel).view(np.uint8)
    contours, family = cv2.findContours(covered, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    path = np.concatenate(contours)[:, 0]  # where the disc's centre goes
    touched = nearest[path[:, 1], path[:, 0]]
    owner = outermost(points, nearest.ravel().take(place), touched, low + (path - 0.5) * pixel, int(nearest.max()) + 1)
    ways = np.split(touched, np.cumsum([len(contour) for contour in contours])[:-1])
    rings = [points[owner[way[way != np.concatenate([way[-1:], way[:-1]])]]] for way in ways]
    return rings, family[0, :, 3].tolist()


def _turning(ring: FloatArray, sign: float) -> FloatArray:
    """The ring (k, 2) counter-clockwise, or clockwise where `sign` is negative."""
    return ring if len(ring) < 3 or signed_area(ring) * sign > 0 else ring[::-1]


def _filled(ring: FloatArray, alpha_m: float) -> FloatArray:
    """The ring (k, 2) without its notches between points that are no farther apart than α.

    Neighbouring points of a straight edge lie a little in and out: as a silhouette they would be a zigzag. What is
    filled is at most α·(1 − √3/2) deep.
    """
    for _ in range(FILLINGS):
        before, ring = len(ring), without_notches(ring, alpha_m)
        if len(ring) == before:
            break
    return ring
