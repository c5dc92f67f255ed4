"""A Plan as the JSON document of contract `flatgrasp.plan/1`.

Numbers are finite or null. Adding a key is fine; renaming one or changing its meaning makes a new schema id.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from flatgrasp_cli.model import (
    Grasp,
    ObjectPlan,
    OrientedBox,
    PlaneShape,
    Pose,
    Poses,
    Reach,
    Rejection,
    Sensor,
    Silhouette,
    SupportPlane,
)
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.contracts.grasps import (
    GraspPart,
    JointsPart,
    MetricsPart,
    PosePart,
    PosesPart,
    ReachPart,
)
from flatgrasp_cli.results.contracts.objects import (
    AabbPart,
    BoxPart,
    FingersPart,
    GravityPart,
    MissPart,
    ObjectPart,
    SilhouettePart,
    StagePart,
)
from flatgrasp_cli.results.contracts.plan import (
    SCHEMA_ID,
    Document,
    SensorPart,
    SourcePart,
    SupportPlanePart,
    TimingPart,
    WarningPart,
)
from flatgrasp_cli.results.numbers import number, numbers, rounded
from flatgrasp_cli.results.remedies import remedy_of

if TYPE_CHECKING:
    from flatgrasp_cli.model.grasps import Cage, Closure
    from flatgrasp_cli.profiles.base import Profile

Thing = TypeVar("Thing")
Made = TypeVar("Made")


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
            frame_id=cloud.frame_name,
            points=len(cloud.points),
            dropped=cloud.dropped,
            index=source.index,
        ),
        sensor=_sensor(cloud.sensor or Sensor("assumed")),
        warnings=[WarningPart(code=warning.code, text=warning.text) for warning in plan.warnings],
        frame_id=cloud.frame_name,
        gripper=_values(plan.gripper),
        robot=_optional(_values, plan.robot),
        settings=_values(plan.settings),
        support_plane=_optional(_plane, plan.scene.support),
        objects=[_object(item, plan) for item in plan.objects],
        timing_ms=TimingPart(
            read=round(read_ms, 3),
            scene=round(plan.scene_ms, 3),
            plan=round(plan.plan_ms, 3),
            total=round(read_ms + plan.scene_ms + plan.plan_ms, 3),
        ),
    )
    return dict(document)


def to_json(document: dict[str, Any], *, indent: int | None = None) -> str:
    """The document as text; raises `ValueError` rather than write NaN."""
    separators = (",", ":") if indent is None else None
    return json.dumps(document, indent=indent, separators=separators, allow_nan=False, ensure_ascii=False)


def _sensor(sensor: Sensor) -> SensorPart:
    return SensorPart(
        position=None if sensor.position is None else numbers(sensor.position),
        direction=None if sensor.direction is None else numbers(sensor.direction),
        known_from=sensor.known_from,
    )


def _plane(plane: SupportPlane) -> SupportPlanePart:
    return SupportPlanePart(
        normal=numbers(plane.normal), offset_m=number(plane.offset_m), noise_m=number(plane.noise_m)
    )


def _object(item: ObjectPlan, plan: Plan) -> ObjectPart:
    trace, rejection = item.trace, item.rejection
    silhouette, box = item.silhouette, item.box
    return ObjectPart(
        id=item.object.id,
        points=len(item.object.points),
        status="ok" if item.grasps else "no_grasp",
        reason=rejection.reason if rejection else None,
        remedy=remedy_of(plan, item),
        nearest_miss=_optional(_miss, rejection),
        obb=_optional(_box, box),
        aabb=_optional(_aabb, box),
        silhouette=None if silhouette is None else _silhouette(silhouette, item.level_m),
        gravity_center=_optional(_gravity, item.shape),
        fingers=FingersPart(
            step_m=number(trace.steps[0].step_m) if trace.steps else None, doubted_directions=trace.doubted_directions
        ),
        funnel=[StagePart(stage=stage.stage, kept=stage.kept) for stage in item.funnel],
        grasps=[grasp_part(grasp, plan) for grasp in item.grasps],
        refused=[grasp_part(grasp, plan) for grasp in item.refused],
    )


def _box(box: OrientedBox) -> BoxPart:
    return BoxPart(center=numbers(box.frame.origin), axes=numbers(box.frame.axes), size_m=numbers(box.size))


def _aabb(box: OrientedBox) -> AabbPart:
    return AabbPart(min=numbers(box.aabb[0]), max=numbers(box.aabb[1]))


def _miss(rejection: Rejection) -> MissPart:
    return MissPart(stage=rejection.stage, value=number(rejection.value), limit=number(rejection.limit))


def _silhouette(silhouette: Silhouette, level_m: float | None) -> SilhouettePart:
    return SilhouettePart(
        origin=numbers(silhouette.frame.origin),
        axes=numbers(silhouette.frame.axes[:2]),
        loops=[numbers(loop) for loop in silhouette.loops],
        level_m=number(level_m),
        alpha_m=number(silhouette.alpha_m),
        coverage=number(silhouette.coverage),
    )


def _gravity(shape: PlaneShape) -> GravityPart:
    plane, center = shape.silhouette.frame, shape.gravity_center
    return GravityPart(
        area=numbers(plane.to_world(center.area)),
        points=numbers(plane.to_world(center.points)),
        distance_m=number(float(np.linalg.norm(center.area - center.points))),
        used=center.used,
    )


def grasp_part(grasp: Grasp, plan: Plan) -> GraspPart:
    """One grasp of a plan."""
    gripper = plan.gripper
    return GraspPart(
        rank=grasp.rank,
        pose=pose_part(Pose(grasp.position, grasp.orientation)),
        pre_grasp=pose_part(grasp.pre_grasp),
        lift=pose_part(grasp.lift),
        flange=_poses(grasp.flange),
        hand=None if grasp.hand is grasp.flange else _poses(grasp.hand),
        tip_shift_m=number(gripper.finger_length_at_m(grasp.width_m) - gripper.finger_length_at_m(grasp.opening_m)),
        opening_m=number(grasp.opening_m),
        width_m=number(grasp.width_m),
        contacts=numbers(grasp.contacts),
        fingers=cast(Any, list(grasp.fingers)),
        metrics=cast(MetricsPart, {name: number(getattr(grasp, name)) for name in MetricsPart.__annotations__}),
        force_closure=_optional(_fields, grasp.closure),
        cage=_optional(_fields, grasp.cage),
        reach=_optional(_reach, grasp.reach),
    )


def _poses(poses: Poses) -> PosesPart:
    return PosesPart(pose=pose_part(poses.pose), pre_grasp=pose_part(poses.pre_grasp), lift=pose_part(poses.lift))


def pose_part(pose: Pose) -> PosePart:
    """A pose."""
    return PosePart(position=numbers(pose.position), orientation=numbers(pose.orientation))


def _reach(reach: Reach) -> ReachPart:
    joints = None if reach.joints_rad is None else numbers(reach.joints_rad)
    return ReachPart(
        ok=reach.ok,
        joints_rad=joints and JointsPart(pre_grasp=joints[0], grasp=joints[1], lift=joints[2]),
        manipulability=number(reach.manipulability),
        manipulability_share=number(reach.manipulability_share),
        twin=reach.twin,
        waypoint=reach.waypoint,
        limit=reach.limit,
    )


def _optional(part: Callable[[Thing], Made], thing: Thing | None) -> Made | None:
    """The part that is made of a thing; None without one."""
    return None if thing is None else part(thing)


def _fields(record: Cage | Closure) -> Any:
    """What a record of numbers holds, by name."""
    return rounded(asdict(record))


def _values(profile: Profile) -> Any:
    """All values of a profile, by key."""
    return profile.model_dump(mode="json")
