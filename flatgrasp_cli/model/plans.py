"""The answer for one object, and how the method came to it."""

from __future__ import annotations

from dataclasses import dataclass, field

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model.candidates import FingerCandidates
from flatgrasp_cli.model.grasps import Grasp
from flatgrasp_cli.model.outlines import GravityCenter, OrientedBox, Silhouette, StepPoints
from flatgrasp_cli.model.scenes import ObjectCloud


@dataclass(frozen=True, slots=True)
class Stage:
    """One line of the funnel: how many candidates were left after a stage of the method."""

    stage: str
    kept: int


@dataclass(frozen=True, slots=True)
class Rejection:
    """Why there is no grasp: the stage that removed the last candidate, and the nearest miss in numbers.

    `cause` tells apart, by a stable word, what else may stop the hand at a stage.
    """

    stage: str
    reason: str
    value: float | None = None
    limit: float | None = None
    cause: str | None = None


@dataclass(slots=True, eq=False)
class Trace:
    """What each step of the method saw, for figures and for study; filled while the method runs, None where it ended.

    `force_balance_deg` (m, k) is γ of all candidates for jaw 0 with all for jaw 1. `survivors` maps a stage's name to
    the (k, 2) pairs of candidates that it kept, in the method's order; `ranked` are the last of them, best first, and
    `gravity_distance_m` theirs. `level_m` is the height over the support plane above which the silhouette was taken.
    """

    box: OrientedBox | None = None
    level_m: float | None = None
    silhouette: Silhouette | None = None
    steps: tuple[StepPoints, ...] = ()
    fingers: FingerCandidates | None = None
    doubted_directions: int = 0
    force_balance_deg: FloatArray | None = None
    survivors: dict[str, IntArray] = field(default_factory=dict)
    gravity_center: GravityCenter | None = None
    ranked: IntArray | None = None
    gravity_distance_m: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ObjectPlan:
    """The answer for one object: its grasps, or the rejection that says why there are none.

    `refused` are the best of the grasps that a robot cannot carry out.
    """

    object: ObjectCloud
    funnel: tuple[Stage, ...]
    grasps: tuple[Grasp, ...]
    rejection: Rejection | None
    trace: Trace
    refused: tuple[Grasp, ...] = ()
