"""Where a hand is on its way to a grasp, at it, and after it."""

from __future__ import annotations

from dataclasses import dataclass

from flatgrasp_cli.geometry.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A frame's `position` (3,), in metres, and its `orientation`, a unit quaternion [x, y, z, w]."""

    position: FloatArray
    orientation: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """One frame of the hand before the grasp, at it, and lifted; it moves straight from one to the next."""

    pre_grasp: Pose
    pose: Pose
    lift: Pose


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """How a grasp is carried out, by the frames of the fingertips, of the flange and of the hand's own mounting.

    They are rigid to each other: the `tips` are where closed fingers end, also while they are open. The `flange` is the
    arm's `tool0`, z out of it; `hand` is None where the hand's own frame is the flange. If the
    hand goes `back_first`, it is at the pre-grasp once more before it is lifted.
    """

    tips: Poses
    flange: Poses
    hand: Poses | None = None
    back_first: bool = False
