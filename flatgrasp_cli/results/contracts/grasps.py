"""One grasp in a document: its poses, what was measured of it, what is proved, and whether the robot reaches it."""

from __future__ import annotations

from typing import Literal

from flatgrasp_cli.results.contracts.base import JointAngles, Number, Part, Vector3, Vector4


class PosePart(Part):
    """Where a frame is."""

    position: Vector3
    """Its origin: x, y, z in metres."""
    orientation: Vector4
    """How it is turned: a unit quaternion [x, y, z, w]."""


class PosesPart(Part):
    """One frame of the hand at the grasp, before it, and lifted."""

    pose: PosePart
    """At the grasp, while the fingers close."""
    pre_grasp: PosePart
    """Where the hand, open, sets out to go straight to the grasp."""
    lift: PosePart
    """Where it goes with the object."""


class MetricsPart(Part):
    """What the method measured of a grasp."""

    force_balance_deg: Number
    """γ, degrees: by how much the two grasping directions are not opposed."""
    torque_arm_m: Number
    """Torque of the two unit forces about the middle of the grasping line: an arm, metres."""
    required_friction: Number | None
    """The least friction coefficient that holds the grasp; null when none would."""
    variance_m: Number
    """How far the boundary strays from the two pads, metres, both sides together."""
    gravity_distance_m: Number
    """From the centre of gravity to the line through both contacts, metres."""
    inside_share: Number
    """How much of the closing segment lies inside the object, a share."""
    arc_ratio: Number
    """Boundary under the pad over the pad's chord, the larger ratio of the two sides."""
    cost_m: Number | None
    """Always null: grasps are ranked by `success.probability` instead of a cost in metres."""
    tip_height_m: Number | None
    """How high over the support plane the fingertips end, metres; of a hand that does not come straight down
    (`tilt_deg`), how high along its approach over the deepest point that was seen of the object. Null for an object
    seen alone."""
    grip_m: Number | None
    """How much of the object's height the pads cover, metres; null for an object seen alone."""
    unseen_m: Number | None
    """How much of the fingers' way the sensor did not see, metres; null for an object seen alone."""
    hidden_m: Number
    """By how much at most the object goes on out of sight behind the pads, metres, both sides together; `width_m` and
    the contacts take it for half of that."""


class CausesPart(Part):
    """What a grasp fails by, as shares of all cases, from 0 to 1; with `probability` they sum to 1."""

    lands_on_object: Number
    """The share of cases in which a fingertip comes down on the object itself."""
    stopped_short: Number
    """The share in which something else stops fingers or palm so high that the pads hold nothing, or stands where no
    ray came."""
    closes_beside: Number
    """The share in which the object is not between the fingers."""
    slips: Number
    """The share in which its sides lean by more than friction holds."""
    too_heavy: Number
    """The share in which friction does not bear its weight."""
    turns: Number
    """The share in which it turns about the pads, and is lost by that."""


class SuccessPart(Part):
    """How probable it is that the grasp holds, with the settings' `uncertainty`."""

    probability: Number
    """The share of cases in which the object is held and lifted, from 0 to 1: `clear` · `closes` · `lifts`."""
    clear: Number
    """The share in which the open hand comes to stand where it can close."""
    closes: Number
    """The share of those in which closing it there holds the object."""
    lifts: Number
    """The share of those in which the object then comes up with the hand."""
    causes: CausesPart
    """What happens otherwise."""


class JointsPart(Part):
    """Joint angles, base to wrist, along the way."""

    pre_grasp: JointAngles
    """With the flange at its `pre_grasp`, radians."""
    grasp: JointAngles
    """With the flange at its `pose`, radians."""
    lift: JointAngles
    """With the flange at its `lift`, radians."""


class ReachPart(Part):
    """Whether the robot can carry out the grasp: the joints, or the first waypoint and the limit that failed there."""

    ok: bool
    """Whether it can."""
    joints_rad: JointsPart | None
    """The joint angles that do it, radians; null when none do."""
    manipulability: Number | None
    """The least manipulability on the way, m³."""
    manipulability_share: Number | None
    """The same as a share of the arm's largest."""
    twin: bool
    """Whether the joint angles, and with them `flange` and `hand`, have the hand turned by 180° about its approach."""
    waypoint: str | None
    """Where the way ends that came furthest: pre_grasp, approach, grasp or lift; null when all is reached."""
    limit: str | None
    """What ends it there: out of reach, joint limit, joint step, manipulability, or below the table."""


class ClosurePart(Part):
    """Force closure. Forces sum to 1; torques are about the outline's centre of area, over its largest radius."""

    epsilon_points: Number
    """Ferrari & Canny's ε for fingers that touch in a point, a share of the closing force; 0: not force closed."""
    epsilon_pads: Number
    """The same for whole pads, a share of the closing force."""
    friction_margin: Number | None
    """Friction coefficient left beyond the required one; null when none would hold the grasp."""
    lift_weight: Number | None
    """How many times the object's weight the friction bears; null without a mass or the hand's force."""
    lift_torque: Number | None
    """How many times its torque about the grasping line the friction bears; null without a mass or the hand's force."""


class TolerancePart(Part):
    """How far the hand may miss, one way at a time, and still close into this grasp."""

    position_m: Number
    """In any direction, metres."""
    along_m: Number
    """Along the closing axis, metres."""
    across_m: Number
    """Across the closing axis, metres."""
    rotation_deg: Number
    """About the approach, degrees."""
    lever_m: Number
    """A turn and a shift at once are surely forgiven while shift + lever_m · turn (radians) ≤ position_m; metres."""


class CagePart(Part):
    """Within which openings the object cannot get away, or the reason why it can. A length of null: no limit."""

    squeezing: bool
    """Whether fingers that open no further hold it."""
    stretching: bool
    """Whether fingers that close no further hold it from inside."""
    reason: str | None
    """Why there is no cage."""
    on_approach: bool
    """Whether the cage holds at `opening_m` already."""
    basin_on_approach: bool
    """Whether closing from `opening_m` surely ends in this grasp."""
    opening_max_m: Number | None
    """A squeezing cage holds below this opening, metres."""
    opening_min_m: Number | None
    """A stretching cage holds above this opening, metres."""
    basin_opening_max_m: Number | None
    """Closing ends in this grasp if it begins below this opening, metres."""
    basin_opening_min_m: Number | None
    """Opening ends in this grasp if it begins above this opening, metres."""
    margin_m: Number | None
    """What the hand may open, or close, from the grasp's width before the object can get away, metres."""
    closes_into_m: Number | None
    """The width at which the fingers come to rest in the basin, metres."""
    guaranteed: bool
    """Whether it holds at the grasp's width even if the outline errs by `settings.caging.noise_m`."""
    guaranteed_opening_max_m: Number | None
    """Below which opening it then holds, metres."""
    guaranteed_opening_min_m: Number | None
    """Above which opening it then holds, metres."""
    tolerance: TolerancePart | None
    """How far the hand may miss; null without a cage."""


class ApproachPart(Part):
    """Which way the hand comes."""

    direction: Vector3
    """The unit vector along which it comes: the z axis of `pose`."""
    tilt_deg: Number
    """How far that is from straight down on the support plane, degrees; 0 for an object alone."""
    known_from: Literal["top", "main_plane", "view", "tilt", "given"]
    """What it follows from: straight down on the support plane, the normal of the object's own box, the sensor's view,
    one of the tilts of `settings.approach`, or what was asked for."""


class GraspPart(Part):
    """One grasp, by the fingertips' frame and by the flange's.

    The hand goes from `pre_grasp`, open to `opening_m`, straight to `pose`, closes to `width_m`, goes back to
    `pre_grasp` and from there to `lift`: drive the flange to those poses of `flange`. Only a hand that came straight
    down may go to `lift` at once. The flange stands still while the fingers close, and so it is placed by where their
    tips are then: `palm_offset_m` and the fingers' length at `width_m` behind `pose`, and as far behind the two others.
    An arc linkage's tips are `tip_shift_m` short of `pre_grasp` and `pose` until they have closed.

    With a robot, flange and hand are turned as the joint angles have them: by 180° about the approach against `pose`
    where `reach.twin` says so, which is the same grasp with its two fingers exchanged.
    """

    rank: int
    """Its number among the object's grasps; 1 is the best."""
    pose: PosePart
    """The fingertips' frame at the grasp: origin midway between their ends, z the approach, y the closing axis."""
    pre_grasp: PosePart
    """The fingertips' frame before the grasp, `settings.depth.approach_m` back along the approach."""
    tilt_deg: Number
    """How far from straight down on the support plane the hand comes, degrees; 0 for an object alone."""
    approach: ApproachPart
    """Which way the hand comes, and why that."""
    lift: PosePart
    """The fingertips' frame after the grasp, `settings.depth.lift_m` up from the support plane or, without, back. A
    hand that came aslant goes back to `pre_grasp` first, and from there up to this."""
    flange: PosesPart
    """The frame of the robot's flange (`tool0`, z out of it): what to drive to."""
    hand: PosesPart | None
    """The frame that the hand itself is mounted by: closing axis y, approach z; null where it is the flange."""
    tip_shift_m: Number
    """How far the fingertips come out from `opening_m` to `width_m`, metres: 0 unless they move on an arc."""
    opening_m: Number
    """How far to open the hand before it approaches, between the pads, metres."""
    width_m: Number
    """How wide the object is between the pads, metres."""
    contacts: tuple[Vector3, Vector3]
    """Where the pads meet it, on the −y side of `pose` and on the +y side: x, y, z in metres."""
    fingers: tuple[int, int]
    """The numbers of the finger candidates on the −y side and on the +y side."""
    success: SuccessPart | None
    """How probably it holds; null for a method that knows no hand (`allen`)."""
    metrics: MetricsPart
    """What the method measured of it."""
    force_closure: ClosurePart | None
    """What is proved of its force closure; null where it was not asked for."""
    cage: CagePart | None
    """What is proved of its cage; null where it was not asked for."""
    reach: ReachPart | None
    """Whether the robot can carry it out; null without a robot."""
