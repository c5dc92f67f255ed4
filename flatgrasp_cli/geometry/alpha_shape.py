"""α-shapes: the concave hull of a planar point set (Edelsbrunner, Kirkpatrick & Seidel, IEEE T-IT 29(4), 1983)."""

from __future__ import annotations

from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray


def circumradii(triangles: FloatArray) -> FloatArray:
    """Circumradius (n,) of `triangles` (n, 3, 2): product of the sides over four times the area; inf when flat."""
    side = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    double_area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = side.prod(axis=1) / (2 * double_area)
    return np.where(double_area > 0, radius, np.inf)


class AlphaShape:
    """One Delaunay triangulation of `points` (n, 2) from which shapes at any α are cut.

    Raises
    ------
    scipy.spatial.QhullError
        If the points lie on a line or are fewer than three.
    """

    def __init__(self, points: FloatArray) -> None:
        from scipy.spatial import Delaunay

        self._points = points
        self._mesh = Delaunay(points)
        self._radius = circumradii(points[self._mesh.simplices])

    def regions(self, alpha_m: float) -> list[Any]:
        """Shapely polygons, largest first, of the triangles whose circumradius is at most `alpha_m`."""
        import shapely

        ring_edges = self._points[self._boundary(self._radius <= alpha_m)]
        area = shapely.build_area(shapely.multilinestrings(shapely.linestrings(ring_edges)))
        return sorted(shapely.get_parts(area).tolist(), key=lambda polygon: -polygon.area)

    def _boundary(self, kept: BoolArray) -> Any:
        """Vertex pairs (k, 2) of the edges between a kept triangle and none or an unkept one."""
        neighbours = self._mesh.neighbors
        open_side = kept[:, None] & ((neighbours < 0) | ~kept[neighbours])
        triangle, corner = np.nonzero(open_side)  # side k of a simplex lies opposite its corner k
        simplices = self._mesh.simplices
        return np.column_stack([simplices[triangle, (corner + 1) % 3], simplices[triangle, (corner + 2) % 3]])


MAX_GRID_CELLS = 4_000_000


def thin_interior(points: FloatArray, alpha_m: float) -> FloatArray:
    """The points (n, 2) that can shape an α-shape's boundary, and one for each grid cell of its interior.

    On a grid of side α/√2 every disc of radius α through, or around, a point p holds the whole of some cell at most two
    cells away from p's (the one around the centre of the disc of radius √2·side that touches p from within). Where all
    those cells hold points, p touches no empty disc, hence no boundary; dropping all such p but one a cell leaves
    every disc as full or as empty as it was. So the boundary for this and any larger α stays the same, point by point,
    while the triangulation shrinks several times. Points too far apart for a grid are returned as they are.
    """
    cells = np.floor((points - points.min(axis=0)) * (np.sqrt(2) / alpha_m))
    columns, rows = (cells.max(axis=0) + 1).tolist()
    if columns * rows > MAX_GRID_CELLS:
        return points
    cell = (cells[:, 0] * rows + cells[:, 1]).astype(np.intp)
    occupied = np.bincount(cell, minlength=int(columns * rows)).reshape(int(columns), int(rows)) > 0
    interior = _all_within_two(_all_within_two(occupied).T).T.ravel()
    keep = ~interior[cell]
    representative = np.empty(interior.size, dtype=np.intp)
    representative[cell[::-1]] = np.arange(len(cell))[::-1]  # the last write wins: the first point of each cell
    keep[representative[interior]] = True
    return points[keep]


def _all_within_two(cells: BoolArray) -> BoolArray:
    """Where a cell (n, m) and the two before and after it along the first axis are all true; false at the border."""
    result = np.zeros_like(cells)
    n = len(cells)
    if n >= 5:
        result[2:-2] = np.logical_and.reduce([cells[k : n - 4 + k] for k in range(5)])
    return result
