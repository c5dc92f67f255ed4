"""An object seen alone, as the paper has it: nothing stands around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import FloatArray, chunks
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.geometry.polygon import in_frames
from flatgrasp_cli.geometry.spacing import spacing
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, OpenHands, Silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import HandSettings, PlannerSettings
from flatgrasp_cli.surroundings.below import Stops, breadth_m
from flatgrasp_cli.surroundings.maps import MIN_CELL_M
from flatgrasp_cli.surroundings.walls import ALONG_PAD, INWARD_M, WALL_PLACES, chords_of, pad_places


@dataclass(frozen=True, slots=True)
class Alone:
    """Nothing but the object: the hand has room all around it, though the object itself may reach into the palm."""

    settings: PlannerSettings

    @property
    def level_m(self) -> None:
        """Heights are those over the main plane."""
        return

    @property
    def lowest_m(self) -> float:
        """The height of the main plane."""
        return 0.0

    @property
    def down(self) -> FloatArray:
        """Which way things fall (3,): as if it lay on a table, its main plane level."""
        return np.array([0.0, 0.0, -1.0])

    def sides(self, fingers: FingerCandidates, _funnel: Funnel, /) -> FingerCandidates:
        """All of the candidates: there is nothing for a finger to meet."""
        return fingers

    def approached(
        self,
        silhouette: Silhouette,
        fingers: FingerCandidates,
        grasps: GraspCandidates,
        gripper: Gripper,
        funnel: Funnel,
        /,
    ) -> GraspCandidates:
        """The pairs at which the object stays out of the palm.

        The fingertips end in the main plane, as the paper has it, or as much lower as the pads need to get hold of what
        lies lower there.
        """
        long_m = gripper.finger_length_m
        tip = np.zeros(len(grasps)) if self.settings.hand.model == "paper" else self._tips(silhouette, fingers, grasps)
        grasps = grasps.having(opening=openings(grasps, gripper, self.settings.hand), tip=tip)
        kept = funnel.at_most(
            "palm",
            grasps,
            palm_intrusion(silhouette, grasps, gripper),
            0.0,
            lambda more: (
                f"the object stands {long_m + more:.3f} m above the fingertips, fingers are {long_m:.3f} m long"
            ),
        )
        grasps = grasps.select(kept)
        unknown = np.full(len(grasps), np.nan)
        margin = 0.5 * (grasps.opening - grasps.width)
        return grasps.having(
            grip=unknown,
            margin=margin,
            unseen=unknown,
            touch=np.minimum(0.0, grasps.tip + self.settings.depth.min_grip_m),
            lean=np.zeros((len(grasps), 1)),
            feet=np.zeros((len(grasps), 2, 2)),
        )

    def _tips(self, silhouette: Silhouette, fingers: FingerCandidates, grasps: GraspCandidates) -> FloatArray:
        """Heights (p,) over the main plane at which the fingertips end: the pads hold what is highest on both sides."""
        points = np.column_stack([silhouette.points, silhouette.heights])
        chart = HeightMap.of(points, max(MIN_CELL_M, spacing(silhouette.points)))
        top = chart.over(*pad_places(chords_of(fingers), INWARD_M[:WALL_PLACES], ALONG_PAD)).max(axis=(0, 1))
        top[~np.isfinite(top)] = np.inf  # where nothing is seen, the main plane
        lower = np.minimum(top[grasps.i], top[grasps.j])
        return np.asarray(np.minimum(0.0, lower - self.settings.depth.min_grip_m))

    def stopped(self, hands: OpenHands, _gripper: Gripper, /) -> Stops:
        """Nothing: the way to an object alone is free, and all of it was seen."""
        return Stops(np.full(hands.tip.shape, UNSEEN), np.zeros(hands.tip.shape))


def openings(grasps: GraspCandidates, gripper: Gripper, settings: HandSettings) -> FloatArray:
    """Opening (p,) on the approach, metres: `preshape_m` of free space at each pad, if room and hand allow it."""
    spare = grasps.room.min(axis=1) - gripper.finger_thickness_m
    return np.asarray(np.minimum(grasps.width + 2 * np.minimum(spare, settings.preshape_m), gripper.max_opening_m))


def palm_intrusion(silhouette: Silhouette, grasps: GraspCandidates, gripper: Gripper) -> FloatArray:
    """How far (p,) the object reaches into the palm and the fingers' roots of each hand; 0 if it does not.

    Only points that are higher over the fingertips' ends than the fingers are long can meet the palm.
    """
    intrusion = np.zeros(len(grasps))
    along = 0.5 * breadth_m(gripper, grasps.opening)
    deepest = float(grasps.tip.min(initial=0.0))
    tall = silhouette.heights > deepest + gripper.finger_length_m
    if not tall.any():
        return intrusion
    points, excess = silhouette.points[tall], silhouette.heights[tall] - gripper.finger_length_m
    for part in chunks(len(grasps), len(points)):
        x, y = in_frames(points, grasps.center[part], grasps.axis[part])
        inside = (np.abs(x) <= 0.5 * gripper.hand_width_m) & (np.abs(y) <= along[part])
        intrusion[part] = np.where(inside, excess[:, None] - grasps.tip[part], 0.0).max(axis=0)
    return intrusion
