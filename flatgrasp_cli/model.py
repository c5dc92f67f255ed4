"""The records that flow from a recording to a result. All are frozen; arrays in them are not written to.

Lengths are metres, angles in names ending `_deg` degrees. "Plane" coordinates (…, 2) are those of a silhouette's frame.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray, IntArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap

T = TypeVar("T", "FingerCandidates", "GraspCandidates")


def _select(table: T, keep: BoolArray | IntArray) -> T:
    """The rows of a table of equally long arrays that a mask or an index array names."""
    rows = np.flatnonzero(keep) if keep.dtype == np.bool_ else keep
    return type(table)(*(getattr(table, name).take(rows, axis=0) for name in table.__slots__))


@dataclass(frozen=True, slots=True)
class Source:
    """Where a cloud was recorded: file, topic, time, and its place among the frames read."""

    path: str
    topic: str | None = None
    stamp_ns: int | None = None
    index: int = 0

    def __str__(self) -> str:
        return self.path if self.stamp_ns is None else f"{self.path} at {self.stamp_ns / 1e9:.3f} s"


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """One recorded frame: finite `points` (n, 3) in `frame_id`, seen from `viewpoint` (3,)."""

    points: FloatArray
    viewpoint: FloatArray
    source: Source
    frame_id: str = ""
    dropped: int = 0
    """Points of the recording that were NaN or infinite."""
    colors: ByteArray | None = None
    """RGB (n, 3) of the points, where the recording has colours and they were asked for."""

    def scaled(self, scale: float) -> Cloud:
        """The cloud in metres, `scale` of which are one unit of this one."""
        return self if scale == 1.0 else replace(self, points=self.points * scale, viewpoint=self.viewpoint * scale)

    def select(self, keep: BoolArray) -> Cloud:
        """The points (n,) that `keep` names."""
        colors = None if self.colors is None else self.colors[keep]
        return replace(self, points=self.points[keep], colors=colors)


@dataclass(frozen=True, slots=True, eq=False)
class SupportPlane:
    """The plane that objects stand on: `normal` · p = `offset_m`, the unit normal (3,) on the sensor's side.

    `noise_m` is the standard deviation of the plane's own points about it.
    """

    normal: FloatArray
    offset_m: float
    noise_m: float

    def heights(self, points: FloatArray) -> FloatArray:
        """Heights (n,) of `points` (n, 3) above the plane."""
        return np.asarray(points @ self.normal - self.offset_m)


@dataclass(frozen=True, slots=True, eq=False)
class Floor:
    """What was seen of a support plane with nothing on it: cells of its own `frame`, whose z axis is the normal.

    `levels` holds the height over the plane around each such cell, −inf in all others. Cells serve all objects alike
    and are far fewer than the plane's points.
    """

    frame: Frame
    levels: HeightMap

    @property
    def points(self) -> FloatArray:
        """The middles (k, 3) of the cells, in the world."""
        return self.frame.to_world(self.levels.higher_than(UNSEEN))


@dataclass(frozen=True, slots=True, eq=False)
class ObjectCloud:
    """The points (n, 3) of one object, seen from `viewpoint` (3,).

    `support` is the plane it stands on, None when it was seen alone, and `floor` what was seen of that. Near it lie
    other points above the plane, `obstacles` (m, 3), for fingers and palm to keep clear of.
    """

    id: int
    points: FloatArray
    viewpoint: FloatArray
    support: SupportPlane | None = None
    obstacles: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    floor: Floor | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What a cloud shows: objects, and the plane that they stand on (None: one object, seen alone).

    `clutter` (k, 3) are points above the plane that belong to no object; `reason` says why there is no object.
    """

    support: SupportPlane | None
    objects: tuple[ObjectCloud, ...]
    clutter: FloatArray
    reason: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class OrientedBox:
    """The oriented bounding box: `frame` at its centre (x major, y middle, z minor axis, to the sensor), `size` (3,).

    The x-y plane of `frame` is the main plane. `aabb` (2, 3) are the corners of the axis-aligned box, for comparison.
    """

    frame: Frame
    size: FloatArray
    aabb: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Silhouette:
    """The object's concave hull in the main plane.

    `loops` hold vertices (n, 2) in serial order: the outer loop counter-clockwise, then the holes clockwise, so that
    the object lies to the left of the walk. `points` (k, 2) are all projected points, `heights` (k,) their heights
    above the main plane; `coverage` is the share of the concave hull's area in `loops`, the rest being fragments.
    """

    frame: Frame
    loops: tuple[FloatArray, ...]
    points: FloatArray
    heights: FloatArray
    alpha_m: float
    coverage: float


@dataclass(frozen=True, slots=True, eq=False)
class StepPoints:
    """Step points of one loop: arc lengths `positions` (s,) and `points` (s, 2), `step_m` apart (the paper's r)."""

    loop: int
    positions: FloatArray
    points: FloatArray
    step_m: float


@dataclass(frozen=True, slots=True, eq=False)
class FingerCandidates:
    """m places for a finger: chords of length `width` (m,) of the boundary.

    `start`, `end`, `contact` (their midpoint) and the inward unit `direction` are (m, 2); `arcs` (m, k, 2) sample the
    boundary from start to end; `variance` (m,) measures how far the boundary strays from the chord; `arc_ratio` (m,) is
    its length over the chord's; `jaw` (m,) is 0 or 1 for the jaw that the candidate is for, −1 for either; `hidden`
    (m,) is how far the object probably goes on beyond the boundary, out of the sensor's sight, and `seen` (m,) whether
    it was seen that the object ends there.
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
    seen: BoolArray

    def __len__(self) -> int:
        """Number of candidates."""
        return len(self.jaw)

    def select(self, keep: BoolArray | IntArray) -> FingerCandidates:
        """The candidates that `keep`, a mask or an index array, names."""
        return _select(self, keep)


@dataclass(frozen=True, slots=True, eq=False)
class GraspCandidates:
    """p pairs of finger candidates with what is known of each; every field has p rows.

    `i` and `j` index the finger candidates; the closing axis `axis` (p, 2) points from i's side to j's.
    `required_friction` is the smallest coefficient at which the pair is force closed.
    """

    i: IntArray
    j: IntArray
    axis: FloatArray
    distance: FloatArray
    force_balance_deg: FloatArray
    torque_arm_m: FloatArray
    required_friction: FloatArray

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.i)

    def select(self, keep: BoolArray | IntArray) -> GraspCandidates:
        """The pairs that `keep`, a mask or an index array, names."""
        return _select(self, keep)


@dataclass(frozen=True, slots=True)
class Stage:
    """One line of the funnel: how many candidates were left after a stage of the method."""

    stage: str
    kept: int


@dataclass(frozen=True, slots=True)
class Rejection:
    """Why there is no grasp: the stage that removed the last candidate, and the nearest miss in numbers."""

    stage: str
    reason: str
    value: float | None = None
    limit: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Whether the arm reaches a grasp, and how.

    If `ok`, `joints_rad` (3, 6) are the angles at the pre-grasp pose, at the grasp and at the end of the lift,
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


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """One grasp, best first by `rank` from 1.

    `position` (3,) and `orientation` [x, y, z, w] are the fingertip frame's: origin midway between the fingertip ends,
    z the approach, y the closing axis. `contacts` (2, 3) are on the −y and the +y side, `fingers` the candidates there.
    Over a support plane the fingertips end `tip_height_m` above it, the pads cover `grip_m` of the object's height, and
    `unseen_m` of the fingers' way was hidden from the sensor; None for an object seen alone.
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
    cost_m: float
    tip_height_m: float | None = None
    grip_m: float | None = None
    unseen_m: float | None = None
    cage: Cage | None = None
    closure: Closure | None = None
    reach: Reach | None = None


@dataclass(slots=True, eq=False)
class Trace:
    """What each step of the method saw, for figures and for study; filled while the method runs, None where it ended.

    `force_balance_deg` (m, k) is γ of all candidates for jaw 0 with all for jaw 1. `survivors` maps a stage's name to
    the (k, 2) pairs of candidates that it kept, in the method's order; `ranked` are the last of them, best first, and
    `gravity_distance_m` theirs. `level_m` is the height over the support plane above which the silhouette was taken.
    """

    box: OrientedBox | None = None
    level_m: float | None = None
    silhouette: Silhouette | None = None
    steps: tuple[StepPoints, ...] = ()
    fingers: FingerCandidates | None = None
    doubted_directions: int = 0
    force_balance_deg: FloatArray | None = None
    survivors: dict[str, IntArray] = field(default_factory=dict)
    gravity_center: FloatArray | None = None
    ranked: IntArray | None = None
    gravity_distance_m: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ObjectPlan:
    """The answer for one object: its grasps, or the rejection that says why there are none.

    `refused` are the best of the grasps that a robot cannot carry out.
    """

    object: ObjectCloud
    funnel: tuple[Stage, ...]
    grasps: tuple[Grasp, ...]
    rejection: Rejection | None
    trace: Trace
    refused: tuple[Grasp, ...] = ()
