"""§III.A.2: projection to the main plane and the concave hull."""

from __future__ import annotations

from typing import Any

import numpy as np

from flatgrasp_cli.geometry.alpha_shape import AlphaShape, thin_interior
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import OrientedBox, Silhouette
from flatgrasp_cli.profiles.settings import SilhouetteSettings

NEIGHBOURS = 6
SPACING_QUANTILE = 0.95
SPACING_SAMPLES = 500
MIN_ALPHA_M = 0.003
ALPHA_GROWTH = 1.5


def silhouette(points: FloatArray, box: OrientedBox, settings: SilhouetteSettings) -> Silhouette:
    """The concave hull of `points` (n, 3) projected to the box's main plane, an ordered simple polygon with holes."""
    local = box.frame.to_local(points)
    projected, heights = np.ascontiguousarray(local[:, :2]), local[:, 2]
    alpha_m = settings.alpha_m or max(MIN_ALPHA_M, 2 * spacing(projected))
    shape = AlphaShape(thin_interior(projected, alpha_m))
    regions = shape.regions(alpha_m)
    while (coverage := _coverage(regions)) < settings.min_coverage and alpha_m < float(np.hypot(*box.size[:2])):
        alpha_m *= ALPHA_GROWTH
        regions = shape.regions(alpha_m)
    loops = _loops(regions[0], settings) if regions else ()
    return Silhouette(box.frame, loops, projected, heights, alpha_m, coverage)


def spacing(points: FloatArray) -> float:
    """Distance within which 95 % of `points` (n, 2) have six neighbours, from an even sample of them."""
    from scipy.spatial import KDTree

    sample = points[:: max(1, len(points) // SPACING_SAMPLES)]
    reach = min(NEIGHBOURS + 1, len(points))  # a point is its own nearest neighbour
    tree = KDTree(
        points, leafsize=32, balanced_tree=False, compact_nodes=False
    )  # quicker to build, and only few queries follow
    distances, _ = tree.query(sample, k=[reach])
    return float(np.quantile(distances, SPACING_QUANTILE))


def _coverage(regions: list[Any]) -> float:
    total = sum(region.area for region in regions)
    return float(regions[0].area / total) if total > 0 else 0.0


def _loops(region: Any, settings: SilhouetteSettings) -> tuple[FloatArray, ...]:
    """Vertices of a shapely polygon: outer loop counter-clockwise, holes that are not missing pixels clockwise."""
    import shapely

    smallest = np.pi / 4 * settings.min_hole_m**2
    holes = [ring for ring in region.interiors if shapely.Polygon(ring).area >= smallest]
    solid = shapely.Polygon(region.exterior, holes if settings.inner_loops else None)
    solid = shapely.simplify(solid, settings.tolerance_m) if settings.tolerance_m > 0 else solid
    solid = shapely.orient_polygons(solid)
    return tuple(shapely.get_coordinates(ring)[:-1] for ring in (solid.exterior, *solid.interiors))
