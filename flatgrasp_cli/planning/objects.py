"""One object → its grasps in the plane: the method on each place that it can be grasped in, and the best answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from flatgrasp_cli.funnel import Funnel, NothingLeft
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.methods import METHODS
from flatgrasp_cli.model import (
    GraspCandidates,
    GravityCenter,
    ObjectCloud,
    OrientedBox,
    PlaneShape,
    Rejection,
    Silhouette,
    Stage,
    Trace,
)
from flatgrasp_cli.planner.gravity import gravity_center
from flatgrasp_cli.planner.main_plane import oriented_box
from flatgrasp_cli.planner.silhouette import silhouette_of
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.proof import Certificates, certified, forgiven_m, is_caged, why_not
from flatgrasp_cli.surroundings import Place, box_on, from_the_side, hanging_m, places

CONSIDERED = 2000
"""How many of an object's best grasps those to be listed are chosen from: all of them as a rule."""


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """What the method found for an object in one place: grasps in the plane of its shape, best first, or a rejection.

    What was not come to is None. `level_m` is the height above which the silhouette was taken.
    """

    funnel: tuple[Stage, ...]
    rejection: Rejection | None
    trace: Trace
    box: OrientedBox | None = None
    level_m: float | None = None
    shape: PlaneShape | None = None
    grasps: GraspCandidates | None = None
    certificates: Certificates | None = None

    def of(self, rows: Sequence[int]) -> Answer:
        """The answer with only the grasps in `rows`, in that order."""
        keep = np.array(rows, dtype=np.intp)
        return replace(
            self,
            grasps=self.grasps and self.grasps.select(keep),
            certificates=self.certificates and self.certificates.select(keep),
        )


def answer_for(cloud: ObjectCloud, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The best grasps of one object in the plane, with `settings` as `PlannerSettings.resolve` returns them.

    They have certificates where these decide which is best.

    An object alone is planned as in the paper. Over a support plane the method runs on each of the object's slices, and
    the grasps are those of the slice with the best one; a standing object that cannot be grasped from above is planned
    in the main plane of its own bounding box.
    """
    if cloud.support is None:
        box = oriented_box(cloud.points, cloud.toward, settings.main_plane.method)
    else:
        box = box_on(cloud.support, cloud.points, settings.main_plane.method)
    if box is None:
        return _nothing("main_plane", _no_plane(cloud.points, settings.scene.crop is not None))
    whole, *slices = places(cloud, box, settings)
    if hanging := hanging_m(whole):
        reason = f"it hangs {1e3 * hanging:.0f} mm up in the air: only free space was seen below it"
        return _nothing("support", reason)
    cages_decide = settings.caging.require or settings.caging.prefer == "cage"
    considered = settings.caging.considered if cages_decide else CONSIDERED
    silhouette = _silhouette(whole, settings)
    center = gravity_center(silhouette, settings.gravity)

    def answer(place: Place, silhouette: Silhouette, center: GravityCenter) -> Answer:
        found = _answer(place, PlaneShape(place.box, silhouette, center), gripper, settings, considered)
        return _by_certificates(found, gripper, settings) if cages_decide else found

    best_first = partial(_best_first, by_cage=settings.caging.prefer == "cage")
    best = answer(whole, silhouette, center)
    for place in slices:
        if cages_decide or settings.method == "allen" or not _is_cheaper(best, place, settings):
            best = min(best, answer(place, _silhouette(place, settings), center), key=best_first)
    if cloud.support is not None and best.grasps is None and (side := _standing(cloud, box.size, settings)):
        silhouette = _silhouette(side, settings)
        best = min(best, answer(side, silhouette, gravity_center(silhouette, settings.gravity)), key=best_first)
    return best


def _silhouette(place: Place, settings: PlannerSettings) -> Silhouette:
    """§III.A.2."""
    return silhouette_of(place.points, place.frame, settings.silhouette, place.spacing_m)


def _answer(place: Place, shape: PlaneShape, gripper: Gripper, settings: PlannerSettings, considered: int) -> Answer:
    """What the method finds in one place."""
    funnel = Funnel()
    known = len(shape.silhouette.loops) > 0
    grasps, rejection = None, None
    try:
        funnel.count("silhouette", len(shape.silhouette.loops), "the points are too scattered for an outline")
        grasps = METHODS[settings.method](shape, place.surroundings, gripper, settings, funnel, considered)
    except NothingLeft as end:
        rejection = end.rejection
    return Answer(
        funnel=tuple(funnel.stages),
        rejection=rejection,
        trace=funnel.trace,
        box=shape.box,
        level_m=place.surroundings.level_m,
        shape=shape if known else None,
        grasps=grasps,
    )


def _standing(cloud: ObjectCloud, size: FloatArray, settings: PlannerSettings) -> Place | None:
    """The place to grasp an object of `size` (3,) from the side; None when it is too low for that."""
    if size[2] < settings.depth.standing_ratio * size[:2].max():
        return None
    box = oriented_box(cloud.points, cloud.toward, settings.main_plane.method)
    return None if box is None else from_the_side(cloud, box, settings)


def _is_cheaper(best: Answer, place: Place, settings: PlannerSettings) -> bool:
    """Whether no grasp of a slice can cost less than the best one that there is.

    No term of the cost is negative and one grows with the fingertips' height, so a slice that stands high need not be
    planned once a lower one has a grasp that costs less than its height alone.
    """
    if best.grasps is None:
        return False
    height_m = (place.surroundings.level_m or 0.0) - settings.depth.slice_step_m
    return bool(settings.gravity.level_weight * height_m > best.grasps.cost[0])


def _best_first(answer: Answer, *, by_cage: bool) -> tuple[bool, bool, float, float, int]:
    """Order of answers: by the best grasp's cage or cost; last those without, the one first that came furthest."""
    if answer.grasps is None:
        return (True, True, np.inf, np.inf, -len(answer.funnel))
    if by_cage:
        return (False, *_surest_first(answer.grasps, answer.certificates, 0), 0)
    return (False, False, 0.0, float(answer.grasps.cost[0]), 0)


def _surest_first(grasps: GraspCandidates, certificates: Certificates | None, k: int) -> tuple[bool, float, float]:
    """Grasps with a cage first, those before others that forgive the larger miss; then the cheaper one."""
    cage = None if certificates is None else certificates.cages[k]
    return (not is_caged(cage), -forgiven_m(cage), float(grasps.cost[k]))


def _by_certificates(answer: Answer, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The answer with certificates, its grasps in the order that the settings prefer.

    With `caging.require`, grasps without a cage are no grasps.
    """
    answer = proved(answer, gripper, settings)
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
    if settings.caging.prefer == "cage":
        kept.sort(key=lambda k: _surest_first(grasps, answer.certificates, k))
    return replace(answer.of(kept), funnel=funnel)


def proved(answer: Answer, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The answer with a certificate for each of its grasps, if the settings ask for them."""
    if answer.grasps is None or answer.shape is None or answer.certificates or not settings.caging.certify:
        return answer
    grasps, certificates = certified(answer.grasps, answer.shape.silhouette, gripper, settings)
    return replace(answer, grasps=grasps, certificates=certificates)


def _nothing(stage: str, reason: str) -> Answer:
    """The answer for what cannot be planned at all."""
    return Answer((Stage(stage, 0),), Rejection(stage, reason), Trace())


def _no_plane(points: FloatArray, cropped: bool) -> str:
    if len(points) == 0 and cropped:
        return "no point lies in the region of interest"
    if len(points) == 0:
        return (
            "no point of the cloud was measured: all are invalid, 0 0 0, farther than 10 km from the origin, "
            "or within 1 cm of the sensor; are they in metres (--scale)?"
        )
    distinct = len(np.unique(points, axis=0))
    if distinct < 3:
        return f"the cloud has {distinct} distinct point{'s' if distinct > 1 else ''}, an outline needs three"
    return f"all {len(points)} points lie on a line"
