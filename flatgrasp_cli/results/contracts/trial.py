"""The document of schema `flatgrasp.trial/1`: one simulated attempt to grasp, and what came of it."""

from __future__ import annotations

from typing import Literal

from flatgrasp_cli.results.contracts.base import Number, Part
from flatgrasp_cli.results.contracts.grasps import GraspPart, PosePart

SCHEMA_ID: Literal["flatgrasp.trial/1"] = "flatgrasp.trial/1"


class ConditionsPart(Part):
    """What the attempt was made with."""

    gripper: str
    """The gripper's name."""
    robot: str | None
    """The arm's name; null for a floating hand."""
    seed: int
    """What all random numbers follow from."""
    friction: Number
    """Coefficient of friction between the pads and the object."""
    force_n: Number
    """How hard each jaw presses, newtons."""
    force_from: Literal["option", "profile", "assumed"]
    """How that is known."""
    mass_kg: Number
    """What the object weighs, kilograms."""
    sensor_tilt_deg: Number
    """The angle of the camera's axis with the vertical, degrees."""
    miss_m: Number
    """Standard deviation of the hand's place on each axis across its approach, metres."""
    miss_deg: Number
    """Standard deviation of the hand's turn about its approach, degrees."""


class TrialDocument(Part):
    """One attempt to grasp an object on a simulated table, whose top is the plane z = 0 of the world.

    With an arm, the world is its base frame.
    """

    schema: Literal["flatgrasp.trial/1"]
    """Which contract this is."""
    object: str
    """The object's name; in a heap, that of what was held, else of the thing nearest to the grasp or to the middle."""
    trial: int
    """The number of the trial, or of the heap, from 0."""
    attempt: int
    """The number of the attempt at a heap, from 0; 0 for an object alone."""
    status: Literal["held", "lost", "no_grasp", "collision"]
    """What happened: a collision is a way in on which anything was touched but the object by the fingers."""
    clean: bool | None
    """Whether nothing was touched before the fingers closed; null without a grasp."""
    reason: str | None
    """Why the object was not held; null if it was."""
    lifted_m: Number | None
    """How far up the place came that was between the fingertips, metres; null without a grasp."""
    pushed_m: Number | None
    """How far anything was moved before the fingers closed, metres; null without a grasp."""
    object_pose: PosePart
    """The pose of the object's own frame in the world before the grasp."""
    camera_pose: PosePart
    """The pose of the camera's optical frame in the world."""
    frame_id: str
    """The frame that the grasp is in: the arm's base frame, or `cloud`, the camera's, without an arm."""
    grasp: GraspPart | None
    """The grasp that was carried out, as the plan has it, with its metrics; null without one."""
    conditions: ConditionsPart
    """What the attempt was made with."""
    cloud: str | None
    """The file with what the camera saw, in the folder of results; null if it was not kept."""
