"""Tables of finger candidates and of grasp candidates, a row each."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model.table import Table


@dataclass(frozen=True, eq=False)
class FingerCandidates(Table):
    """m places for a finger: chords of length `width` (m,) of the boundary.

    `start`, `end`, `contact` (their midpoint) and the inward unit `direction` are (m, 2); `arcs` (m, k, 2) sample the
    boundary from start to end; `variance` (m,) measures how far the boundary strays from the chord; `arc_ratio` (m,) is
    its length over the chord's; `jaw` (m,) is 0 or 1 for the jaw that the candidate is for, −1 for either; `hidden`
    (m,) is how far the object at most goes on beyond the boundary, out of the sensor's sight: 0 where it ends.
    """

    loop: IntArray
    start: FloatArray
    end: FloatArray
    contact: FloatArray
    direction: FloatArray
    width: FloatArray
    jaw: IntArray
    arcs: FloatArray
    variance: FloatArray
    arc_ratio: FloatArray
    hidden: FloatArray

    def __len__(self) -> int:
        """Number of candidates."""
        return len(self.jaw)


def _unfilled() -> FloatArray:
    return np.empty(0)


@dataclass(frozen=True, eq=False)
class GraspCandidates(Table):
    """The grasp table: p pairs of finger candidates and what each section of the method finds out about them.

    Every column has p rows, or none while its section has not been reached. Coordinates and lengths are those of the
    plane, in metres.

    B.1, B.2: `i` and `j` index the finger candidates; `middle` (p, 2) lies midway between their contacts, `distance`
    apart; the closing axis `axis` (p, 2) points from i's side to j's. `required_friction` is the smallest coefficient
    at which the pair is force closed.

    B.3 to B.5: `pads` (p, 2) is how far each jaw's pad stands from the middle along the axis, on its −y and on its +y
    side; `room` (p, 2) the free length behind each pad, infinite where nothing stands there.

    How the hand comes: the `opening` to come with, and `tip`, the height at which the fingertips end. `grip` is the
    pads' height on the object, `margin` the free space that there is at most beside each pad and the palm, `palm_room`
    that beside the palm alone, `unseen` how much of the fingers' way, both sides together, no ray reached; `touch` is
    the height at which both sides were seen, that of the contacts. Of an object seen alone grip and unseen are not
    known: NaN.

    `hidden` (p, 2) is how far the object at most goes on behind each pad's side, out of sight; by half of that the pads
    stand beyond where it was seen to end. `lean` (p, h) are the tangents of the angles by which both walls together
    lean away from upright, half and half: for fingertips where they should end, and for such that end higher by equal
    shares of the grip. `feet` (p, 2, 2) are the least and the greatest height at which i's and j's wall end below.

    C: `gravity_distance`, and the `inside_share` of the grasping line that lies in the object.

    `success` (p, 3) are the chances that the open hand comes to stand there, that closing it then holds the object, and
    that it is lifted then; `causes` (p, c) the chances of what it fails by, and `probability` (p,) that it holds: NaN
    where that was only estimated. Grasps of a larger `merit` (p,) are better: that is their probability or, if the
    settings want it so, how little their gravity distance is; for point fingers the depth of their cage.

    Of the final grasps: `contacts` (p, 2, 2), the middles of what the pads touch, and `touched_m` (p, 2), how long that
    is; `variance` and `arc_ratio` of the two finger candidates.
    """

    i: IntArray
    j: IntArray
    middle: FloatArray
    axis: FloatArray
    distance: FloatArray
    force_balance_deg: FloatArray
    torque_arm_m: FloatArray
    required_friction: FloatArray
    pads: FloatArray = field(default_factory=_unfilled)
    room: FloatArray = field(default_factory=_unfilled)
    opening: FloatArray = field(default_factory=_unfilled)
    tip: FloatArray = field(default_factory=_unfilled)
    grip: FloatArray = field(default_factory=_unfilled)
    margin: FloatArray = field(default_factory=_unfilled)
    palm_room: FloatArray = field(default_factory=_unfilled)
    unseen: FloatArray = field(default_factory=_unfilled)
    touch: FloatArray = field(default_factory=_unfilled)
    hidden: FloatArray = field(default_factory=_unfilled)
    lean: FloatArray = field(default_factory=_unfilled)
    feet: FloatArray = field(default_factory=_unfilled)
    gravity_distance: FloatArray = field(default_factory=_unfilled)
    inside_share: FloatArray = field(default_factory=_unfilled)
    merit: FloatArray = field(default_factory=_unfilled)
    success: FloatArray = field(default_factory=_unfilled)
    causes: FloatArray = field(default_factory=_unfilled)
    probability: FloatArray = field(default_factory=_unfilled)
    contacts: FloatArray = field(default_factory=_unfilled)
    touched_m: FloatArray = field(default_factory=_unfilled)
    variance: FloatArray = field(default_factory=_unfilled)
    arc_ratio: FloatArray = field(default_factory=_unfilled)

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.i)

    @property
    def width(self) -> FloatArray:
        """The object's width between the pads (p,)."""
        return np.asarray(self.pads[:, 0] + self.pads[:, 1])

    @property
    def beyond(self) -> FloatArray:
        """How far (p,) the object at most goes on beyond the pads, out of sight, on the side where that is more."""
        return np.asarray(0.5 * np.maximum(self.hidden[:, 0], self.hidden[:, 1]))

    @property
    def center(self) -> FloatArray:
        """Where the hand's approach axis meets the plane (p, 2): midway between the pads."""
        shift = 0.5 * (self.pads[:, 1] - self.pads[:, 0])
        return np.asarray(self.middle + shift[:, None] * self.axis)

    @property
    def hands(self) -> FloatArray:
        """Where hands that have closed stand, rows (p, 5): the centre, the closing axis, and half the width."""
        return np.concatenate([self.center, self.axis, 0.5 * self.width[:, None]], axis=1)

    def first(self, count: int) -> GraspCandidates:
        """The first `count` pairs, or all of them if there are fewer."""
        return self.select(np.arange(min(count, len(self))))

    def with_rows(self, rows: IntArray, others: GraspCandidates) -> GraspCandidates:
        """The pairs with those in `rows` exchanged for the `others`, of which as much is known."""
        if len(rows) == len(self):
            return others
        columns = {name: values.copy() for name, values in vars(self).items() if len(values)}
        for name, values in columns.items():
            values[rows] = vars(others)[name]
        return self.having(**columns)


@dataclass(frozen=True, slots=True, eq=False)
class OpenHands:
    """Open hands in the plane, s for each of k grasps, where they really come to stand.

    `where` (k, s, 5) are the place midway between the pads, the unit axis that they close along, and half the opening;
    the fingertips end at the heights `tip` (k, s).
    """

    where: FloatArray
    tip: FloatArray

    @property
    def rows(self) -> FloatArray:
        """`where` they stand, one after the other (k·s, 5)."""
        return self.where.reshape(-1, 5)
