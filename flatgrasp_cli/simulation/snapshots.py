"""What a world looks like at moments of a trial: the solids in it, and where each of them is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.simulation.arm import Arm
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.looking import BESIDE_M
from flatgrasp_cli.simulation.parts import Kind
from flatgrasp_cli.simulation.solids import Mesh, box, capsule
from flatgrasp_cli.simulation.world import World

FRAME_S = 0.08
"""Time between two moments: a film of twelve pictures a second."""

HOUSING_M = (0.035, 0.18, 0.05)
"""The Xtion's, along x and y of the hand and back from its optical centre."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A solid of a scene: its mesh in the frame of a body, by the body's number, and what it is part of."""

    mesh: Mesh
    body: int
    kind: Kind


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """Where the bodies (n) of a world are: positions (n, 3), and rotations (n, 3, 3) whose columns are their axes."""

    positions: FloatArray
    rotations: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """The solids of a scene, and where they were from the look to the end of a trial."""

    shapes: tuple[Shape, ...]
    snapshots: tuple[Snapshot, ...]


class Recorder:
    """Takes snapshots of a world while it moves, evenly in time."""

    def __init__(self) -> None:
        self._shapes: tuple[Shape, ...] = ()
        self._snapshots: list[Snapshot] = []
        self._world: World | None = None
        self._next_s = 0.0

    def watch(self, world: World) -> None:
        """Begin with a world as it is now."""
        self._shapes, self._snapshots = shapes_of(world), []
        self._world, self._next_s = world, 0.0
        world.watch = self
        self()

    def __call__(self) -> None:
        """Take a snapshot if it is time to."""
        if self._world is None:
            return
        data = self._world.data
        if data.time < self._next_s and self._snapshots:
            return
        self._next_s = data.time + FRAME_S
        self._snapshots.append(Snapshot(data.xpos.copy(), data.xmat.reshape(-1, 3, 3).copy()))

    def film(self) -> Film:
        """What was recorded since the watch began."""
        return Film(self._shapes, tuple(self._snapshots))


def shapes_of(world: World) -> tuple[Shape, ...]:
    """All solids of a world: of things the surface that a camera sees."""
    model = world.model
    things = {model.body(f"thing{k}").id: thing for k, thing in enumerate(world.things)}
    shapes = [Shape(thing.surface, body, Kind.THING) for body, thing in things.items()]
    for geom in range(model.ngeom):
        body, kind = int(model.geom_bodyid[geom]), Kind(int(model.geom_group[geom]))
        if kind is not Kind.THING:
            shapes.append(Shape(_mesh_of(model, geom), body, kind))
    if isinstance(world.carrier, Arm):
        housing = box(HOUSING_M, (BESIDE_M, 0.0, -world.carrier.palm_offset_m - 0.5 * HOUSING_M[2])).surface
        shapes.append(Shape(housing, int(model.body("hand").id), Kind.CAMERA))
    return tuple(shapes)


def _mesh_of(model: Any, geom: int) -> Mesh:
    """The mesh of a box or a capsule in the frame of its body."""
    size, place, turn = model.geom_size[geom], model.geom_pos[geom], model.geom_quat[geom]
    is_box = model.geom_type[geom] == load_mujoco().mjtGeom.mjGEOM_BOX
    solid = box(tuple(2 * size), (0.0, 0.0, 0.0)) if is_box else capsule(float(size[0]), 2 * float(size[1]))
    return solid.surface.moved(Rotation.from_quat(np.roll(turn, -1)), place)


def placed(shapes: tuple[Shape, ...], at: Snapshot) -> list[Mesh]:
    """The meshes of shapes in the world."""
    return [
        Mesh(shape.mesh.vertices @ at.rotations[shape.body].T + at.positions[shape.body], shape.mesh.faces)
        for shape in shapes
    ]
