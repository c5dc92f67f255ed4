"""A compiled scene: things on a table, a hand and what carries it; where all of it is, and what touches what."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.simulation.carriers import Carrier
from flatgrasp_cli.simulation.engine import load_mujoco
from flatgrasp_cli.simulation.hands import Hand
from flatgrasp_cli.simulation.parts import TIME_STEP_S, Kind, add_thing, empty_scene
from flatgrasp_cli.simulation.things import Thing

STILL_M_S = 0.01
"""What moves more slowly is at rest: a contact's own creep is less."""
STILL_STEPS = 50
"""Steps for which a thing must be slow to be at rest: one that tips over is slow for a moment."""
AWAY_M = np.array([5.0, 0.0, -1.0])
"""Where a thing waits that was taken out of the scene."""


class Touch(NamedTuple):
    """A part of the robot, and what it touches."""

    part: Kind
    what: Kind


class World:
    """A scene of `things`, with a hand and its carrier, in the world's frame: z up, the table's top z = 0."""

    def __init__(self, things: Sequence[Thing], carrier: Carrier, hand: Hand) -> None:
        """Compile the scene; raises `UsageError` where the engine refuses what things, arm or hand are like."""
        mujoco = load_mujoco()
        spec = empty_scene()
        self._names = [f"thing{number}" for number in range(len(things))]
        for thing, name in zip(things, self._names, strict=True):
            add_thing(spec, thing, name)
        hand.add(spec, carrier.add(spec))
        try:
            self.model = spec.compile()
        except ValueError as error:
            raise UsageError(f"MuJoCo cannot simulate this: {' '.join(str(error).split())}") from error
        self.data = mujoco.MjData(self.model)
        self.things, self.carrier, self.hand = tuple(things), carrier, hand
        self.watch: Callable[[], None] | None = None
        """Called after every step, if there is one to watch."""
        self._step = mujoco.mj_step
        self._motor = self.model.actuator(hand.actuator).id
        self._bodies = np.array([self.model.body(name).id for name in self._names], dtype=np.intp)
        self._collides = self.model.geom_contype.copy(), self.model.geom_conaffinity.copy()

    def reset(self, control: FloatArray, opening_m: float) -> None:
        """Put the hand at a control and an opening, and everything at rest; all things are in the scene again."""
        mujoco = load_mujoco()
        mujoco.mj_resetData(self.model, self.data)
        self.model.geom_contype[:], self.model.geom_conaffinity[:] = self._collides
        self.model.body_gravcomp[self._bodies] = 0.0
        self.place(control, opening_m)

    def place(self, control: FloatArray, opening_m: float) -> None:
        """Put the hand, at rest, at a control and an opening."""
        self.carrier.place(self.model, self.data, control)
        for joint, position in self.hand.positions(opening_m).items():
            self.data.qpos[self.model.joint(joint).qposadr[0]] = position
            self.data.qvel[self.model.joint(joint).dofadr[0]] = 0.0
        self.data.ctrl[self._motor] = self.hand.control(opening_m)
        load_mujoco().mj_forward(self.model, self.data)

    def put(self, number: int, position: FloatArray, turn: Rotation) -> None:
        """Put a thing at a place (3,), at rest."""
        joint = self.model.joint(self._names[number])
        begin, speed = joint.qposadr[0], joint.dofadr[0]
        self.data.qpos[begin : begin + 7] = [*position, *np.roll(turn.as_quat(), 1)]
        self.data.qvel[speed : speed + 6] = 0.0

    @property
    def present(self) -> list[int]:
        """The numbers of the things that are in the scene."""
        return [number for number, body in enumerate(self._bodies) if self.model.body_gravcomp[body] == 0.0]

    def remove(self, number: int) -> None:
        """Take a thing out of the scene: it floats where nothing meets it."""
        geoms = self.model.geom_bodyid == self._bodies[number]
        self.model.geom_contype[geoms] = self.model.geom_conaffinity[geoms] = 0
        self.model.body_gravcomp[self._bodies[number]] = 1.0
        self.put(number, AWAY_M + np.array([float(number), 0.0, 0.0]), Rotation.identity())

    def restore(self, number: int) -> None:
        """Let a thing take part again."""
        geoms = self.model.geom_bodyid == self._bodies[number]
        for kept, now in zip(self._collides, (self.model.geom_contype, self.model.geom_conaffinity), strict=True):
            now[geoms] = kept[geoms]
        self.model.body_gravcomp[self._bodies[number]] = 0.0

    def top(self) -> float:
        """How high the highest point of a thing in the scene is."""
        spans = (self.things[k].surface.moved(turn, at) for k in self.present for at, turn in [self.pose(k)])
        return max(float(mesh.vertices[:, 2].max()) for mesh in spans)

    def pose(self, number: int) -> tuple[FloatArray, Rotation]:
        """Where a thing is: the position (3,) of its own frame, and its rotation."""
        begin = self.model.joint(self._names[number]).qposadr[0]
        state = self.data.qpos[begin : begin + 7]
        return state[:3].copy(), Rotation.from_quat(np.roll(state[3:], -1))

    def centers(self) -> FloatArray:
        """Where the things' centres of mass are: (n, 3)."""
        return np.array(self.data.xipos[self._bodies])

    def settle(self, most_s: float) -> None:
        """Let everything come to rest, within so many seconds at most."""
        slow = 0
        for _ in range(round(most_s / TIME_STEP_S)):
            self._step(self.model, self.data)
            still = np.abs(self.data.cvel[self._bodies]).max(initial=0.0) < STILL_M_S
            slow = slow + 1 if still else 0
            if slow > STILL_STEPS:
                return

    def follow(self, controls: FloatArray, seconds: float, closing: tuple[float, float] | None = None) -> None:
        """Drive along controls (n, k) at an even pace.

        `closing` are the motor's controls at the beginning and at the end; None leaves it as it is.
        """
        steps = max(round(seconds / TIME_STEP_S), 1)
        for share in (np.arange(steps) + 1) / steps:
            if closing is not None:
                self.data.ctrl[self._motor] = closing[0] + share * (closing[1] - closing[0])
            self._drive(controls, share)

    def ease(self, controls: FloatArray, seconds: float) -> set[Touch]:
        """Drive along controls (n, k), slowly at both ends; returns what the robot touched on the way."""
        steps = max(round(seconds / TIME_STEP_S), 1)
        touched: set[Touch] = set()
        for share in (np.arange(steps) + 1) / steps:
            self._drive(controls, share * share * (3 - 2 * share))
            touched |= self.touched()
        return touched

    def _drive(self, controls: FloatArray, share: float) -> None:
        """One step with the carrier told to be at a share of a way."""
        place = share * (len(controls) - 1)
        before = min(int(place), max(len(controls) - 2, 0))
        after = min(before + 1, len(controls) - 1)
        self.carrier.drive(self.data, controls[before] + (place - before) * (controls[after] - controls[before]))
        self._step(self.model, self.data)
        if self.watch is not None:
            self.watch()

    @property
    def unstable(self) -> bool:
        """Whether the physics gave nonsense since the last reset, and began anew."""
        bad = load_mujoco().mjtWarning
        kinds = (bad.mjWARN_BADQPOS, bad.mjWARN_BADQVEL, bad.mjWARN_BADQACC)
        return any(self.data.warning[int(kind)].number > 0 for kind in kinds)

    def touched(self) -> set[Touch]:
        """What the robot touches now."""
        if self.data.ncon == 0:
            return set()
        contacts = self.data.contact
        kinds = self.model.geom_group[contacts.geom[contacts.dist < 0.0]]
        pairs = {(max(pair), min(pair)) for pair in kinds.tolist()}  # in plain numbers: this is asked at every step
        return {Touch(Kind(part), Kind(what)) for part, what in pairs if part >= Kind.FINGER}

    def palm(self) -> tuple[FloatArray, Rotation]:
        """Where the palm's end is, and how it is turned."""
        body = self.data.body("hand")
        return body.xpos.copy(), Rotation.from_quat(np.roll(body.xquat, -1))

    def fingered(self) -> list[int]:
        """The numbers of the things that fingers touch."""
        contacts = self.data.contact
        geoms = contacts.geom[contacts.dist < 0.0]
        of_finger = (self.model.geom_group[geoms] == Kind.FINGER).any(axis=1)
        bodies = self.model.geom_bodyid[geoms[of_finger]]
        return [number for number in self.present if (bodies == self._bodies[number]).any()]
