"""Which of the places where an object can be grasped is best: the whole of it, or what stands out."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import PlaneShape, Reach, Silhouette
from flatgrasp_cli.planner.gravity import gravity_center, volume_m3
from flatgrasp_cli.planner.silhouette import silhouette_of
from flatgrasp_cli.planning.answers import Answer, answer_in, by_certificates, surest_first
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.ranking import TIE
from flatgrasp_cli.surroundings import Place

CONSIDERED = 2000
"""How many of an object's best grasps those to be listed are chosen from: all of them as a rule."""

EXTRA_STAGES = {"palm_room", "seen", "upright"}
"""Stages that there are only for some directions or levels: one that has them came no further for that."""


@dataclass(frozen=True, slots=True)
class Search:
    """Runs the method in places, and compares what it finds there."""

    gripper: Gripper
    settings: PlannerSettings
    reach: Callable[[Answer], tuple[Reach, ...]] | None = None
    """What a robot makes of an answer's grasps; None without a robot."""
    is_too_far: Callable[[FloatArray], bool] | None = None
    """Whether a robot is too far away to bring its hand against a direction (3,); None without a robot."""
    between: bool = False
    """Whether hands come from the sides between those that are tried first."""

    @property
    def _cages_decide(self) -> bool:
        return self.settings.caging.require or self.settings.ranking.prefer == "cage"

    def whole(self, place: Place, slices: Iterable[Place], most_m3: float = np.inf) -> Answer:
        """The best answer for one direction: of the whole, or of a slice, about the gravity centre of the whole.

        The object has no more than the volume that is known from another direction, `most_m3`.
        """
        silhouette = _silhouette(place, self.settings)
        center, volume = gravity_center(silhouette, self.settings.gravity), min(volume_m3(silhouette), most_m3)
        best = self._in(place, PlaneShape(place.box, silhouette, center, volume))
        for part in slices:
            if self._is_sure(best):
                break  # and no further slice is made
            shape = PlaneShape(part.box, _silhouette(part, self.settings), center, volume)
            best = self.better(best, self._in(part, shape))
        return best if best.grasps is None or self.reach is None else replace(best, reaches=self.reach(best))

    def volume_m3(self, whole: Place) -> float:
        """The object's volume, cubic metres, by what lies under its visible surface; infinite without a silhouette."""
        silhouette = _silhouette(whole, self.settings)
        return volume_m3(silhouette) if silhouette.loops else np.inf

    def is_enough(self, best: Answer) -> bool:
        """Whether it is not worth looking for anything better than the `best` answer from other directions."""
        if best.grasps is None or not best.is_served:
            return False
        return not self._by_probability or bool(best.grasps.merit[0] >= self.settings.approach.enough)

    def is_in_vain(self, toward: FloatArray, best: Answer | None) -> bool:
        """Whether a hand against `toward` (3,) finds nothing better than the `best` answer: the arm gets it nowhere."""
        if self.is_too_far is None or best is None or best.grasps is None:
            return False
        return self.is_too_far(toward)

    def shortcoming(self, top: Answer) -> str | None:
        """Why straight down, with the answer `top`, was not enough."""
        if top.grasps is None:
            return top.rejection.reason if top.rejection else None
        if not top.is_served:
            return "the robot reaches none of the grasps from straight above"
        return f"from straight above the best grasp holds with a probability of {float(top.grasps.merit[0]):.2f}"

    @property
    def _by_probability(self) -> bool:
        """Whether what is best is what most probably holds."""
        return self.settings.ranking.prefer == "success" and self.settings.method != "allen"

    def better(self, one: Answer, other: Answer) -> Answer:
        """The better one of two answers; of two that hold as probably, the one nearer to the centre of gravity."""
        if self._tie(one, other):
            return min(one, other, key=_first_distance)
        return min(one, other, key=self._order)

    def _tie(self, one: Answer, other: Answer) -> bool:
        """Whether both best grasps hold as probably as the other."""
        if one.grasps is None or other.grasps is None or not self._by_probability or one.is_served != other.is_served:
            return False
        return abs(float(one.grasps.merit[0] - other.grasps.merit[0])) <= TIE

    def _in(self, place: Place, shape: PlaneShape) -> Answer:
        """What the method finds in a place, in the order that the settings prefer."""
        considered = self.settings.caging.considered if self._cages_decide else CONSIDERED
        found = answer_in(place, shape, self.gripper, self.settings, considered)
        return by_certificates(found, self.gripper, self.settings) if self._cages_decide else found

    def _is_sure(self, best: Answer) -> bool:
        """Whether no grasp of a higher slice can be better than the `best` one, which holds but for a tie."""
        if best.grasps is None or self._cages_decide:
            return False
        return self._by_probability and bool(best.grasps.merit[0] >= 1 - TIE)

    def _order(self, answer: Answer) -> tuple[bool, bool, bool, float, float]:
        """By the best grasp's cage, or how probably it holds; last those without, the one first that came furthest."""
        if answer.grasps is None:
            return (True, True, True, *_nearest_miss(answer))
        refused = not answer.is_served
        if self.settings.ranking.prefer == "cage":
            return (False, refused, *surest_first(answer.grasps, answer.certificates, 0))
        return (False, refused, False, -float(answer.grasps.merit[0]), float(answer.grasps.gravity_distance[0]))


def _nearest_miss(answer: Answer) -> tuple[float, float]:
    """The order of answers without a grasp: that first which came furthest, and there nearest to the limit."""
    miss, came = answer.rejection, len([stage for stage in answer.funnel if stage.stage not in EXTRA_STAGES])
    if miss is None or miss.value is None or miss.limit is None:
        return -float(came), np.inf
    return -float(came), abs(miss.value - miss.limit)


def _first_distance(answer: Answer) -> float:
    """The gravity distance of an answer's best grasp."""
    return float(answer.grasps.gravity_distance[0]) if answer.grasps is not None else np.inf


def _silhouette(place: Place, settings: PlannerSettings) -> Silhouette:
    """§III.A.2."""
    return silhouette_of(place.points, place.frame, settings.silhouette, place.spacing_m)
