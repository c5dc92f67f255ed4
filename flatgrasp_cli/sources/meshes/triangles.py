"""Polygons in space → triangles."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray

CONVEX_TOLERANCE = 1e-9
"""Of the polygon's own area: turns by less the wrong way are rounding."""


def triangulated(vertices: FloatArray, corners: IntArray, sizes: IntArray, name: str) -> IntArray:
    """Triangles (m, 3) of polygons over `vertices` (n, 3); `corners` are all polygons', each has `sizes` (k,) of them.

    Raises
    ------
    SourceError
        If a polygon crosses or touches itself.
    """
    begins = np.cumsum(sizes) - sizes
    parts: list[IntArray] = []
    for size in np.flatnonzero(np.bincount(sizes[sizes >= 3])):
        polygons = corners[begins[sizes == size][:, None] + np.arange(size)]
        if size == 3:
            parts.append(polygons)
            continue
        convex, flat = _shapes(vertices, polygons, name)
        parts.append(_fans(polygons[convex]))
        parts.extend(_concave(vertices, polygon, name) for polygon in polygons[~convex & ~flat])
    return np.vstack(parts) if parts else np.empty((0, 3), dtype=np.intp)


def _shapes(vertices: FloatArray, polygons: IntArray, name: str) -> tuple[BoolArray, BoolArray]:
    """Which polygons (k, size) are convex, and which have all corners on a line and so no shape at all."""
    places = vertices[polygons]
    edges = np.roll(places, -1, axis=1) - places
    wedges = np.cross(places - places[:, :1], np.roll(places, -1, axis=1) - places[:, :1])
    normals = wedges.sum(axis=1)
    square, most = (normals**2).sum(axis=1), np.linalg.norm(wedges, axis=2).sum(axis=1) ** 2
    flat = most <= 0
    if (~flat & (square <= CONVEX_TOLERANCE * most)).any():  # one half of it takes away the other
        raise _crossed(polygons.shape[1], name)
    turns = np.einsum("ijk,ik->ij", np.cross(edges, np.roll(edges, -1, axis=1)), normals)
    return np.asarray((turns >= -CONVEX_TOLERANCE * square[:, None]).all(axis=1) & ~flat), np.asarray(flat)


def _crossed(corners: int, name: str) -> SourceError:
    return SourceError(f"{name}: a face with {corners} corners crosses or touches itself; save the mesh with triangles")


def _fans(polygons: IntArray) -> IntArray:
    size = polygons.shape[1]
    fan = np.array([[0, k, k + 1] for k in range(1, size - 1)])
    return np.asarray(polygons[:, fan].reshape(-1, 3))


def _concave(vertices: FloatArray, polygon: IntArray, name: str) -> IntArray:
    """Triangles of a polygon with a bay, which face as it does, found in the coordinate plane in which it is widest."""
    import shapely

    places = vertices[polygon]
    normal = np.cross(places - places[0], np.roll(places, -1, axis=0) - places[0]).sum(axis=0)
    flat = np.delete(places, np.abs(normal).argmax(), axis=1)
    outline = shapely.Polygon(flat)
    if not outline.is_valid:
        raise _crossed(len(polygon), name)
    corner_at = {tuple(place): corner for place, corner in zip(flat.tolist(), polygon.tolist(), strict=True)}
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(outline))
    rings = shapely.get_coordinates(shapely.get_exterior_ring(pieces)).reshape(-1, 4, 2)[:, :3]
    triangles = np.array([[corner_at[tuple(place)] for place in ring] for ring in rings.tolist()], dtype=np.intp)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    turned = np.cross(b - a, c - a) @ normal < 0
    return np.where(turned[:, None], triangles[:, ::-1], triangles)
