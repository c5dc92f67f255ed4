"""α-shapes: the concave hull of a planar point set (Edelsbrunner, Kirkpatrick & Seidel, IEEE T-IT 29(4), 1983).

A Delaunay triangulation of all points would spend its time on the interior, which shapes nothing. So points are sorted
into square cells first, and only those in cells at the border are triangulated.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray

MAX_CELLS = 4_000_000
CELLS_PER_ALPHA = np.sqrt(2)
"""A disc of radius α, wherever it lies, holds a whole cell of side α/√2: the one around its centre."""


class CellGrid:
    """Points (n, 2) sorted into square cells of side α/√2, with one empty cell around them all.

    Raises
    ------
    ValueError
        If α is so small against the points' extent that the cells would not fit into memory.
    """

    def __init__(self, points: FloatArray, alpha_m: float) -> None:
        self.points = points
        columns = np.ascontiguousarray(points.T)  # (2, n): reductions run fast over a long last axis
        self._origin = columns.min(axis=1)
        self._per_metre = CELLS_PER_ALPHA / alpha_m
        width, height = (np.floor(np.ptp(columns, axis=1) * self._per_metre) + 3).tolist()
        if width * height > MAX_CELLS:
            raise ValueError(f"{width:.0f} × {height:.0f} cells")
        self.alpha_m, self.shape = alpha_m, (int(width), int(height))
        self.cell = self._cells_of(columns)
        counts = np.bincount(self.cell, minlength=self.shape[0] * self.shape[1])
        self.occupied: BoolArray = counts.reshape(self.shape) > 0

    def _cells_of(self, columns: FloatArray) -> IntArray:
        x, y = ((columns - self._origin[:, None]) * self._per_metre + 1).astype(np.intp)
        return np.asarray(x * self.shape[1] + y)

    def cells_of(self, points: FloatArray) -> IntArray:
        """Flat index (m,) of the cells in which `points` (m, 2), within the extent, lie."""
        return self._cells_of(points.T)

    @property
    def cell_area(self) -> float:
        """Area of a cell."""
        return float(self._per_metre) ** -2

    def centers(self, cells: BoolArray) -> FloatArray:
        """Centres (k, 2) of the cells that a mask of the grid's shape names."""
        return np.asarray(self._origin + (np.argwhere(cells) - 0.5) / self._per_metre)

    def interior(self) -> BoolArray:
        """Occupied cells all of whose eight neighbours are occupied."""
        inner = self.occupied.copy()
        for axis in (0, 1):
            inner &= np.roll(inner, 1, axis) & np.roll(inner, -1, axis)  # the empty rim keeps the roll harmless
        return inner

    def largest_piece(self) -> tuple[BoolArray, float]:
        """The connected cells with the most points, as a mask over the points (n,), and their share of the points."""
        from scipy.ndimage import label

        labels, _ = label(self.occupied, structure=np.ones((3, 3)))
        piece = labels.ravel()[self.cell]
        counts = np.bincount(piece)
        member = piece == np.argmax(counts)
        return member, float(counts.max() / len(piece))


def alpha_region(grid: CellGrid, member: BoolArray) -> Any:
    """The α-shape of the grid's points that `member` (n,) names, as a shapely polygon with holes; None without area.

    Triangles of the border's points belong to the shape when they are small, or when they lie over the interior.
    Border points are those with an empty cell among the eight around theirs; a point deeper in that touches an empty
    disc of radius α all the same is left out, and lies within a cell of the outline. A hole between the triangles is
    one of the object only if it holds an empty cell, as every disc of radius α does.
    """
    import shapely
    from scipy.spatial import Delaunay, QhullError

    interior = grid.interior().ravel()
    border = grid.points[member & ~interior[grid.cell]]
    try:
        mesh = Delaunay(border)
    except (QhullError, ValueError):
        return None
    triangles = border[mesh.simplices]
    kept = small_triangles(triangles, grid.alpha_m) | interior[grid.cells_of(triangles.mean(axis=1))]
    edges = border[_boundary_edges(mesh, kept)]
    area = shapely.build_area(shapely.multilinestrings(shapely.linestrings(edges)))
    pieces = shapely.get_parts(area)
    if len(pieces) == 0:
        return None
    shells = shapely.polygons(shapely.get_exterior_ring(pieces))
    largest = int(np.argmax(shapely.area(shells)))
    empty = grid.centers(~grid.occupied)
    holes = (shapely.Polygon(ring) for ring in pieces[largest].interiors)
    real = [hole.exterior for hole in holes if hole.area > grid.cell_area and shapely.contains_xy(hole, empty).any()]
    return shapely.Polygon(pieces[largest].exterior, real)


def small_triangles(triangles: FloatArray, alpha_m: float) -> BoolArray:
    """Which `triangles` (n, 3, 2) belong to the shape: circumradius at most α, or no side longer than α.

    The circumradius is the product of the sides over four times the area. The second rule is ours: a flat triangle
    between neighbours has a huge one, and leaving such out would fold a straight outline into a zigzag. It is at most
    α·(1 − √3/2) deep.
    """
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    first, second, third = (np.hypot(*(p - q).T) for p, q in ((a, b), (b, c), (c, a)))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    round_enough = first * second * third <= alpha_m * 2 * np.abs(ux * vy - uy * vx)
    return np.asarray(round_enough | (np.maximum(np.maximum(first, second), third) <= alpha_m))


def _boundary_edges(mesh: Any, kept: BoolArray) -> Any:
    """Vertex pairs (k, 2) of the edges between a kept triangle and none or one that is not kept."""
    neighbours = mesh.neighbors
    triangle, corner = np.nonzero(kept[:, None] & ((neighbours < 0) | ~kept[neighbours]))
    simplices = mesh.simplices  # side k of a simplex lies opposite its corner k
    return np.column_stack([simplices[triangle, (corner + 1) % 3], simplices[triangle, (corner + 2) % 3]])
