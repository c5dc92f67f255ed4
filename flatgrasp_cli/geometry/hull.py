"""Convex hulls in the plane."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import cross, following, signed_area
from flatgrasp_cli.kernels.rim import on_rim


def convex_hull(places: FloatArray) -> FloatArray:
    """Corners (c, 2) of the convex hull of `places` (n, 2), counter-clockwise; none if they lie on a line."""
    import shapely

    few = places[on_rim(places)]
    found = shapely.LineString(few).convex_hull if len(few) >= 3 else None
    if found is None or found.geom_type != "Polygon":
        return np.empty((0, 2))
    corners: FloatArray = shapely.get_coordinates(found)[:-1]
    return corners if signed_area(corners) > 0 else corners[::-1]


def depths(hull: FloatArray, places: FloatArray) -> FloatArray:
    """How far (n,) from the nearest side of a `hull` (c, 2) `places` (n, 2) lie in it; less than 0 outside."""
    if len(hull) == 0:
        return np.full(len(places), -np.inf)
    along = following(hull) - hull
    along /= np.hypot(along[:, 0], along[:, 1])[:, None]
    return np.asarray(cross(along, places[:, None] - hull).min(axis=1))
