"""Beyond the paper: hands that come aslant to what stands on a support plane.

The method runs in the plane across the approach, as always. The support plane is an obstacle then, like any other, and
the hand comes only through space that was seen to be free: what a sensor above did not see lies below what it saw, but
what is beside that may be anything.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, ObjectCloud, Silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.surroundings.below import breadth_m
from flatgrasp_cli.surroundings.on_support import OnSupport

OVERHEAD_SHARE = 0.1
"""A sensor nearer than this to straight above, as a share of its distance, is on no side."""
ALONG_FINGER, BESIDE_M = (0.03, 0.12, 0.3, 0.7), 0.004
"""Where a finger's space is looked into, in shares of its length from its tip, and how near to the object, metres."""
SURELY_BEHIND_M = 0.003
"""How far behind a surface space must lie to be hidden by it, metres: twice what a sensor's noise is."""
ACROSS_PALM = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""Where the palm's is, in halves of its size along the closing axis."""
ON_THE_WAY = (0.05, 0.5, 1.0)
"""And how far back on the hand's way, in shares of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Aslant(OnSupport):
    """What the method asks of an object that the hand comes to aslant."""

    seen_only: ClassVar[bool] = True

    def approached(
        self,
        silhouette: Silhouette,
        fingers: FingerCandidates,
        grasps: GraspCandidates,
        gripper: Gripper,
        funnel: Funnel,
        /,
    ) -> GraspCandidates:
        """The pairs to which the hand can come, through space that was seen to be free."""
        grasps = OnSupport.approached(self, silhouette, fingers, grasps, gripper, funnel)
        if self.view.image is None:
            return grasps
        limit = self.settings.approach.hidden_share
        kept = funnel.at_most(
            "unseen",
            grasps,
            self._hidden(grasps, gripper),
            limit,
            lambda value: f"{100 * value:.0f} % of the hand's way is hidden, allowed {100 * limit:.0f} %",
        )
        return grasps.select(kept)

    def _hidden(self, grasps: GraspCandidates, gripper: Gripper) -> FloatArray:
        """Share (p,) of places in the fingers or in the palm, at the grasp and on the way, that no ray reached."""
        shares = [
            self.view.hides(np.ascontiguousarray(places.reshape(-1, 3).T), SURELY_BEHIND_M)
            .reshape(len(places), -1)
            .mean(axis=0)
            for places in (self._in_fingers(grasps, gripper), self._in_palm(grasps, gripper))
        ]
        return np.asarray(np.maximum(*shares))

    def _in_fingers(self, grasps: GraspCandidates, gripper: Gripper) -> FloatArray:
        """Places (k, p, 3) in the open fingers, and where they close."""
        across = left_normal(grasps.axis)
        near = 0.5 * grasps.width + BESIDE_M
        far = 0.5 * grasps.opening + 0.5 * gripper.finger_thickness_m
        places = []
        for sign, offsets in zip((-1.0, 1.0), gripper.jaws, strict=True):
            for offset in offsets:
                for out in (near, 0.5 * (near + far), far):
                    flat = grasps.center + sign * out[:, None] * grasps.axis - offset * across
                    heights = [grasps.tip + share * gripper.finger_length_m for share in ALONG_FINGER]
                    places += [np.column_stack([flat, height]) for height in heights]
        return np.stack(places)

    def _in_palm(self, grasps: GraspCandidates, gripper: Gripper) -> FloatArray:
        """Places (k, p, 3) at the palm's rim, at the grasp and before it."""
        half = 0.5 * breadth_m(gripper, grasps.opening)
        across = 0.5 * gripper.hand_width_m * left_normal(grasps.axis)
        base = grasps.tip + gripper.finger_length_m
        places = []
        for y in ACROSS_PALM:
            middle = grasps.center + y * half[:, None] * grasps.axis
            for flat in (middle - across, middle + across):
                heights = [base + share * self.settings.depth.approach_m for share in ON_THE_WAY]
                places += [np.column_stack([flat, height]) for height in heights]
        return np.stack(places)


def ways(cloud: ObjectCloud, settings: PlannerSettings) -> Iterator[list[FloatArray]]:
    """For each tilt, the unit vectors (3,) that hands come against, the one on the sensor's side first."""
    if cloud.support is None:
        return
    normal = cloud.support.normal
    aside = np.zeros(3)
    if cloud.viewpoint is not None:
        view = cloud.viewpoint - cloud.points.mean(axis=0)
        aside = view - (view @ normal) * normal
        aside = np.zeros(3) if np.linalg.norm(aside) < OVERHEAD_SHARE * np.linalg.norm(view) else aside
    if not aside.any():
        aside = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first = aside / np.linalg.norm(aside)
    second = np.cross(normal, first)
    turns = 2 * np.pi * np.arange(settings.approach.around) / settings.approach.around
    for tilt in np.radians(settings.approach.tilts_deg):
        sides = [np.cos(turn) * first + np.sin(turn) * second for turn in turns]
        yield [np.cos(tilt) * normal + np.sin(tilt) * side for side in sides]
