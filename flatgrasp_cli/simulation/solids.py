"""Solids made of boxes, ellipsoids, rods, rings and turned parts: the surface that a camera sees, and convex pieces.

Lengths are metres. A physics engine knows convex pieces only: of a ring and of a shell these are sectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray

Vector = tuple[float, float, float]
AROUND = 40
"""Sides of what is round, as Open3D's own primitives have them at this resolution."""
TURNED, SECTORS, TUBE = 60, 30, 20
"""Sides of a turned part and of a ring, convex sectors of one that is no convex body, and sides of a ring's tube."""


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles `faces` (m, 3) over `vertices` (n, 3)."""

    vertices: FloatArray
    faces: IntArray

    def moved(self, rotation: Rotation, shift: Sequence[float] | FloatArray) -> Mesh:
        """The mesh, turned about the origin and then shifted by (3,)."""
        return Mesh(rotation.apply(self.vertices) + np.asarray(shift), self.faces)


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """The `surface` of a solid, and convex `pieces` that fill it."""

    surface: Mesh
    pieces: tuple[Mesh, ...]

    def moved(self, rotation: Rotation, shift: Sequence[float] | FloatArray) -> Solid:
        """The solid, turned about the origin and then shifted by (3,)."""
        return Solid(self.surface.moved(rotation, shift), tuple(piece.moved(rotation, shift) for piece in self.pieces))


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """All meshes as one."""
    begins = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + begin for mesh, begin in zip(meshes, begins, strict=False)]
    return Mesh(np.vstack([mesh.vertices for mesh in meshes]), np.vstack(faces))


def volume(mesh: Mesh) -> float:
    """The volume that a closed mesh encloses, in cubic metres."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return float(abs(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6)


def box(size: Vector, at: Vector, yaw_deg: float = 0.0) -> Solid:
    """A box around `at`."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    return _convex(corners * size, at, yaw_deg)


def ellipsoid(radii: Vector, at: Vector, yaw_deg: float = 0.0) -> Solid:
    """An ellipsoid around `at`."""
    rings, sides = AROUND - 1, 2 * AROUND
    polar, around = np.meshgrid(np.linspace(0, np.pi, AROUND + 1)[1:-1], _angles(sides), indexing="ij")
    ball = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    vertices = np.vstack([[[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], ball.reshape(-1, 3)]) * radii
    here, there = np.arange(sides), (np.arange(sides) + 1) % sides
    first, last = 2 + here, 2 + (rings - 1) * sides + here
    caps = [np.column_stack([0 * here, first, first[there]]), np.column_stack([0 * here + 1, last[there], last])]
    bands = [
        triangles
        for above in range(2, 2 + (rings - 1) * sides, sides)
        for below in [above + sides]
        for triangles in (
            np.column_stack([below + here, above + there, above + here]),
            np.column_stack([below + here, below + there, above + there]),
        )
    ]
    mesh = Mesh(vertices, np.vstack([*caps, *bands])).moved(Rotation.from_euler("z", yaw_deg, degrees=True), at)
    return Solid(mesh, (mesh,))


def rod(radius: float, length: float, at: Vector, yaw_deg: float = 0.0, flat: float = 1.0) -> Solid:
    """A cylinder lying along x, turned by yaw about the vertical; `flat` scales its height."""
    y, z = radius * np.cos(_angles(AROUND)), flat * radius * np.sin(_angles(AROUND))
    ends = [np.column_stack([np.full(AROUND, x), y, z]) for x in (-length / 2, length / 2)]
    return _convex(np.vstack(ends), at, yaw_deg)


def capsule(radius: float, length: float) -> Solid:
    """A capsule along z around the origin: a cylinder of this length with half a ball at each end."""
    ball = ellipsoid((radius, radius, radius), (0.0, 0.0, 0.0)).surface.vertices
    shift = np.where(ball[:, 2:] > 0, 0.5, -0.5) * [0.0, 0.0, length]
    return _convex(ball + shift, (0.0, 0.0, 0.0), 0.0)


def ring(radius: float, tube: float, at: Vector) -> Solid:
    """A torus lying flat: `radius` to the middle of its tube."""
    circle = np.column_stack([radius + tube * np.cos(_angles(TUBE)), tube * np.sin(_angles(TUBE))])
    return turned(circle, [circle], at, closed=True)


def turned(
    profile: Sequence[Sequence[float]] | FloatArray,
    parts: Sequence[Sequence[Sequence[float]] | FloatArray],
    at: Vector,
    turn_deg: Vector = (0.0, 0.0, 0.0),
    *,
    closed: bool = False,
) -> Solid:
    """What a profile of (radius, height) points sweeps around z, then turned about x, y, z, and moved.

    `parts` are convex polygons of such points that fill the profile. One that reaches the axis sweeps a convex piece,
    any other is cut into sectors. `closed` joins the profile's last point to its first.
    """
    points = np.asarray(profile, dtype=np.float64)
    places = np.arange(len(points)) if closed else np.arange(len(points) - 1)
    a, b = np.arange(TURNED), (np.arange(TURNED) + 1) % TURNED
    quads = []
    for here in TURNED * places:
        there = (here + TURNED) % (TURNED * len(points))
        quads += [np.column_stack([here + a, here + b, there + b]), np.column_stack([here + a, there + b, there + a])]
    surface = Mesh(_swept(points, _angles(TURNED)), np.vstack(quads))
    pieces = [piece for part in parts for piece in _pieces(np.asarray(part, dtype=np.float64))]
    return Solid(surface, tuple(pieces)).moved(Rotation.from_euler("XYZ", turn_deg, degrees=True), at)


def _pieces(part: FloatArray) -> list[Mesh]:
    if part[:, 0].min() == 0:
        return [_hull(_swept(part, _angles(TURNED)))]
    step = 2 * np.pi / SECTORS
    return [_hull(_swept(part, np.array([k, k + 1]) * step)) for k in range(SECTORS)]


def _swept(profile: FloatArray, angles: FloatArray) -> FloatArray:
    """Points (k·n, 3) of a profile (k, 2) at n angles, one point of the profile after the other."""
    radius, height = profile[:, 0, None], np.broadcast_to(profile[:, 1, None], (len(profile), len(angles)))
    return np.stack([radius * np.cos(angles), radius * np.sin(angles), height], axis=-1).reshape(-1, 3)


def _convex(points: FloatArray, at: Vector, yaw_deg: float) -> Solid:
    hull = _hull(points).moved(Rotation.from_euler("z", yaw_deg, degrees=True), at)
    return Solid(hull, (hull,))


def _hull(points: FloatArray) -> Mesh:
    """The convex hull of points (n, 3), its faces counter-clockwise from outside."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    corners = points[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    used, faces = np.unique(faces, return_inverse=True)
    return Mesh(points[used], faces.reshape(-1, 3))


def _angles(count: int) -> FloatArray:
    """So many angles around a circle, evenly spaced from 0."""
    return np.linspace(0.0, 2 * np.pi, count, endpoint=False)
