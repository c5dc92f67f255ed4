"""How probable it is that a grasp holds, and what it fails by.

Each grasp is carried out in thought, once for each sample of what is not known (`errors`): the probability of force
closure under errors of the pose (Weisz & Allen, "Pose error robust grasping from contact wrench space metrics", ICRA
2012), with what the hand meets on its way and what the object weighs besides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.polygon import cross
from flatgrasp_cli.model import GraspCandidates, OpenHands, PlaneShape, Tolerance
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.ranking.closing import closed, moved
from flatgrasp_cli.ranking.errors import Errors, errors_of, friction_suffices
from flatgrasp_cli.ranking.lifting import Load, friction_to_lift
from flatgrasp_cli.surroundings.interface import Surroundings
from flatgrasp_cli.surroundings.maps import NOISE_M

CLEAR, CLOSES, LIFTS = ("lands_on_object", "stopped_short"), ("closes_beside", "slips"), ("too_heavy", "turns")
CAUSES = (*CLEAR, *CLOSES, *LIFTS)
"""What a grasp fails by, in the order of carrying it out: only the first counts."""
PUSHED_ASIDE = 0.8
"""How often an object is held on which a fingertip comes down with its middle: it slides off a rounded edge, or moves
what is free to move. In simulation 96 of 121 were, of 25 objects and from all sides."""
TURNED_HELD = 0.9
"""How often an object is held that turns about the pads: as a rule it turns until it hangs, and stays between them. Of
tries in simulation that came to that, about 30, two or three were lost."""


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """What grasps are carried out on, among what, and with which hand; and with which `share` of the samples."""

    shape: PlaneShape
    surroundings: Surroundings
    gripper: Gripper
    settings: PlannerSettings

    share: float = 1.0

    @property
    def briefly(self) -> Situation:
        """The same, with a quarter of the samples: their first, which are spread evenly, too."""
        return replace(self, share=0.25)

    @property
    def errors(self) -> Errors:
        """The samples of what is not known, the same for all grasps."""
        unsure = self.settings.uncertainty.figures
        return errors_of(replace(unsure, samples=max(1, round(self.share * unsure.samples))), self.settings.seed)

    def tried(self, grasps: GraspCandidates, tolerances: Sequence[Tolerance | None] = ()) -> GraspCandidates:
        """The k grasps with `success`, `causes` and `probability`.

        `tolerances` say of each how far a hand may miss that comes into a cage's basin, where it does: then closing
        ends in the grasp.
        """
        chances = self._chances(grasps, _inside(tolerances, grasps, self.errors))
        left = np.column_stack([chance.mean(axis=1) for chance in chances])
        causes = -np.diff(left, axis=1, prepend=1.0)
        after = left[:, np.cumsum([len(CLEAR), len(CLOSES), len(LIFTS)]) - 1]
        before = np.column_stack([np.ones(len(grasps)), after[:, :-1]])
        success = np.divide(after, before, out=np.ones_like(after), where=before > 0)
        return grasps.having(success=success, causes=causes, probability=left[:, -1])

    def _chances(self, grasps: GraspCandidates, inside: BoolArray) -> list[FloatArray]:
        """How probably k grasps have not failed yet in s samples, (k, s) after each of the `CAUSES`.

        Where the hand is `inside` (k, s) a basin, closing ends in the grasp, and its two sides are opposed again. What
        depends on friction alone, or on what was not seen, is a chance in each sample; all else is 0 or 1 there.
        """
        errors, each = self.errors, inside.shape
        center, axis = moved(grasps.center, grasps.axis, errors)
        hands = OpenHands(
            center=center.reshape(-1, 2),
            axis=axis.reshape(-1, 2),
            opening=np.repeat(grasps.opening, len(errors)),
            tip=(grasps.tip[:, None] + errors.height).ravel(),
        )
        found = closed(self.shape.silhouette.loops, hands, self.gripper, self.settings.hand.contact_tolerance_m)
        stops = self.surroundings.stopped(hands, self.gripper)
        dark = stops.dark.reshape(each)
        hidden = errors.luck * grasps.hidden.max(axis=1)[:, None]
        held = self._held_m(grasps, np.maximum(hands.tip, stops.height).reshape(each))
        wedge = np.where(inside, 0.0, np.tan(found.wedge).reshape(each))
        force_n = self.gripper.max_force_n or self.settings.uncertainty.figures.force_n
        pads = np.column_stack([np.full(len(grasps), self.gripper.finger_width_m), self._grip_m(grasps)])
        to_lift = friction_to_lift(self._load(grasps, center, axis), force_n, pads, self.settings.depth.lift_m)
        lands = ~found.free.reshape(each) | (found.room.reshape(each) < hidden)
        beside = np.where(lands, PUSHED_ASIDE, 1.0)
        down = beside * (held >= NOISE_M) * (1 - self.settings.uncertainty.figures.occupied_share * dark)
        around = down * (found.between.reshape(each) | inside | lands)
        chances, need = [beside, down, around], np.zeros(each)
        for more in (np.hypot(wedge, self._lean(grasps, held)), to_lift.weight):
            need = np.maximum(need, more)
            chances.append(around * self._rubs(need))
        still = around * self._rubs(np.maximum(need, to_lift.turning))
        return [*chances, still + TURNED_HELD * (chances[-1] - still)]

    def _rubs(self, need: FloatArray) -> FloatArray:
        """How probable it is that the pads' friction is more than `need` (…)."""
        usual = self.settings.balance.friction_with(self.gripper)
        return friction_suffices(need, usual, self.settings.uncertainty.figures)

    def _grip_m(self, grasps: GraspCandidates) -> FloatArray:
        """How much of the object's height the pads of k hands cover (k,), metres; of an object alone all they can."""
        alone = min(self.gripper.finger_length_m, float(self.shape.box.size[2]))
        return np.where(np.isnan(grasps.grip), alone, grasps.grip)

    def _held_m(self, grasps: GraspCandidates, tip: FloatArray) -> FloatArray:
        """The same for fingertips that really end at `tip` (k, s)."""
        top = grasps.tip + self._grip_m(grasps)
        return np.asarray(np.maximum(top[:, None] - tip, 0.0))

    def _lean(self, grasps: GraspCandidates, held: FloatArray) -> FloatArray:
        """Tangent (k, s) of the angle by which the walls lean: the less of them is `held` (k, s), the less is known.

        An object alone has upright sides, for want of anything that tells.
        """
        noise = np.sqrt(0.5) * self.settings.uncertainty.figures.outline_m * self.errors.outline
        levels = grasps.lean.shape[1]
        higher = levels * (1 - held / np.maximum(self._grip_m(grasps), NOISE_M)[:, None]).clip(0.0, 1.0)
        below = np.minimum(higher, levels - 1).astype(np.intp)
        rows = np.arange(len(grasps))[:, None]
        known, next_known = grasps.lean[rows, below], grasps.lean[rows, np.minimum(below + 1, levels - 1)]
        lean = known + (higher - below) * (next_known - known) + noise / np.maximum(0.5 * held, NOISE_M)
        return np.where(np.isnan(grasps.grip)[:, None], 0.0, np.maximum(lean, 0.0))

    def _load(self, grasps: GraspCandidates, center: FloatArray, axis: FloatArray) -> Load:
        """What k grasps, by hands with the centres and axes (k, s, 2), have to bear.

        The weight pulls along `down`: to a hand that comes aslant the object's middle may lie beside the contacts by
        being deeper.
        """
        errors, known, down = self.errors, self.settings.caging.mass_kg, self.surroundings.down
        *flat, deep = self.shape.box.size.tolist()
        length, middle = max(flat), self.shape.gravity_center.place
        over = 0.5 * deep - grasps.tip - 0.5 * self._grip_m(grasps)
        beside = cross(axis, middle + length * errors.center - center)
        arm = np.abs(down[2] * beside + over[:, None] * cross(down[:2], axis))
        mass = errors.density * self.shape.volume_m3 if known is None else np.full(len(errors), known)
        aslant = float(np.linalg.norm(down[:2]))
        away = np.hypot(np.linalg.norm(middle - center, axis=2).mean(axis=1), aslant * over)
        return Load(mass, arm, away + 0.5 * max(length, aslant * deep))


def _inside(tolerances: Sequence[Tolerance | None], grasps: GraspCandidates, errors: Errors) -> BoolArray:
    """In which samples (k, s) each hand misses by no more than its cage's basin forgives."""
    inside = np.zeros((len(grasps), len(errors)), dtype=np.bool_)
    miss, turn = np.hypot(errors.across, errors.along), np.abs(errors.yaw)
    for row, tolerance in enumerate(tolerances):
        if tolerance is not None:
            inside[row] = miss + tolerance.lever_m * turn <= tolerance.position_m
    return inside
