"""The JSON contract `flatgrasp.plan/1`: a Plan as a document, and its JSON Schema.

Numbers are finite or null. Adding a key is fine; renaming one or changing its meaning makes a new schema id.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Grasp, KnownFrom, ObjectPlan, OrientedBox, Reach, Sensor, Silhouette, SupportPlane
from flatgrasp_cli.planner.gravity import gravity_center
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot
from flatgrasp_cli.results.remedies import remedy_of

SCHEMA_ID: Literal["flatgrasp.plan/1"] = "flatgrasp.plan/1"
DECIMALS = 9
"""A nanometre, and well below what a double holds of a scene's coordinates."""

Number = Annotated[float, Field(allow_inf_nan=False)]
Vector2 = tuple[Number, Number]
Vector3 = tuple[Number, Number, Number]
Vector6 = tuple[Number, Number, Number, Number, Number, Number]
Vector4 = tuple[Number, Number, Number, Number]
Status = Literal["ok", "no_grasp"]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class SourcePart(_Part):
    """The frame that was planned on.

    `dropped` counts the points that were not measured: NaN, infinite, exactly 0 0 0, or farther away than 10 km.
    """

    path: str
    topic: str | None
    stamp_ns: int | None
    frame_id: str
    points: int
    dropped: int
    index: int


class SensorPart(_Part):
    """Where the sensor was, in `frame_id`; null where that is not known, or several saw the cloud.

    `known_from` says how it is known; where only that is known, the unit vector `direction` points to it.
    """

    position: Vector3 | None
    direction: Vector3 | None
    known_from: KnownFrom


class WarningPart(_Part):
    """Something that had to be assumed and can change the answer: a stable code, and a sentence with the remedy."""

    code: str
    text: str


class SupportPlanePart(_Part):
    """The plane that objects stand on: normal · p = offset_m; `noise_m` is its own points' scatter about it."""

    normal: Vector3
    offset_m: Number
    noise_m: Number


class BoxPart(_Part):
    """An oriented box; `axes` are its x, y, z axes."""

    center: Vector3
    axes: tuple[Vector3, Vector3, Vector3]
    size_m: Vector3


class AabbPart(_Part):
    """The axis-aligned box, for comparison."""

    min: Vector3
    max: Vector3


class SilhouettePart(_Part):
    """Loops of [u, v] in metres in the plane through `origin` along `axes`; the outer loop first, counter-clockwise.

    They outline what lies higher than `level_m` over the support plane; null for an object seen alone.
    """

    origin: Vector3
    axes: tuple[Vector3, Vector3]
    loops: list[list[Vector2]]
    level_m: Number | None
    alpha_m: Number
    coverage: Number


class FingersPart(_Part):
    """How the outline was sampled: step r, and candidates whose direction failed the inside test."""

    step_m: Number | None
    doubted_directions: int


class GravityPart(_Part):
    """Centre of the outline's area, mean of the visible points, their distance, and which of the two was used."""

    area: Vector3
    points: Vector3
    distance_m: Number
    used: Literal["area", "points"]


class StagePart(_Part):
    """How many candidates a stage of the method kept."""

    stage: str
    kept: int


class MissPart(_Part):
    """The stage that kept nothing, the value that came nearest, and the limit that it missed."""

    stage: str
    value: Number | None
    limit: Number | None


class PosePart(_Part):
    """The fingertip frame: origin midway between the fingertip ends, z approach, y closing; quaternion [x, y, z, w]."""

    position: Vector3
    orientation: Vector4


class MetricsPart(_Part):
    """What the method measured of a grasp. `required_friction` is null when no friction would hold it.

    Over a support plane, else null: the fingertips end `tip_height_m` above it, the pads cover `grip_m` of the object's
    height, and the sensor did not see `unseen_m` of the fingers' way.
    """

    force_balance_deg: Number
    torque_arm_m: Number
    required_friction: Number | None
    variance_m: Number
    gravity_distance_m: Number
    inside_share: Number
    arc_ratio: Number
    cost_m: Number
    tip_height_m: Number | None
    grip_m: Number | None
    unseen_m: Number | None


class JointsPart(_Part):
    """Joint angles in radians, base to wrist."""

    pre_grasp: Vector6
    grasp: Vector6
    lift: Vector6


class ReachPart(_Part):
    """Whether the robot can carry out the grasp: the joints, or the first `waypoint` and the `limit` that failed there.

    `twin` says that the hand is turned by 180° about its approach. `manipulability` is the least on the way, in m³.
    """

    ok: bool
    joints_rad: JointsPart | None
    manipulability: Number | None
    manipulability_share: Number | None
    twin: bool
    waypoint: str | None
    limit: str | None


class ClosurePart(_Part):
    """Force closure: Ferrari & Canny's ε for point contacts and for whole pads, and friction beyond what is needed.

    Forces sum to 1; torques are about the outline's centre of area, over its largest radius. 0: not force closed.
    Above 1, `lift_weight` and `lift_torque` say that friction bears the object's weight and its torque about the
    grasping line; null without a mass or the hand's force.
    """

    epsilon_points: Number
    epsilon_pads: Number
    friction_margin: Number | None
    lift_weight: Number | None
    lift_torque: Number | None


class TolerancePart(_Part):
    """How far the hand may miss, one way at a time, and still close into this grasp.

    A turn and a shift at once are surely forgiven while shift + `lever_m` · turn (rad) ≤ `position_m`.
    """

    position_m: Number
    along_m: Number
    across_m: Number
    rotation_deg: Number
    lever_m: Number


class CagePart(_Part):
    """Within which openings the object cannot get away, or the `reason` why it can; null: no limit.

    Below `opening_max_m` it is caged, below `basin_opening_max_m` closing ends in this grasp; `opening_min_m` and
    `basin_opening_min_m` are the same of fingers that open. `guaranteed`: even if the outline errs by the settings'
    noise.
    """

    squeezing: bool
    stretching: bool
    reason: str | None
    on_approach: bool
    basin_on_approach: bool
    opening_max_m: Number | None
    opening_min_m: Number | None
    basin_opening_max_m: Number | None
    basin_opening_min_m: Number | None
    margin_m: Number | None
    closes_into_m: Number | None
    guaranteed: bool
    guaranteed_opening_max_m: Number | None
    guaranteed_opening_min_m: Number | None
    tolerance: TolerancePart | None


class GraspPart(_Part):
    """One grasp; `contacts` and `fingers` are the −y side's and the +y side's.

    The hand goes from `pre_grasp`, open to `opening_m`, to `pose`, closes, and goes to `lift`. An arc linkage's tips
    are `tip_shift_m` short of `pose` until they have closed.
    """

    rank: int
    pose: PosePart
    pre_grasp: PosePart
    lift: PosePart
    tip_shift_m: Number
    opening_m: Number
    width_m: Number
    contacts: tuple[Vector3, Vector3]
    fingers: tuple[int, int]
    metrics: MetricsPart
    force_closure: ClosurePart | None
    cage: CagePart | None
    reach: ReachPart | None


class ObjectPart(_Part):
    """One object: what was found of it, and its grasps, best first; `refused` are those out of the robot's reach.

    Without a grasp, `reason` says why, and `remedy`, where one is known, what would help.
    """

    id: int
    points: int
    status: Status
    reason: str | None
    remedy: str | None
    nearest_miss: MissPart | None
    obb: BoxPart | None
    aabb: AabbPart | None
    silhouette: SilhouettePart | None
    gravity_center: GravityPart | None
    fingers: FingersPart
    funnel: list[StagePart]
    grasps: list[GraspPart]
    refused: list[GraspPart]


class TimingPart(_Part):
    """Milliseconds of wall time; `total` from opening the source to the finished document."""

    read: Number
    scene: Number
    plan: Number
    total: Number


class Document(_Part):
    """The answer for one frame; `reason` and `remedy` are null when there is a grasp."""

    id: Literal["flatgrasp.plan/1"] = Field(alias="schema")
    status: Status
    reason: str | None
    remedy: str | None
    source: SourcePart
    sensor: SensorPart
    warnings: list[WarningPart]
    frame_id: str
    gripper: Gripper
    robot: Robot | None
    settings: PlannerSettings
    support_plane: SupportPlanePart | None
    objects: list[ObjectPart]
    timing_ms: TimingPart


def json_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of a document."""
    schema = Document.model_json_schema(by_alias=True, mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA_ID, **schema}


def to_document(plan: Plan, read_ms: float = 0.0) -> dict[str, Any]:
    """A plan as the JSON-ready document of schema `flatgrasp.plan/1`.

    Parameters
    ----------
    plan
        From `flatgrasp_cli.plan`.
    read_ms
        Milliseconds that reading the cloud took.
    """
    cloud, source = plan.cloud, plan.cloud.source
    document = Document(
        schema=SCHEMA_ID,
        status="ok" if plan.best is not None else "no_grasp",
        reason=plan.reason,
        remedy=None if plan.best else remedy_of(plan, plan.objects[0] if plan.objects else None),
        source=SourcePart(
            path=source.path,
            topic=source.topic,
            stamp_ns=source.stamp_ns,
            frame_id=cloud.frame_id,
            points=len(cloud.points),
            dropped=cloud.dropped,
            index=source.index,
        ),
        sensor=_sensor(cloud.sensor or Sensor("assumed")),
        warnings=[WarningPart(code=warning.code, text=warning.text) for warning in plan.warnings],
        frame_id=cloud.frame_id,
        gripper=plan.gripper,
        robot=plan.robot,
        settings=plan.settings,
        support_plane=plan.scene.support and _plane(plan.scene.support),
        objects=[_object(item, plan) for item in plan.objects],
        timing_ms=TimingPart(
            read=round(read_ms, 3),
            scene=round(plan.scene_ms, 3),
            plan=round(plan.plan_ms, 3),
            total=round(read_ms + plan.scene_ms + plan.plan_ms, 3),
        ),
    )
    return document.model_dump(mode="json", by_alias=True)


def to_json(document: dict[str, Any], *, indent: int | None = None) -> str:
    """The document as text; raises `ValueError` rather than write NaN."""
    separators = (",", ":") if indent is None else None
    return json.dumps(document, indent=indent, separators=separators, allow_nan=False, ensure_ascii=False)


def _sensor(sensor: Sensor) -> SensorPart:
    return SensorPart(
        position=None if sensor.position is None else _numbers(sensor.position),
        direction=None if sensor.direction is None else _numbers(sensor.direction),
        known_from=sensor.known_from,
    )


def _plane(plane: SupportPlane) -> SupportPlanePart:
    return SupportPlanePart(
        normal=_numbers(plane.normal), offset_m=_number(plane.offset_m), noise_m=_number(plane.noise_m)
    )


def _object(item: ObjectPlan, plan: Plan) -> ObjectPart:
    trace, rejection = item.trace, item.rejection
    outline, box = trace.silhouette, trace.box
    return ObjectPart(
        id=item.object.id,
        points=len(item.object.points),
        status="ok" if item.grasps else "no_grasp",
        reason=rejection.reason if rejection else None,
        remedy=remedy_of(plan, item),
        nearest_miss=rejection
        and MissPart(stage=rejection.stage, value=_number(rejection.value), limit=_number(rejection.limit)),
        obb=box and _box(box),
        aabb=box and AabbPart(min=_numbers(box.aabb[0]), max=_numbers(box.aabb[1])),
        silhouette=outline and _silhouette(outline, trace.level_m),
        gravity_center=_gravity(outline, plan.settings.gravity.center)
        if outline is not None and outline.loops
        else None,
        fingers=FingersPart(
            step_m=_number(trace.steps[0].step_m) if trace.steps else None, doubted_directions=trace.doubted_directions
        ),
        funnel=[StagePart(stage=stage.stage, kept=stage.kept) for stage in item.funnel],
        grasps=[_grasp(grasp, item, plan) for grasp in item.grasps],
        refused=[_grasp(grasp, item, plan) for grasp in item.refused],
    )


def _box(box: OrientedBox) -> BoxPart:
    return BoxPart(center=_numbers(box.frame.origin), axes=_numbers(box.frame.axes), size_m=_numbers(box.size))


def _silhouette(outline: Silhouette, level_m: float | None) -> SilhouettePart:
    return SilhouettePart(
        origin=_numbers(outline.frame.origin),
        axes=_numbers(outline.frame.axes[:2]),
        loops=[_numbers(loop) for loop in outline.loops],
        level_m=_number(level_m),
        alpha_m=_number(outline.alpha_m),
        coverage=_number(outline.coverage),
    )


def _gravity(outline: Silhouette, used: Literal["area", "points"]) -> GravityPart:
    area, points = (gravity_center(outline, method) for method in ("area", "points"))
    return GravityPart(
        area=_numbers(outline.frame.to_world(area)),
        points=_numbers(outline.frame.to_world(points)),
        distance_m=_number(float(np.linalg.norm(area - points))),
        used=used,
    )


def _grasp(grasp: Grasp, item: ObjectPlan, plan: Plan) -> GraspPart:
    approach = axes_from_quaternion(grasp.orientation)[2]
    support, depth, gripper = item.object.support, plan.settings.depth, plan.gripper
    up = -approach if support is None else support.normal

    def pose(position: FloatArray) -> PosePart:
        return PosePart(position=_numbers(position), orientation=_numbers(grasp.orientation))

    return GraspPart(
        rank=grasp.rank,
        pose=pose(grasp.position),
        pre_grasp=pose(grasp.position - depth.approach_m * approach),
        lift=pose(grasp.position + depth.lift_m * up),
        tip_shift_m=_number(gripper.finger_length_at_m(grasp.width_m) - gripper.finger_length_at_m(grasp.opening_m)),
        opening_m=_number(grasp.opening_m),
        width_m=_number(grasp.width_m),
        contacts=_numbers(grasp.contacts),
        fingers=grasp.fingers,
        metrics=MetricsPart(**{name: _number(getattr(grasp, name)) for name in MetricsPart.model_fields}),
        force_closure=grasp.closure and ClosurePart(**asdict(grasp.closure)),
        cage=grasp.cage and CagePart(**asdict(grasp.cage)),
        reach=grasp.reach and _reach(grasp.reach),
    )


def _reach(reach: Reach) -> ReachPart:
    joints = None if reach.joints_rad is None else _numbers(reach.joints_rad)
    return ReachPart(
        ok=reach.ok,
        joints_rad=joints and JointsPart(pre_grasp=joints[0], grasp=joints[1], lift=joints[2]),
        manipulability=_number(reach.manipulability),
        manipulability_share=_number(reach.manipulability_share),
        twin=reach.twin,
        waypoint=reach.waypoint,
        limit=reach.limit,
    )


def _number(value: float | None) -> Any:
    """A rounded number, or None for what JSON cannot hold."""
    return None if value is None or not math.isfinite(value) else round(value, DECIMALS) + 0.0  # no −0.0


def _numbers(values: Any) -> Any:
    """A nested list of rounded numbers."""
    return (np.round(values, DECIMALS) + 0.0).tolist()
