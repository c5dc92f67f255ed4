"""How probable it is that a grasp holds, and what it fails by.

Each grasp is carried out in thought, once for each sample of what is not known (`errors`): the probability of force
closure under errors of the pose (Weisz & Allen, "Pose error robust grasping from contact wrench space metrics", ICRA
2012), with what the hand meets on its way and what the object weighs besides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.kernels import trial as kernels
from flatgrasp_cli.model import GraspCandidates, OpenHands, PlaneShape, Tolerance
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.profiles.uncertainty import Uncertainty
from flatgrasp_cli.ranking.closing import closed
from flatgrasp_cli.ranking.errors import Errors, errors_of
from flatgrasp_cli.ranking.lifting import Load, friction_to_lift
from flatgrasp_cli.surroundings.interface import Surroundings
from flatgrasp_cli.surroundings.maps import NOISE_M

CLEAR, CLOSES, LIFTS = ("lands_on_object", "stopped_short"), ("closes_beside", "slips"), ("too_heavy", "turns")
CAUSES = (*CLEAR, *CLOSES, *LIFTS)
"""What a grasp fails by, in the order of carrying it out: only the first counts."""
PUSHED_ASIDE = 0.8
"""How often an object is held on which a fingertip comes down with its middle: it slides off a rounded edge, or moves
what is free to move. In simulation 96 of 121 were, of 25 objects and from all sides."""


@dataclass(frozen=True, eq=False)
class Situation:
    """What grasps are carried out on, among what, and with which hand; and in which of the samples."""

    shape: PlaneShape
    surroundings: Surroundings
    gripper: Gripper
    settings: PlannerSettings

    first: int = 0
    last: int | None = None
    """The samples are those from the `first` to before this one; None for all."""

    @property
    def briefly(self) -> Situation:
        """The same, with a quarter of the samples: their first, which are spread evenly, too."""
        return replace(self, last=max(1, round(0.25 * self.unsure.samples)))

    @property
    def to_the_end(self) -> Situation:
        """The same for grasps that were tried `briefly`: with the other samples, and those count, too."""
        return replace(self, first=self.briefly.last or 0)

    @cached_property
    def unsure(self) -> Uncertainty:
        """The figures of what is not known."""
        return self.settings.uncertainty.figures

    @cached_property
    def errors(self) -> Errors:
        """The samples of what is not known, the same for all grasps."""
        return errors_of(self.unsure, self.settings.seed, self.first, self.last)

    def tried(self, grasps: GraspCandidates, tolerances: Sequence[Tolerance | None] = ()) -> GraspCandidates:
        """The k grasps with `success`, `causes` and `probability`.

        `tolerances` say of each how far a hand may miss that comes into a cage's basin, where it does: then closing
        ends in the grasp.
        """
        if len(self.errors) == 0:
            return grasps
        left = self._chances(grasps, _inside(tolerances, grasps, self.errors))
        causes = np.concatenate([np.ones((len(grasps), 1)), left[:, :-1]], axis=1) - left
        after = left[:, np.cumsum([len(CLEAR), len(CLOSES), len(LIFTS)]) - 1]
        if self.first > 0:
            part = self.first / (self.first + len(self.errors))
            causes = part * grasps.causes + (1 - part) * causes
            after = part * np.cumprod(grasps.success, axis=1) + (1 - part) * after
        before = np.column_stack([np.ones(len(grasps)), after[:, :-1]])
        success = np.divide(after, before, out=np.ones_like(after), where=before > 0)
        return grasps.having(success=success, causes=causes, probability=after[:, -1])

    def _chances(self, grasps: GraspCandidates, inside: BoolArray) -> FloatArray:
        """How probably k grasps have not failed yet (k, c) after each of the `CAUSES`.

        Where the hand is `inside` (k, s) a basin, closing ends in the grasp, and its two sides are opposed again. What
        depends on friction alone, or on what was not seen, is a chance in each sample; all else is 0 or 1 there.
        """
        errors, unsure = self.errors, self.unsure
        grip_m = self._grip_m(grasps)
        where = np.concatenate([grasps.center, grasps.axis], axis=1)
        wanted = np.column_stack([where, 0.5 * grasps.opening])
        hands = OpenHands(kernels.moved(wanted, errors.misses), grasps.tip[:, None] + errors.height)
        grips = np.column_stack([where, grasps.tip, np.full(len(grasps), self.gripper.finger_width_m), grip_m])
        to_lift = friction_to_lift(self._load, hands.where, grips, unsure.force_n, self.settings.depth.lift_m)
        met = np.empty((10, *inside.shape))
        met[:4] = closed(self.shape.silhouette.loops, hands, self.gripper, self.settings.hand.contact_tolerance_m)
        met[4:6] = self.surroundings.stopped(hands, self.gripper)
        met[6], met[7:] = hands.tip, to_lift[1:]
        hidden, has_height = grasps.hidden.max(axis=1), ~np.isnan(grasps.grip)
        down, across = self.surroundings.down, grasps.axis[:, ::-1] * [1.0, -1.0]
        pulls = np.full(len(grasps), abs(down[2])), np.abs(across @ down[:2])
        feet = grasps.feet.reshape(-1, 4)
        known = np.column_stack([grasps.tip + grip_m, grip_m, hidden, has_height, *pulls, grasps.width, feet])
        noise = np.sqrt(0.5) * unsure.outline_m * errors.outline
        samples = np.column_stack([errors.luck, noise, to_lift.weight])
        friction = self.settings.balance.friction_with(self.gripper)
        usual = np.array([friction, unsure.friction_share, PUSHED_ASIDE, unsure.occupied_share, NOISE_M])
        return kernels.chances(met, known, grasps.lean, samples, inside.view(np.uint8), usual)

    def _grip_m(self, grasps: GraspCandidates) -> FloatArray:
        """How much of the object's height the pads of k hands cover (k,), metres; of an object alone all they can."""
        alone = min(self.gripper.finger_length_m, float(self.shape.box.size[2]))
        return np.where(np.isnan(grasps.grip), alone, grasps.grip)

    @cached_property
    def _load(self) -> Load:
        """What any grasp has to bear."""
        errors, known = self.errors, self.settings.caging.mass_kg
        size, middle = self.shape.box.size, self.shape.gravity_center.place
        return Load(
            size=size,
            middle=middle,
            pulls=middle + float(size[:2].max()) * errors.center,
            mass=errors.density * self.shape.volume_m3 if known is None else np.full(len(errors), known),
            down=self.surroundings.down,
        )


def _inside(tolerances: Sequence[Tolerance | None], grasps: GraspCandidates, errors: Errors) -> BoolArray:
    """In which samples (k, s) each hand misses by no more than its cage's basin forgives."""
    inside = np.zeros((len(grasps), len(errors)), dtype=np.bool_)
    miss, turn = np.hypot(errors.across, errors.along), np.abs(errors.yaw)
    for row, tolerance in enumerate(tolerances):
        if tolerance is not None:
            inside[row] = miss + tolerance.lever_m * turn <= tolerance.position_m
    return inside
