"""Solids have the volumes, the centres and the rests that can be worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flatgrasp_cli.simulation.meshes import convex_pieces
from flatgrasp_cli.simulation.samples import SAMPLES
from flatgrasp_cli.simulation.solids import Mesh, Solid, box, ellipsoid, joined, ring, rod, turned, volume
from flatgrasp_cli.simulation.things import Thing, laid, mesh_thing, rests, sample_thing

L_SHAPE = [box((0.06, 0.02, 0.02), (0.0, 0.0, 0.0)), box((0.02, 0.04, 0.02), (-0.02, 0.03, 0.0))]


def thing_of(*solids: Solid, mass_kg: float = 0.3) -> Thing:
    pieces = tuple(piece for solid in solids for piece in solid.pieces)
    return Thing("test", joined([solid.surface for solid in solids]), pieces, mass_kg)


@pytest.mark.parametrize(
    ("solid", "expected", "rel"),
    [
        (box((0.1, 0.2, 0.3), (1, 2, 3), 30), 0.006, 1e-9),
        (ellipsoid((0.03, 0.04, 0.05), (0, 0, 0), 20), 4 / 3 * np.pi * 0.03 * 0.04 * 0.05, 0.01),
        (rod(0.02, 0.3, (0, 0, 0), 45, 0.5), np.pi * 0.02**2 * 0.5 * 0.3, 0.01),
        (ring(0.05, 0.01, (0, 0, 0)), 2 * np.pi**2 * 0.05 * 0.01**2, 0.03),
        (
            turned([(0, 0), (0.03, 0), (0, 0.06)], [[(0, 0), (0.03, 0), (0, 0.06)]], (0, 0, 0)),
            np.pi * 0.03**2 * 0.02,
            0.01,
        ),
    ],
    ids=["box", "ellipsoid", "rod", "ring", "cone"],
)
def test_pieces_fill_what_the_surface_encloses(solid: Solid, expected: float, rel: float) -> None:
    assert volume(solid.surface) == pytest.approx(expected, rel=rel)
    assert sum(volume(piece) for piece in solid.pieces) == pytest.approx(expected, rel=rel)


@pytest.mark.parametrize("name", SAMPLES)
def test_every_sample_lies_on_the_table_and_can_lie_in_some_way(name: str) -> None:
    thing = sample_thing(name)
    assert thing.surface.vertices[:, 2].min() == pytest.approx(0.0, abs=3e-3)
    assert thing.masses_kg.sum() == pytest.approx(SAMPLES[name].mass_kg)
    assert sum(rest.share for rest in thing.rests) == pytest.approx(1.0)
    pieces = np.vstack([piece.vertices for piece in thing.pieces])
    assert np.ptp(pieces, axis=0) == pytest.approx(np.ptp(thing.surface.vertices, axis=0), abs=2e-3)


def test_a_bent_part_has_its_centre_of_mass_beside_it() -> None:
    center = thing_of(*L_SHAPE).center
    assert center == pytest.approx([-0.02 * 16 / 40, 0.03 * 16 / 40, 0.0])  # volumes 24 and 16 cm³


def test_a_cube_falls_on_each_face_alike_and_a_slab_rather_on_its_large_ones() -> None:
    cube = thing_of(box((0.05, 0.05, 0.05), (0, 0, 0)))
    assert [rest.share for rest in cube.rests] == pytest.approx([1 / 6] * 6)
    slab = thing_of(box((0.10, 0.08, 0.02), (0, 0, 0)))
    large = [rest for rest in slab.rests if abs(rest.down[2]) > 0.99]
    # the solid angle of a rectangle a × b at a distance d: 4 atan(a b / (d √(4 d² … ))), by its half sides
    a, b, d = 0.05, 0.04, 0.01
    angle = 4 * np.arctan(a * b / (d * np.sqrt(a * a + b * b + d * d)))
    assert [rest.share for rest in large] == pytest.approx([angle / (4 * np.pi)] * 2)


def test_what_would_topple_is_no_rest() -> None:
    """The tower leans: its centre is not above its foot."""
    lean = Rotation.from_euler("y", 30, degrees=True)
    slab = box((0.02, 0.02, 0.10), (0, 0, 0))
    foot = np.array([[-0.01, -0.01, 0], [0.01, -0.01, 0], [0.01, 0.01, 0], [-0.01, 0.01, 0]])
    vertices = np.vstack([lean.apply(slab.surface.vertices + np.array([0, 0, 0.06])), foot])
    found = rests(vertices, lean.apply([0.0, 0.0, 0.06]))
    assert not any(rest.down[2] < -0.99 for rest in found)


def test_laying_turns_the_rest_down_and_then_about_the_vertical() -> None:
    rest = thing_of(*L_SHAPE).rests[0]
    for yaw in (0.0, 1.0, -2.5):
        assert laid(rest, yaw).apply(rest.down) == pytest.approx([0, 0, -1], abs=1e-6)
    turn = laid(rest, 1.0) * laid(rest, 0.0).inv()
    assert turn.as_rotvec() == pytest.approx([0, 0, 1.0], abs=1e-6)


def test_a_mesh_is_cut_into_convex_pieces_always_alike() -> None:
    corners = [(-0.03, -0.01), (0.03, -0.01), (0.03, 0.01), (-0.01, 0.01), (-0.01, 0.05), (-0.03, 0.05)]
    n = len(corners)
    vertices = np.array([[x, y, z] for z in (0.0, 0.02) for x, y in corners])
    caps = [[0, 3, 1], [1, 3, 2], [0, 4, 3], [0, 5, 4]]
    walls = [[k, (k + 1) % n, (k + 1) % n + n] for k in range(n)] + [[k, (k + 1) % n + n, k + n] for k in range(n)]
    faces = np.array([*caps, *[[a + n, c + n, b + n] for a, b, c in caps], *walls])
    surface = Mesh(vertices, faces)
    assert volume(surface) == pytest.approx(4e-5)
    pieces = convex_pieces(surface)
    assert len(pieces) == 2
    assert sum(map(volume, pieces)) == pytest.approx(4e-5, rel=0.03)
    again = convex_pieces(surface)
    assert all((one.vertices == other.vertices).all() for one, other in zip(pieces, again, strict=True))
    assert mesh_thing("l", surface, pieces).mass_kg == pytest.approx(400 * 4e-5, rel=0.03)
