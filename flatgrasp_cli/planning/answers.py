"""What the method finds of an object in one place, and what is found out about its best grasps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.funnel import Funnel, NothingLeft
from flatgrasp_cli.methods import METHODS
from flatgrasp_cli.model import (
    FingerCandidates,
    GraspCandidates,
    OrientedBox,
    PlaneShape,
    Reach,
    Rejection,
    Stage,
    Trace,
)
from flatgrasp_cli.planner import final
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.proof import Certificates, certified, forgiven_m, is_caged, why_not
from flatgrasp_cli.ranking import Situation
from flatgrasp_cli.surroundings import Direction, Place, Surroundings


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """What the method found for an object in one place: grasps in the plane of its shape, best first, or a rejection.

    What was not come to is None. `level_m` is the height above which the silhouette was taken. The grasps are pairs of
    `fingers`, and those are None once the grasps are finished. The hand comes from a `direction`, None for straight
    down, which was not enough for the reason `why_not_top`. `reaches` are what a robot makes of the first grasps.
    """

    funnel: tuple[Stage, ...]
    rejection: Rejection | None
    trace: Trace
    box: OrientedBox | None = None
    level_m: float | None = None
    shape: PlaneShape | None = None
    surroundings: Surroundings | None = None
    fingers: FingerCandidates | None = None
    grasps: GraspCandidates | None = None
    certificates: Certificates | None = None
    direction: Direction | None = None
    why_not_top: str | None = None
    reaches: tuple[Reach, ...] | None = None

    @property
    def is_served(self) -> bool:
        """Whether the robot, if there is one, can carry out any of the grasps."""
        return self.reaches is None or any(each.ok for each in self.reaches)

    def of(self, rows: Sequence[int]) -> Answer:
        """The answer with only the grasps in `rows`, in that order."""
        keep = np.array(rows, dtype=np.intp)
        return replace(
            self,
            grasps=self.grasps and self.grasps.select(keep),
            certificates=self.certificates and self.certificates.select(keep),
        )


def answer_in(place: Place, shape: PlaneShape, gripper: Gripper, settings: PlannerSettings, considered: int) -> Answer:
    """What the method finds in one place: no more grasps than are `considered`."""
    funnel = Funnel()
    known = len(shape.silhouette.loops) > 0
    fingers, grasps, rejection = None, None, None
    try:
        funnel.count("silhouette", len(shape.silhouette.loops), "the points are too scattered for an outline")
        fingers, grasps = METHODS[settings.method](shape, place.surroundings, gripper, settings, funnel, considered)
    except NothingLeft as end:
        rejection = end.rejection
    return Answer(
        funnel=tuple(funnel.stages),
        rejection=rejection,
        trace=funnel.trace,
        box=shape.box,
        level_m=place.surroundings.level_m,
        shape=shape if known else None,
        surroundings=place.surroundings,
        fingers=fingers,
        grasps=grasps,
    )


def surest_first(grasps: GraspCandidates, certificates: Certificates | None, k: int) -> tuple[bool, float, float]:
    """Grasps with a cage first, those before others that forgive the larger miss; then nearer the centre of gravity."""
    cage = None if certificates is None else certificates.cages[k]
    return (not is_caged(cage), -forgiven_m(cage), float(grasps.gravity_distance[k]))


def by_certificates(answer: Answer, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The answer with certificates, its grasps in the order that the settings prefer.

    With `caging.require`, grasps without a cage are no grasps.
    """
    answer = proved(finished(answer, gripper, settings), gripper, settings)
    if answer.grasps is None or answer.certificates is None:
        return answer
    grasps, cages = answer.grasps, answer.certificates.cages
    kept, funnel = list(range(len(grasps))), answer.funnel
    if settings.caging.require:
        kept = [k for k in kept if is_caged(cages[k])]
        funnel = (*funnel, Stage("cage", len(kept)))
        if not kept:
            reason = f"none of the {len(grasps)} best grasps is a cage: {why_not(cages[0])}"
            return replace(answer, grasps=None, certificates=None, funnel=funnel, rejection=Rejection("cage", reason))
    if settings.ranking.prefer == "cage":
        kept.sort(key=lambda k: surest_first(grasps, answer.certificates, k))
    return replace(answer.of(kept), funnel=funnel)


def finished(answer: Answer, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The answer with what only final grasps are asked for, unless that is known already."""
    if answer.grasps is None or answer.shape is None or answer.fingers is None:
        return answer
    grasps = final(answer.fingers, answer.grasps, answer.shape, gripper, settings)
    return replace(answer, fingers=None, grasps=grasps)


def proved(answer: Answer, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The answer with a certificate for each of its grasps, if the settings ask for them."""
    if answer.grasps is None or answer.shape is None or answer.certificates or not settings.caging.certify:
        return answer
    grasps, certificates = certified(answer.grasps, answer.shape.silhouette, gripper, settings)
    return replace(answer, grasps=grasps, certificates=certificates)


def assessed(answer: Answer, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The answer with how probable it is that each of its grasps holds, unless the method knows no hand.

    Those are tried that were not yet, and those in a cage, which forgives more than was known when they were.
    """
    if answer.grasps is None or answer.shape is None or answer.surroundings is None or settings.method == "allen":
        return answer
    grasps = answer.grasps
    cages = answer.certificates.cages if answer.certificates else (None,) * len(grasps)
    tolerances = [cage.tolerance if is_caged(cage) and cage is not None else None for cage in cages]
    known = np.isfinite(grasps.probability) if len(grasps.probability) else np.zeros(len(grasps), dtype=np.bool_)
    anew = np.flatnonzero(
        [tolerance is not None or not told for tolerance, told in zip(tolerances, known, strict=True)]
    )
    if len(anew) == 0:
        return answer
    situation = Situation(answer.shape, answer.surroundings, gripper, settings)
    tried = situation.tried(grasps.select(anew), [tolerances[k] for k in anew])
    return replace(answer, grasps=grasps.with_rows(anew, tried))
