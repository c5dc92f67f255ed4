"""A Plan as the JSON document of contract `flatgrasp.plan/1`.

Numbers are finite or null. Adding a key is fine; renaming one or changing its meaning makes a new schema id.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from flatgrasp_cli.model import (
    ObjectPlan,
    OrientedBox,
    PlaneShape,
    Rejection,
    Sensor,
    Silhouette,
    SupportPlane,
)
from flatgrasp_cli.planning import Plan
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
    ContainerPart,
    Document,
    SensorPart,
    SourcePart,
    SupportPlanePart,
    TimingPart,
    WarningPart,
)
from flatgrasp_cli.results.grasps import grasp_part, optional
from flatgrasp_cli.results.numbers import number, numbers
from flatgrasp_cli.results.remedies import remedy_of

if TYPE_CHECKING:
    from flatgrasp_cli.profiles.base import Profile


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
        robot=optional(_values, plan.robot),
        settings=_values(plan.settings),
        support_plane=optional(_plane, plan.scene.support),
        container=_container(plan),
        objects=[_object(item, plan) for item in plan.objects],
        timing_ms=_timing(read_ms, plan.scene_ms, plan.plan_ms),
    )
    return dict(document)


def to_json(document: dict[str, Any], *, indent: int | None = None) -> str:
    """The document as text; raises `ValueError` rather than write NaN."""
    separators = (",", ":") if indent is None else None
    return json.dumps(document, indent=indent, separators=separators, allow_nan=False, ensure_ascii=False)


def _timing(read_ms: float, scene_ms: float, plan_ms: float) -> TimingPart:
    read, scene, plan, total = (round(ms, 3) for ms in (read_ms, scene_ms, plan_ms, read_ms + scene_ms + plan_ms))
    return TimingPart(read=read, scene=scene, plan=plan, total=total)


def _container(plan: Plan) -> ContainerPart | None:
    points, plane = plan.scene.container, plan.scene.support
    highest = plane.heights(points).max(initial=-1.0) if plane else -1.0
    return ContainerPart(points=len(points), height_m=float(highest)) if len(points) else None


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
        cut_off=item.object.cut_off,
        at_edge=item.object.at_edge,
        touches_others=item.object.group is not None,
        supports=list(item.object.supports),
        status="ok" if item.grasps else "no_grasp",
        reason=rejection.reason if rejection else None,
        remedy=remedy_of(plan, item),
        why_not_top=item.why_not_top,
        nearest_miss=optional(_miss, rejection),
        obb=optional(_box, box),
        aabb=optional(_aabb, box),
        silhouette=None if silhouette is None else _silhouette(silhouette, item.level_m),
        gravity_center=optional(_gravity, item.shape),
        fingers=FingersPart(
            step_m=number(trace.steps[0].step_m) if trace.steps else None, doubted_directions=trace.doubted_directions
        ),
        funnel=[StagePart(stage=stage.stage, kept=stage.kept) for stage in item.funnel],
        grasps=[grasp_part(grasp, plan.gripper) for grasp in item.grasps],
        refused=[grasp_part(grasp, plan.gripper) for grasp in item.refused],
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


def _values(profile: Profile) -> Any:
    """All values of a profile, by key."""
    return profile.model_dump(mode="json")
