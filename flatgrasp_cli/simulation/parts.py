"""The parts that every simulated scene is made of: the table, the things on it, and what a hand is made of.

Geometries carry a kind in their `group`, so that a contact tells what met what. The hand and the arm do not collide
with themselves: they never meet on a planned path, and their boxes and capsules overlap at the joints.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.things import Thing

TIME_STEP_S = 0.001
TABLE_HALF_M = (1.5, 1.5, 0.02)
TABLE_FRICTION = 0.5
"""Of wood or plastic on wood."""
TORSION_M = 0.005
"""Arm at which a pad's friction at a point bears torsion: two thirds of the radius of the patch, 7.5 mm, that a pad of
rubber two centimetres wide makes of the point. Flat faces meet in several points, which bear more between them."""
ROLLING_M = 1e-4
CONTACT_TIME_S = 0.004
"""Time constant of a contact, four time steps: of less than two it would not be stable."""
SLIP_RATIO = 10.0
"""How much stiffer friction is than the normal direction: with 1 what is held creeps out of the fingers."""


class Kind(IntEnum):
    """What a geometry is part of."""

    TABLE = 0
    THING = 1
    FINGER = 2
    PALM = 3
    ARM = 4
    CAMERA = 5
    """In pictures only: the camera meets nothing."""


NAMES = {
    Kind.TABLE: "the table",
    Kind.THING: "the object",
    Kind.FINGER: "the fingers",
    Kind.PALM: "the palm",
    Kind.ARM: "the arm",
}


@dataclass(frozen=True, slots=True)
class Pads:
    """What the fingers press with: friction on things, and the force of one jaw in newtons."""

    friction: float
    force_n: float


@dataclass(frozen=True, slots=True)
class Servo:
    """A motor that goes to a position: its largest force, how far off it gives that, and the inertia it moves.

    Newtons and metres, or newton metres and radians.
    """

    most: float
    off_by: float
    inertia: float


def add_servo(spec: Any, target: str, transmission: Any, servo: Servo) -> Any:
    """Add a servo, named as the joint or tendon that it drives; it is damped so that it does not overshoot."""
    motor = spec.add_actuator(name=target, target=target, trntype=transmission)
    stiffness = servo.most / servo.off_by
    motor.gainprm[0], motor.biastype = stiffness, load_mujoco().mjtBias.mjBIAS_AFFINE
    motor.biasprm[1], motor.biasprm[2] = -stiffness, -2 * math.sqrt(stiffness * servo.inertia)
    motor.forcerange, motor.forcelimited = [-servo.most, servo.most], True
    return motor


def empty_scene() -> Any:
    """A specification with a table whose top is z = 0, and the settings of the engine."""
    mujoco = load_mujoco()
    spec = mujoco.MjSpec()
    spec.option.timestep = TIME_STEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = SLIP_RATIO
    add_box(spec.worldbody, TABLE_HALF_M, (0.0, 0.0, -TABLE_HALF_M[2]), Kind.TABLE, friction=TABLE_FRICTION)
    return spec


def add_thing(spec: Any, thing: Thing, name: str) -> None:
    """Add a thing that moves freely."""
    mujoco = load_mujoco()
    body = spec.worldbody.add_body(name=name)
    body.add_freejoint(name=name)
    for number, (piece, mass) in enumerate(zip(thing.pieces, thing.masses_kg, strict=True)):
        mesh = f"{name}.{number}"
        faces = piece.faces.astype(np.int32).ravel()
        spec.add_mesh(name=mesh, uservert=piece.vertices.astype(np.float32).ravel(), userface=faces)
        geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh, mass=mass)
        _touching(geom, Kind.THING, TABLE_FRICTION)


def add_box(
    body: Any, half: Sequence[float], at: Sequence[float], kind: Kind, *, friction: float = 1.0, mass_kg: float = 0.1
) -> None:
    """Add a box of half sizes (3,) to a body of the hand or to the world."""
    geom = body.add_geom(type=load_mujoco().mjtGeom.mjGEOM_BOX, size=list(half), pos=list(at), mass=mass_kg)
    _touching(geom, kind, friction)


def add_capsule(body: Any, ends: tuple[FloatArray, FloatArray], radius_m: float, kind: Kind, mass_kg: float) -> None:
    """Add a capsule between two `ends` (3,) to a body of the arm."""
    geom = body.add_geom(
        type=load_mujoco().mjtGeom.mjGEOM_CAPSULE, size=[radius_m, 0, 0], fromto=[*ends[0], *ends[1]], mass=mass_kg
    )
    _touching(geom, kind, 1.0)


def _touching(geom: Any, kind: Kind, friction: float) -> None:
    """Make a geometry collide as its kind does: the robot with all but itself, whose friction is the fingers' own."""
    robot = kind in (Kind.FINGER, Kind.PALM, Kind.ARM)
    geom.group = int(kind)
    geom.contype, geom.conaffinity = (2, 1) if robot else (1, 1)
    geom.priority = int(robot)
    geom.condim = 4
    geom.friction = [friction, TORSION_M * friction, ROLLING_M]
    geom.solref = [CONTACT_TIME_S, 1.0]
