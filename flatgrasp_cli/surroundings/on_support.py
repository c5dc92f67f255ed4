"""An object among others: on a support plane, or standing before the hand."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, OpenHands, Silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.surroundings.below import Stops, stops
from flatgrasp_cli.surroundings.descent import descended
from flatgrasp_cli.surroundings.maps import Relief
from flatgrasp_cli.surroundings.sight import seen_sides
from flatgrasp_cli.surroundings.walls import upright


@dataclass(frozen=True, slots=True, eq=False)
class OnSupport(Relief):
    """What the method asks of an object that stands on something and among others."""

    def sides(self, fingers: FingerCandidates, funnel: Funnel, /) -> FingerCandidates:
        """The candidates before upright sides, except those in holes that the sensor did not see through."""
        if self.level_m > self.lowest_m:
            steep = upright(fingers, self.maps.rest, self.level_m, self.settings.depth.wall_drop)
            fingers = fingers.select(steep)
            funnel.count("upright", len(fingers), "the part that stands out has no steep side")
        if self.view.viewpoint is None:
            fingers = replace(fingers, hidden=np.zeros(len(fingers)))
        else:
            grip_m = self.settings.depth.min_grip_m
            fingers = seen_sides(fingers, self.maps, self.envelope, self.view.viewpoint, self.level_m, grip_m)
        funnel.count("open_sides", len(fingers), "the object's only side is that of a hole that was not seen through")
        return fingers

    def approached(
        self,
        _silhouette: Silhouette,
        fingers: FingerCandidates,
        grasps: GraspCandidates,
        gripper: Gripper,
        funnel: Funnel,
        /,
    ) -> GraspCandidates:
        """The pairs on which the hand can come down far enough, and how it does."""
        return descended(fingers, grasps, self, gripper, funnel)

    def stopped(self, hands: OpenHands, gripper: Gripper, /) -> Stops:
        """What stands below the fingers and the palm of open hands."""
        found = stops(hands, self.maps.rest, self.maps.coarse, gripper)
        return found._replace(dark=np.zeros(hands.tip.shape)) if self.settings.depth.unseen == "ignore" else found
