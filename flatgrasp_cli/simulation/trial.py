"""A trial: look at what lies on the table, plan, carry the grasp out; and what happened."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion, quaternion_from_axes, turned_about_z
from flatgrasp_cli.job import Job
from flatgrasp_cli.model import Cloud, Grasp, Pose, Source
from flatgrasp_cli.placing import placed
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import CameraPose
from flatgrasp_cli.results.numbers import numbers
from flatgrasp_cli.simulation.arm import Arm
from flatgrasp_cli.simulation.camera import scene_of, seen
from flatgrasp_cli.simulation.carriers import Carrier, Floating, missed, palm_at
from flatgrasp_cli.simulation.execution import Execution, Order, execute
from flatgrasp_cli.simulation.hands import hand_of
from flatgrasp_cli.simulation.looking import Look, look_at, look_by_arm, spot_of
from flatgrasp_cli.simulation.parts import Pads
from flatgrasp_cli.simulation.snapshots import Film, Recorder
from flatgrasp_cli.simulation.solids import Mesh
from flatgrasp_cli.simulation.things import Thing
from flatgrasp_cli.simulation.transit import go_to
from flatgrasp_cli.simulation.world import World

TABLE = Mesh(
    np.array([[x, y, 0.0] for x in (-1.5, 1.5) for y in (-1.5, 1.5)]),
    np.array([[0, 2, 1], [1, 2, 3]]),
)
PARKED_M = 0.6
"""How high over the table a floating hand waits while things come to rest."""
Status = Literal["held", "lost", "no_grasp", "collision"]


@dataclass(frozen=True, slots=True)
class Conditions:
    """What a simulation is done with, beside gripper, robot and planner.

    The pads' friction, a jaw's force and how that is known, the camera's tilt against the vertical, the standard
    deviations of the hand's place on each axis across its approach and of its turn about it, and the seed.
    """

    friction: float
    force_n: float
    tilt_deg: float
    force_from: Literal["option", "profile", "assumed"] = "profile"
    miss_m: float = 0.0
    miss_deg: float = 0.0
    seed: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """What happened: the image (h, w, 3) in the camera's frame, the plan on it, and the execution of its best grasp.

    `object` is what was to be grasped; in a heap, what was held, or the thing nearest to the grasp. Its `position` (3,)
    and `orientation` [x, y, z, w] are those in the world before the grasp. `spot` (3,) is where things were put;
    `tips` is the pose of the fingertips at the planned grasp in the world.
    """

    object: str
    number: int
    attempt: int
    mass_kg: float
    image: FloatArray
    camera: Pose
    plan: Plan
    place: Pose
    execution: Execution | None
    spot: FloatArray
    tips: Pose | None = None
    in_heap: bool = False
    film: Film | None = None

    @property
    def status(self) -> Status:
        """In a word."""
        return "no_grasp" if self.execution is None else self.execution.status

    @property
    def reason(self) -> str | None:
        """Why nothing was held; None where something was."""
        return self.plan.reason if self.execution is None else self.execution.reason


class Cell:
    """Where trials take place: the hand, what carries it, where things are put; and the planner that is tried."""

    def __init__(self, job: Job, conditions: Conditions) -> None:
        self.job, self.conditions = job, conditions
        self.recorder: Recorder | None = None
        """What records trials for pictures and films, while it is there."""
        self.gripper, self.robot = job.gripper, job.workcell.robot
        self.hand = hand_of(self.gripper, Pads(conditions.friction, conditions.force_n))
        self.spot = spot_of(self.robot)

    def world(self, things: list[Thing]) -> World:
        """A scene of things with the hand; it is used again for all trials with them."""
        carrier: Carrier = Floating() if self.robot is None else Arm(self.robot, self.gripper)
        return World(things, carrier, self.hand)

    def look(self, rng: np.random.Generator) -> Look:
        """Where the camera looks from in the next trial."""
        tilt, azimuth = np.radians(self.conditions.tilt_deg), rng.uniform(-np.pi, np.pi)
        if self.robot is None:
            return look_at(self.spot, tilt, azimuth)
        return look_by_arm(self.robot, self.gripper, self.spot, tilt, azimuth)

    def parked(self, look: Look) -> FloatArray:
        """The carrier's control while the camera looks."""
        if look.joints is not None:
            return look.joints
        above = Pose(self.spot + np.array([0.0, 0.0, PARKED_M]), np.array([1.0, 0.0, 0.0, 0.0]))
        return np.asarray(Floating().controls([above])[0])

    def planned(self, image: FloatArray, look: Look, name: str) -> Plan:
        """The plan on what the camera sees, as `plan` makes it of the same cloud in a file."""
        cloud = Cloud(image, source=Source(name))
        return self.job.plan(placed(cloud, self.job.workcell.base_frame, self.camera_pose(look)))

    def camera_pose(self, look: Look) -> CameraPose | None:
        """Where the camera is in the arm's base frame, as a document has it; None without an arm.

        Answers are then in the camera's own frame.
        """
        if self.robot is None:
            return None
        place, turn = numbers(look.camera.origin), numbers(quaternion_from_axes(look.camera.axes))
        return CameraPose(position_m=tuple(place), orientation_xyzw=tuple(turn))


def attempt(cell: Cell, world: World, look: Look, rng: np.random.Generator, names: tuple[int, int]) -> Trial:
    """Look, plan and grasp once in a scene that is at rest, its hand parked; `names` are the trial's and its own."""
    places = [world.pose(number) for number in world.present]
    surfaces = [
        world.things[k].surface.moved(turn, where) for k, (where, turn) in zip(world.present, places, strict=True)
    ]
    image = seen(scene_of([TABLE, *surfaces]), look.camera, rng).astype(np.float32).astype(np.float64)
    plan = cell.planned(image, look, f"trial {names[0]}")
    if cell.recorder is not None:
        cell.recorder.watch(world)
    best = plan.best
    around = cell.spot if best is None else _in_world(cell, look).to_world(best.contacts).mean(axis=0)
    target = _nearest(world, around)
    before = {number: Pose(where, turn.as_quat()) for number, (where, turn) in zip(world.present, places, strict=True)}
    execution = None if best is None else carried_out(cell, world, look, rng, best)
    if execution is not None and execution.thing is not None:
        target = execution.thing
    return Trial(
        object=world.things[target].name,
        number=names[0],
        attempt=names[1],
        mass_kg=world.things[target].mass_kg,
        image=image,
        camera=Pose(look.camera.origin, quaternion_from_axes(look.camera.axes)),
        plan=plan,
        place=before[target],
        execution=execution,
        spot=cell.spot,
        tips=None if best is None else _tips(cell, look, best.way.tips.pose),
        in_heap=len(world.things) > 1,
        film=cell.recorder.film() if cell.recorder else None,
    )


def _in_world(cell: Cell, look: Look) -> Frame:
    """The frame of the plan in the world."""
    return look.camera if cell.robot is None else Frame(np.zeros(3), np.eye(3))


def _tips(cell: Cell, look: Look, planned: Pose) -> Pose:
    """A planned pose in the world."""
    frame = _in_world(cell, look)
    axes = axes_from_quaternion(planned.orientation) @ frame.axes
    return Pose(frame.to_world(planned.position), quaternion_from_axes(axes))


def _nearest(world: World, place: FloatArray) -> int:
    """The thing whose centre is nearest to a place."""
    distances = np.linalg.norm(world.centers() - place, axis=1)
    return min(world.present, key=lambda number: float(distances[number]))


def carried_out(cell: Cell, world: World, look: Look, rng: np.random.Generator, grasp: Grasp) -> Execution:
    """Go to the pre-grasp and carry the grasp out, by a hand that misses as the conditions have it."""
    shift = cell.conditions.miss_m * rng.normal(size=2)
    yaw = np.radians(cell.conditions.miss_deg) * rng.normal()
    length = cell.gripper.finger_length_at_m(grasp.width_m)
    twin = 180.0 if grasp.reach is not None and grasp.reach.twin else 0.0

    def palm(tips: Pose) -> Pose:
        at = palm_at(missed(_tips(cell, look, tips), shift, yaw), length)
        return Pose(at.position, turned_about_z(at.orientation, twin))

    tips = grasp.way.tips
    order = Order(
        pre_grasp=palm(tips.pre_grasp),
        grasp=palm(tips.pose),
        lift=palm(tips.lift),
        opening_m=grasp.opening_m,
        back_first=grasp.way.back_first,
    )
    joints = None if grasp.reach is None else grasp.reach.joints_rad
    hit = go_to(world, order, cell.parked(look), None if joints is None else joints[0])
    return hit or execute(world, order)
