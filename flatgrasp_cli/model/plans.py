"""The answer for one object, and how the method came to it."""

from __future__ import annotations

from dataclasses import dataclass, field

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model.candidates import FingerCandidates
from flatgrasp_cli.model.grasps import Grasp
from flatgrasp_cli.model.scenes import ObjectCloud
from flatgrasp_cli.model.shapes import GravityCenter, OrientedBox, PlaneShape, Silhouette, StepPoints


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
    """Diagnostics: what each step of the method saw, for figures and for study. No answer depends on it.

    It is filled while the method runs; None is what was not reached. `survivors` maps a stage's name to the (k, 2)
    pairs of candidates that it kept, in the method's order; `ranked` are the last of them, best first, and
    `gravity_distance_m` theirs.
    """

    steps: tuple[StepPoints, ...] = ()
    fingers: FingerCandidates | None = None
    doubted_directions: int = 0
    survivors: dict[str, IntArray] = field(default_factory=dict)
    ranked: IntArray | None = None
    gravity_distance_m: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ObjectPlan:
    """The answer for one object: its grasps, or the rejection that says why there are none.

    `refused` are the best of the grasps that a robot cannot carry out. `shape` is what the method ran on, None if the
    object spans no plane or has no silhouette; `box` is known without a silhouette, too. `level_m` is the height over
    the support plane above which the silhouette was taken. `why_not_top` says why the hand comes from elsewhere than
    from straight above.
    """

    object: ObjectCloud
    funnel: tuple[Stage, ...]
    grasps: tuple[Grasp, ...]
    rejection: Rejection | None
    refused: tuple[Grasp, ...] = ()
    box: OrientedBox | None = None
    shape: PlaneShape | None = None
    level_m: float | None = None
    why_not_top: str | None = None
    trace: Trace = field(default_factory=Trace)

    @property
    def silhouette(self) -> Silhouette | None:
        """The silhouette that the method ran on."""
        return None if self.shape is None else self.shape.silhouette

    @property
    def gravity_center(self) -> GravityCenter | None:
        """Where the object's centre of gravity may be, in the plane of the silhouette."""
        return None if self.shape is None else self.shape.gravity_center
