"""§III.A.2: projection to the main plane and the concave hull."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from flatgrasp_cli.geometry import polygon
from flatgrasp_cli.geometry.alpha_shape import CellGrid, alpha_region
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.spacing import spacing
from flatgrasp_cli.kernels.gaps import two_skins
from flatgrasp_cli.model import Silhouette
from flatgrasp_cli.profiles.settings import SilhouetteSettings

MIN_ALPHA_M = 0.003
"""Least radius α that is derived, metres: a notch that lets no disc of 6 mm in lets no finger in either."""
ALPHA_GROWTH = 1.5
"""Factor by which α grows at a time: an α half as large again as need be rounds notches off little."""
STRAY_M = 0.02
"""Points farther than about this from all others belong to nothing, metres: the gaps that missing pixels leave in a
surface are narrower."""


def silhouette_of(
    points: FloatArray, frame: Frame, settings: SilhouetteSettings, spacing_m: float | None = None
) -> Silhouette:
    """The concave hull of `points` (n, 3) in `frame`, projected to its x-y plane, the main one: a polygon with holes.

    `spacing_m` is that of the projected points where it is known already.
    α grows until one piece holds the share of the points that the settings ask for; what is still detached from it
    is left out.
    """
    projected, heights = np.ascontiguousarray(points[:, :2]), points[:, 2]
    alpha_m = least_alpha_m(projected, settings, spacing_m)
    alpha_m, member = _one_piece(projected, alpha_m, settings.min_coverage)
    region = alpha_region(projected if member.all() else projected[member], alpha_m)
    loops = _loops(region, settings) if region is not None else ()
    loops = (*loops[:1], *(hole for hole in loops[1:] if not _is_gap(hole, projected, heights, alpha_m)))
    return Silhouette(
        frame=frame, loops=loops, points=projected, heights=heights, alpha_m=alpha_m, coverage=float(member.mean())
    )


def least_alpha_m(projected: FloatArray, settings: SilhouetteSettings, spacing_m: float | None = None) -> float:
    """The radius α of points (n, 2) without gaps, metres: as the settings have it, or by how far apart they lie."""
    return settings.alpha_m or max(MIN_ALPHA_M, 2 * (spacing_m or spacing(projected)))


def largest_share(projected: FloatArray, settings: SilhouetteSettings, spacing_m: float | None = None) -> float:
    """Share of points (n, 2) that belong to their largest piece; gaps that missing pixels leave part no pieces.

    Neither do gaps between the lines of a scanner: it is 1 where the largest piece is a line, or has such gaps itself.
    Pieces are told by twice α, so that lines which are pieces of theirs have gaps by α.
    """
    alpha_m = least_alpha_m(projected, settings, spacing_m)
    member, share = CellGrid(projected, max(STRAY_M, 2 * alpha_m)).largest_piece()
    if share >= settings.min_coverage:
        return share
    piece = projected[member]
    _, sides, _ = cv2.minAreaRect(piece.astype(np.float32))
    dense_m, _ = _one_piece(piece, alpha_m, settings.min_coverage)
    return share if min(sides) > alpha_m == dense_m else 1.0


def without_strays(points: FloatArray, settings: SilhouetteSettings) -> FloatArray:
    """Those of an object's `points` (n, 3) that form one piece, seen along each of the axes.

    The silhouette leaves out what is detached, but it comes after the box, which one point far off tilts and stretches.
    """
    for view in ([0, 1], [0, 2], [1, 2]):
        if len(points) > 0:
            _, member = _one_piece(points[:, view], STRAY_M, settings.min_coverage)
            points = points if member.all() else points[member]
    return points


def _one_piece(points: FloatArray, alpha_m: float, min_share: float) -> tuple[float, BoolArray]:
    """An α from `alpha_m` on with which the largest piece of the points holds `min_share`, and that piece (n,)."""
    while True:
        try:
            grid = CellGrid(points, alpha_m)
        except ValueError:  # α is tiny compared with the extent: points far off, or a cloud that is no object
            alpha_m *= ALPHA_GROWTH
            continue
        member, share = grid.largest_piece()
        if share >= min_share:
            return alpha_m, member
        alpha_m *= ALPHA_GROWTH


def _loops(region: Any, settings: SilhouetteSettings) -> tuple[FloatArray, ...]:
    """Vertices of a shapely polygon: the outer loop counter-clockwise, holes larger than missing pixels clockwise."""
    import shapely

    smallest = np.pi / 4 * settings.min_hole_m**2
    holes = [ring for ring in region.interiors if shapely.Polygon(ring).area >= smallest]
    solid = shapely.Polygon(region.exterior, holes if settings.inner_loops else None)
    solid = shapely.simplify(solid, settings.tolerance_m) if settings.tolerance_m > 0 else solid
    solid = shapely.orient_polygons(solid)
    return tuple(shapely.get_coordinates(ring)[:-1] for ring in (solid.exterior, *solid.interiors))


def _is_gap(hole: FloatArray, points: FloatArray, heights: FloatArray, alpha_m: float) -> bool:
    """Whether a hole (n, 2) is one of the data: most of it has two skins of the object beside it, and no wall between.

    An object that was seen from both sides has a wall wherever there is something to press on. Two skins are farther
    apart than the disc around a place of the hole is wide in which heights are compared.
    """
    reach_m, perimeter = 2 * alpha_m, polygon.arc_positions(hole)[-1]
    places = polygon.points_at(hole, np.arange(0.0, perimeter, reach_m))
    skins = two_skins(places, points, heights, reach_m, 2 * reach_m)
    return 2 * int(np.count_nonzero(skins)) > len(skins)
