"""What is grasped in a simulation: a surface for the camera, convex pieces for the physics, a mass, and its rests."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.simulation.samples import SAMPLES
from flatgrasp_cli.simulation.solids import Mesh, joined, volume

DENSITY_KG_M3 = 400.0
"""Of a mesh whose mass nobody states: from 200 for a toy, part hollow, to 1000 for a full bottle."""
LEAST_SHARE = 0.01
"""Rests that a thing comes to in fewer falls are left out, as a pan's on its rim."""


@dataclass(frozen=True, slots=True, eq=False)
class Rest:
    """A way to lie on a table: which direction (3,) of the thing points down, and in what share of falls it does."""

    down: FloatArray
    share: float


@dataclass(frozen=True, eq=False)
class Thing:
    """An object of a simulation, in a frame of its own.

    `surface` is what a camera sees, `pieces` are convex and fill it; the mass is theirs by volume.
    """

    name: str
    surface: Mesh
    pieces: tuple[Mesh, ...]
    mass_kg: float

    @cached_property
    def masses_kg(self) -> FloatArray:
        """The mass (k,) of each piece."""
        volumes = np.array([volume(piece) for piece in self.pieces])
        return np.asarray(self.mass_kg * volumes / volumes.sum())

    @cached_property
    def center(self) -> FloatArray:
        """The centre of mass (3,)."""
        centers = np.array([_centroid(piece) for piece in self.pieces])
        return np.asarray(self.masses_kg @ centers / self.mass_kg)

    @cached_property
    def rests(self) -> tuple[Rest, ...]:
        """The ways in which it may lie, the likeliest first."""
        return rests(np.vstack([piece.vertices for piece in self.pieces]), self.center)


def sample_thing(name: str, mass_kg: float | None = None) -> Thing:
    """One of the paper's objects, by its name in `SAMPLES`, with its own mass if none is stated."""
    sample = SAMPLES[name]
    solids = sample.solids()
    pieces = tuple(piece for solid in solids for piece in solid.pieces)
    return Thing(name, joined([solid.surface for solid in solids]), pieces, mass_kg or sample.mass_kg)


def mesh_thing(name: str, surface: Mesh, pieces: tuple[Mesh, ...], mass_kg: float | None = None) -> Thing:
    """A thing of a mesh and of convex pieces that fill it; of middling density if no mass is stated."""
    return Thing(name, surface, pieces, mass_kg or DENSITY_KG_M3 * sum(map(volume, pieces)))


def rests(vertices: FloatArray, center: FloatArray) -> tuple[Rest, ...]:
    """The ways in which a body with `vertices` (n, 3) and this centre of mass (3,) may lie, the likeliest first.

    It stands on those facets of its convex hull that have the centre above them, and falls on each in the share of the
    solid angle that the facet fills as seen from the centre; a body that first falls on another facet rolls on.
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(vertices)
    normals = hull.equations[:, :3]
    corners = vertices[hull.simplices] - center
    _, facet = np.unique(np.round(hull.equations, 5), axis=0, return_inverse=True)
    facet = facet.reshape(-1)
    stable = np.bincount(facet, weights=_above(corners, normals)) > 0
    angles = np.bincount(facet, weights=_solid_angles(corners)) * stable
    shares = angles / angles.sum()
    order = [k for k in np.argsort(-shares, kind="stable") if shares[k] >= min(LEAST_SHARE, shares.max())]
    total = shares[order].sum()
    first = {int(k): int(np.flatnonzero(facet == k)[0]) for k in order}
    return tuple(Rest(normals[first[int(k)]], float(shares[k] / total)) for k in order)


def _above(corners: FloatArray, normals: FloatArray) -> FloatArray:
    """Whether the origin lies above each of n triangles, with corners (n, 3, 3) and outward normals (n, 3)."""
    foot = np.einsum("ij,ij->i", corners[:, 0], normals)[:, None] * normals
    edges = np.roll(corners, -1, axis=1) - corners
    sides = np.einsum("ikj,ij->ik", np.cross(edges, foot[:, None] - corners), normals)
    return np.asarray(((sides >= 0).all(axis=1) | (sides <= 0).all(axis=1)).astype(np.float64))


def _solid_angles(corners: FloatArray) -> FloatArray:
    """Solid angles (n,) of triangles (n, 3, 3) as seen from the origin: Van Oosterom & Strackee 1983."""
    a, b, c = np.moveaxis(corners, 1, 0)
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    volume = np.abs(np.einsum("ij,ij->i", a, np.cross(b, c)))
    below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return np.asarray(2 * np.arctan2(volume, below))


def laid(rest: Rest, yaw_rad: float) -> Rotation:
    """The rotation that lays a thing into a rest, and then turns it about the vertical."""
    onto, _ = Rotation.align_vectors([[0.0, 0.0, -1.0]], [rest.down])
    return Rotation.from_euler("z", yaw_rad) * onto


def _centroid(mesh: Mesh) -> FloatArray:
    corners = mesh.vertices[mesh.faces] - mesh.vertices[0]
    a, b, c = np.moveaxis(corners, 1, 0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    return np.asarray(mesh.vertices[0] + (volumes[:, None] * corners.sum(axis=1)).sum(axis=0) / (4 * volumes.sum()))
