"""A mesh as a cloud: its surface, sampled evenly, as if it had been seen from all sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model import Cloud, CloudWarning, Sensor, Source
from flatgrasp_cli.model.clouds import LARGEST_COORDINATE_M
from flatgrasp_cli.sources.meshes.triangles import triangulated

PITCH_M = 1e-3
"""Points of a mesh lie about as far apart as those of a depth camera that looks at an object on a table."""
ACROSS = 100
"""Points across a mesh of less than a hundred pitches, for silhouettes have to tell its fingers from its palm, too."""
MOST_POINTS = 200_000
"""As many as two thirds of a VGA image."""
SPREAD = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of the most even sequence in the square (M. Roberts 2018): 1/g and 1/g², of g³ = g + 1."""
UNLIKELY_SIZE_M = 5.0
SIZE_WARNING = CloudWarning(
    "mesh_size",
    "The mesh is more than 5 m long if its unit is the metre; --scale 0.001 says that it is the millimetre.",
)


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """What a mesh file holds: polygons over `vertices` (n, 3), in the file's own unit.

    `corners` are indices, those of all polygons one after another, of which each polygon has `sizes` (k,).
    """

    vertices: NDArray[np.number]
    corners: NDArray[np.number]
    sizes: IntArray


def polygon_cloud(polygons: Polygons, name: str, scale: float = 1.0) -> Cloud:
    """The surface of polygons; without polygons, the vertices.

    Raises
    ------
    SourceError
        If a polygon names a vertex that is not there or not finite, or the polygons have no area.
    """
    if len(polygons.sizes) == 0:
        return Cloud(_places(polygons, name, scale), source=Source(name))
    places, triangles = surface(polygons, name, scale)
    points = sampled_surface(places[triangles], name)
    warnings = (SIZE_WARNING,) if np.ptp(points, axis=0).max() > UNLIKELY_SIZE_M else ()
    sensor = Sensor("all_sides", None, np.array([0.0, 0.0, 1.0]))
    return Cloud(points, source=Source(name), sensor=sensor, warnings=warnings)


def surface(polygons: Polygons, name: str, scale: float = 1.0) -> tuple[FloatArray, IntArray]:
    """The vertices (n, 3) in metres, and the triangles (m, 3) over them.

    Raises
    ------
    SourceError
        If a polygon names a vertex that is not there or not finite, or crosses itself.
    """
    places, corners = _places(polygons, name, scale), polygons.corners
    whole = corners.astype(np.intp) if _in_range(corners, len(places)) else None
    if whole is None:
        wrong = corners[~((corners >= 0) & (corners < len(places)) & (corners == np.floor(corners)))][0]
        raise SourceError(f"{name}: a face names vertex {wrong:g}, counted from 0; there are {len(places)} vertices")
    used = np.zeros(len(places), dtype=np.bool_)
    used[whole] = True
    if not (np.abs(places[used]) <= LARGEST_COORDINATE_M).all():
        raise SourceError(f"{name}: a face has a corner that is not finite, or farther away than 10 km")
    return places, triangulated(places, whole, polygons.sizes, name)


def _places(polygons: Polygons, name: str, scale: float) -> FloatArray:
    """The vertices in metres."""
    if len(polygons.vertices) == 0:
        raise SourceError(f"{name}: the file has no vertices")
    with np.errstate(invalid="ignore", over="ignore"):  # NaN of some kinds warn when they are converted
        return np.asarray(scale * polygons.vertices.astype(np.float64))


def _in_range(corners: NDArray[np.number], count: int) -> bool:
    with np.errstate(invalid="ignore"):
        return bool(((corners >= 0) & (corners < count) & (corners == np.floor(corners))).all())


def sampled_surface(triangles: FloatArray, name: str) -> FloatArray:
    """Points (n, 3) spread evenly over `triangles` (m, 3, 3), the same for the same triangles.

    Equal shares of the area get a point each, and within a triangle they follow a sequence that leaves no gaps, so
    that a silhouette is as smooth as that of a depth image.

    Raises
    ------
    SourceError
        If the triangles have no area.
    """
    origin, sides = triangles[:, 0], triangles[:, 1:] - triangles[:, :1]
    areas = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    reached = np.cumsum(areas)
    extent = float(np.ptp(triangles.reshape(-1, 3), axis=0).max()) if len(triangles) else 0.0
    if not extent > 0 or not reached[-1] > 1e-12 * extent**2:
        raise SourceError(f"{name}: the mesh has no faces with an area")
    pitch = min(PITCH_M, extent / ACROSS)
    count = int(min(max(reached[-1] / pitch**2, 1.0), MOST_POINTS))
    k = np.arange(count)
    chosen = np.searchsorted(reached, (k + 0.5) * (reached[-1] / count)).clip(max=len(areas) - 1)
    shares = (0.5 + k[:, None] * SPREAD) % 1.0
    beyond = shares.sum(axis=1) > 1.0  # the other half of the parallelogram
    shares[beyond] = 1.0 - shares[beyond]
    return np.asarray(origin[chosen] + np.einsum("ij,ijk->ik", shares, sides[chosen]))
