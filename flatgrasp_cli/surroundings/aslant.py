"""Beyond the paper: hands that come aslant to what stands on a support plane.

The method runs in the plane across the approach, as always. The support plane is an obstacle then, like any other, and
the hand comes only through space that was seen to be free: what a sensor above did not see lies below what it saw, but
what is beside that may be anything.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, OpenHands, Silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.surroundings.below import Stops, breadth_m
from flatgrasp_cli.surroundings.on_support import OnSupport
from flatgrasp_cli.surroundings.walls import ALONG_PAD, INWARD_M, WALL_PLACES, chords_of, pad_places


@dataclass(frozen=True, slots=True, eq=False)
class Aslant(OnSupport):
    """What the method asks of an object that the hand comes to aslant; `own` has what was seen of the object itself."""

    own: HeightMap = field(kw_only=True)

    @property
    def down(self) -> FloatArray:
        """Which way things fall: against the normal of the floor that they stand on."""
        normal = self.view.frame.axes[2]
        return np.asarray(-normal if self.view.asked is None else -self.view.asked.axes @ normal)

    def approached(
        self,
        silhouette: Silhouette,
        fingers: FingerCandidates,
        grasps: GraspCandidates,
        gripper: Gripper,
        funnel: Funnel,
        /,
    ) -> GraspCandidates:
        """The pairs to which the hand can come, through space that was seen to be free or lies behind the object."""
        grasps = grasps.select(np.flatnonzero(self._is_seen(fingers, grasps)))
        funnel.count("seen", len(grasps), "the fingers would close on sides of the object that were not seen")
        grasps = grasps.select(np.flatnonzero(self._has_palm_room(grasps, gripper)))
        funnel.count("palm_room", len(grasps), "the palm has no room over the object")
        grasps = OnSupport.approached(self, silhouette, fingers, grasps, gripper, funnel)
        if self.view.image is None:
            return grasps
        in_fingers, behind, in_palm = self._hidden(grasps, gripper)
        strict = self.settings.depth.unseen == "refuse"
        limit = 0.0 if strict else self.settings.approach.hidden_share
        grasps = grasps.having(unseen=2 * gripper.finger_thickness_m * in_fingers)
        kept = funnel.at_most(
            "unseen",
            grasps,
            np.maximum(in_fingers if strict else in_fingers - behind, in_palm),
            limit,
            lambda value: f"{100 * value:.0f} % of the hand's way is hidden, allowed {100 * limit:.0f} %",
        )
        return grasps.select(kept)

    def _is_seen(self, fingers: FingerCandidates, grasps: GraspCandidates) -> BoolArray:
        """Of which pairs (p,) a finger comes to a surface that was seen along most of its pad, not only to its rear."""
        places = pad_places(chords_of(fingers), INWARD_M[:WALL_PLACES], ALONG_PAD)
        seen = np.isfinite(self.own.over(*places)).mean(axis=(0, 1)) > 0.5
        return np.asarray(seen[grasps.i] | seen[grasps.j])

    def _has_palm_room(self, grasps: GraspCandidates, gripper: Gripper) -> BoolArray:
        """Which pairs (p,) have room for a palm of the least height at which the pads hold anything at all.

        It is a bound that costs little: a palm covers the discs in it, and no pads are higher than the object's top.
        """
        coarse = self.maps.coarse
        highest = (
            float(self.maps.surface.heights.max()) + gripper.finger_length_m - self.settings.depth.palm_clearance_m
        )
        free = (coarse.heights <= highest).view(np.uint8)
        room_m = coarse.cell_m * cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        radius = 0.5 * min(gripper.hand_width_m, gripper.palm_m)
        farthest = 0.5 * gripper.palm_m - radius
        has_room = np.ones(len(grasps), dtype=np.bool_)
        for along in _steps(-farthest, farthest, radius):  # so they overlap by half
            x, y = (grasps.center + along * grasps.axis).T
            has_room &= room_m.take(coarse.raster.cells(x, y)) >= radius
        return has_room

    def stopped(self, hands: OpenHands, gripper: Gripper, /) -> Stops:
        """What stands below the fingers and the palm of open hands, and how much of where they end was hidden."""
        found = OnSupport.stopped(self, hands, gripper)
        if self.settings.depth.unseen == "ignore":
            return found
        middle, axis, half = np.split(hands.rows, (2, 4), axis=1)
        out, tip = (half + 0.5 * gripper.finger_thickness_m) * axis, hands.tip.ravel()
        hidden = self._hides(np.stack([np.column_stack([middle + sign * out, tip]) for sign in (-1.0, 1.0)]))
        return found._replace(dark=hidden.reshape(2, *hands.tip.shape).mean(axis=0))

    def _hidden(self, grasps: GraspCandidates, gripper: Gripper) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Shares (p,) of places in the fingers and, last, in the palm, on the way and at its end, that no ray reached.

        The second is the share of those in fingers that the object itself hides: that is no more in the way than it is
        for a hand from straight above.
        """
        places = self._in_fingers(grasps, gripper)
        hidden, in_palm = self._hides(places), self._hides(self._in_palm(grasps, gripper))
        behind = hidden & self.view.shadowed(np.ascontiguousarray(places.reshape(-1, 3).T))
        one, two, three = (each.reshape(-1, len(grasps)).mean(axis=0) for each in (hidden, behind, in_palm))
        return one, two, three

    def _hides(self, places: FloatArray) -> BoolArray:
        """Which places (…, 3), one after the other, surely lie behind what their rays met."""
        return self.view.hides(np.ascontiguousarray(places.reshape(-1, 3).T), surely_behind_m(self.settings))

    def _in_fingers(self, grasps: GraspCandidates, gripper: Gripper) -> FloatArray:
        """Places (k, p, 3) in the middle of the open fingers, where they close, and halfway: a thickness apart."""
        across, half = left_normal(grasps.axis), 0.5 * gripper.finger_thickness_m
        near, far = 0.5 * grasps.width + half, 0.5 * grasps.opening + half
        along = _steps(half, gripper.finger_length_m - half, gripper.finger_thickness_m)
        places = []
        for sign, offsets in zip((-1.0, 1.0), gripper.jaws, strict=True):
            for offset in offsets:
                for out in (near, 0.5 * (near + far), far):
                    flat = grasps.center + sign * out[:, None] * grasps.axis - offset * across
                    places += [np.column_stack([flat, grasps.tip + height]) for height in along]
        return np.stack(places)

    def _in_palm(self, grasps: GraspCandidates, gripper: Gripper) -> FloatArray:
        """Places (k, p, 3) at the palm's rim, at the grasp and before it, half of its lesser width apart."""
        half, apart_m = 0.5 * breadth_m(gripper, grasps.opening), 0.5 * gripper.hand_width_m
        across = 0.5 * gripper.hand_width_m * left_normal(grasps.axis)
        base = grasps.tip + gripper.finger_length_m
        places = []
        before = _steps(0.0, self.settings.depth.approach_m, apart_m)
        for share in _steps(-1.0, 1.0, apart_m / max(float(half.max(initial=0.0)), apart_m)):
            middle = grasps.center + share * half[:, None] * grasps.axis
            for flat in (middle - across, middle + across):
                places += [np.column_stack([flat, base + height]) for height in before]
        return np.stack(places)


def surely_behind_m(settings: PlannerSettings) -> float:
    """How far behind a surface space must lie to be hidden by it, metres: three standard deviations of where it is."""
    return 3 * settings.uncertainty.figures.outline_m


def _steps(first: float, last: float, apart: float) -> list[float]:
    """Evenly spaced numbers from the `first` to the `last`, no more than so far apart."""
    count = int(np.ceil((last - first) / apart - 1e-9)) if last > first else 0
    return list(np.linspace(first, last, count + 1).tolist())
