"""A grasp, and what is known of it: cage, force closure, reach, and how it is carried out."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model.poses import Pose, Poses, Way


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Whether the arm reaches a grasp, and how.

    If `ok`, `joints_rad` (3, j) are the angles at the pre-grasp pose, at the grasp and at the end of the lift,
    `manipulability` is the least on the way, in m³, `manipulability_share` that over the arm's largest, and `twin` says
    whether the hand is turned by 180°. If not, `waypoint` (pre_grasp, approach, grasp or lift) is where the branch that
    came furthest had to stop, and `limit`, one of `robot.reach.LIMITS`, what stopped it.
    """

    ok: bool
    joints_rad: FloatArray | None = None
    manipulability: float | None = None
    manipulability_share: float | None = None
    twin: bool = False
    waypoint: str | None = None
    limit: str | None = None


@dataclass(frozen=True, slots=True)
class Closure:
    """Force closure: Ferrari & Canny's ε of fingers that touch in a point and of whole pads, and friction to spare.

    `friction_margin` is None where no friction would do. `lift_weight` and `lift_torque` are how often the object's
    own weight and its torque about the grasping line the friction bears; None without a mass or the hand's force.
    """

    epsilon_points: float
    epsilon_pads: float
    friction_margin: float | None
    lift_weight: float | None = None
    lift_torque: float | None = None


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far the hand may miss, one way at a time, and still close into the same grasp.

    `position_m` in any direction, `along_m` the closing axis and `across_m` it; `rotation_deg` about the approach. A
    turn and a shift at once are surely forgiven while shift + `lever_m` · turn (rad) ≤ `position_m`.
    """

    position_m: float
    along_m: float
    across_m: float
    rotation_deg: float
    lever_m: float


@dataclass(frozen=True, slots=True)
class Cage:
    """Whether the fingers hold the object without touching it, and within which openings; lengths of None: no limit.

    A squeezing cage holds a hand that opens no further than `opening_max_m`; closing, it ends in this grasp if it began
    below `basin_opening_max_m`. A stretching cage holds from inside, above `opening_min_m`; opening, it ends in this
    grasp if it began above `basin_opening_min_m`. `margin_m` is what the hand may open (or close) from the grasp's
    width before the object can get away. `closes_into_m` is the width at which the fingers come to rest in the basin.
    `guaranteed` says whether the outline may err by the settings' noise and the cage still hold at the grasp's width,
    `guaranteed_opening_max_m` or `_min_m` up to which opening. `on_approach` and `basin_on_approach` say whether cage
    and basin hold at the opening of the approach already. `reason` says why there is no cage.
    """

    squeezing: bool
    stretching: bool
    reason: str | None
    on_approach: bool = False
    basin_on_approach: bool = False
    opening_max_m: float | None = None
    opening_min_m: float | None = None
    basin_opening_max_m: float | None = None
    basin_opening_min_m: float | None = None
    margin_m: float | None = None
    closes_into_m: float | None = None
    guaranteed: bool = False
    guaranteed_opening_max_m: float | None = None
    guaranteed_opening_min_m: float | None = None
    tolerance: Tolerance | None = None


@dataclass(frozen=True, slots=True)
class Success:
    """How probable it is that a grasp holds, and what it fails by.

    `clear` is the chance that the open hand comes to stand where it can close, `closes` that closing it there holds the
    object, and `lifts` that the object then comes up with it: `probability` is their product. `causes` has the chances
    of what else happens, by name: with `probability` they sum to 1.
    """

    probability: float
    clear: float
    closes: float
    lifts: float
    causes: dict[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Approach:
    """Which way a hand comes: along the unit vector `direction` (3,), `tilt_deg` from straight down.

    `known_from` says what the direction follows from: straight down on the support plane (`top`), the normal of the
    object's own box (`main_plane`), the sensor's view, a tilt, or that it was given. The tilt of an object alone is 0.
    """

    direction: FloatArray
    tilt_deg: float
    known_from: Literal["top", "main_plane", "view", "tilt", "given"]


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """One grasp, best first by `rank` from 1.

    `position` (3,) and `orientation` [x, y, z, w] are the fingertip frame's: origin midway between the fingertip ends,
    z the approach, y the closing axis. `contacts` (2, 3) are on the −y and the +y side, `fingers` the candidates there.
    Over a support plane the fingertips end `tip_height_m` above it, the pads cover `grip_m` of the object's height, and
    `unseen_m` of the fingers' way was hidden from the sensor; None for an object seen alone. Out of sight the object
    may go on by `hidden_m`, and `width_m` has half of that. `way` has the poses before and after, and the flange's.
    """

    rank: int
    position: FloatArray
    orientation: FloatArray
    opening_m: float
    width_m: float
    contacts: FloatArray
    fingers: tuple[int, int]
    force_balance_deg: float
    torque_arm_m: float
    required_friction: float
    variance_m: float
    gravity_distance_m: float
    inside_share: float
    arc_ratio: float
    approach: Approach
    way: Way = field(repr=False)
    tip_height_m: float | None = None
    grip_m: float | None = None
    unseen_m: float | None = None
    hidden_m: float = 0.0
    success: Success | None = None
    cage: Cage | None = None
    closure: Closure | None = None
    reach: Reach | None = None

    @property
    def pre_grasp(self) -> Pose:
        """The fingertips' pose before the grasp: from there the hand, open, goes straight to the grasp."""
        return self.way.tips.pre_grasp

    @property
    def lift(self) -> Pose:
        """The fingertips' pose after the grasp, with the object lifted."""
        return self.way.tips.lift

    @property
    def tilt_deg(self) -> float:
        """How far from straight down on the support plane the hand comes, degrees; 0 for an object alone."""
        return self.approach.tilt_deg

    @property
    def flange(self) -> Poses:
        """What to drive to: the poses of the arm's flange (`tool0`), turned as `reach.joints_rad` have it."""
        return self.way.flange

    @property
    def hand(self) -> Poses:
        """The poses of the frame that the hand itself is mounted by: the flange's, if no adapter is between them."""
        return self.way.hand or self.way.flange
