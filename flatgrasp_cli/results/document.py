"""The JSON contract `flatgrasp.plan/1`: a Plan as a document, and its JSON Schema.

Numbers are finite or null. Adding a key is fine; renaming one or changing its meaning makes a new schema id.
"""

from __future__ import annotations

import json
import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from flatgrasp_cli.model import Grasp, ObjectPlan, OrientedBox, Silhouette
from flatgrasp_cli.planner.gravity import gravity_center
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot

SCHEMA_ID: Literal["flatgrasp.plan/1"] = "flatgrasp.plan/1"
DECIMALS = 9
"""A nanometre, and well below what a double holds of a scene's coordinates."""

Number = Annotated[float, Field(allow_inf_nan=False)]
Vector2 = tuple[Number, Number]
Vector3 = tuple[Number, Number, Number]
Vector4 = tuple[Number, Number, Number, Number]
Status = Literal["ok", "no_grasp"]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class SourcePart(_Part):
    """The frame that was planned on; `points` are the finite ones, `dropped` the NaN and infinite ones."""

    path: str
    topic: str | None
    stamp_ns: int | None
    frame_id: str
    points: int
    dropped: int
    index: int


class SupportPlanePart(_Part):
    """The plane that objects stand on: normal · p = offset_m."""

    normal: Vector3
    offset_m: Number


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
    """Loops of [u, v] in metres in the plane through `origin` along `axes`; the outer loop first, counter-clockwise."""

    origin: Vector3
    axes: tuple[Vector3, Vector3]
    loops: list[list[Vector2]]
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
    """What the method measured of a grasp. `required_friction` is null when no friction would hold it."""

    force_balance_deg: Number
    torque_arm_m: Number
    required_friction: Number | None
    variance_m: Number
    gravity_distance_m: Number
    inside_share: Number
    arc_ratio: Number
    cost_m: Number


class GraspPart(_Part):
    """One grasp; `contacts` and `fingers` are the −y side's and the +y side's."""

    rank: int
    pose: PosePart
    opening_m: Number
    width_m: Number
    contacts: tuple[Vector3, Vector3]
    fingers: tuple[int, int]
    metrics: MetricsPart
    cage: None
    reach: None


class ObjectPart(_Part):
    """One object: what was found of it, and its grasps, best first."""

    id: int
    points: int
    status: Status
    reason: str | None
    nearest_miss: MissPart | None
    obb: BoxPart | None
    aabb: AabbPart | None
    silhouette: SilhouettePart | None
    gravity_center: GravityPart | None
    fingers: FingersPart
    funnel: list[StagePart]
    grasps: list[GraspPart]


class TimingPart(_Part):
    """Milliseconds of wall time; `total` from opening the source to the finished document."""

    read: Number
    scene: Number
    plan: Number
    total: Number


class Document(_Part):
    """The answer for one frame."""

    id: Literal["flatgrasp.plan/1"] = Field(alias="schema")
    status: Status
    reason: str | None
    source: SourcePart
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


def to_document(plan: Plan, read_ms: float = 0.0, total_ms: float | None = None) -> dict[str, Any]:
    """A plan as the JSON-ready document of schema `flatgrasp.plan/1`.

    Parameters
    ----------
    plan
        From `flatgrasp_cli.plan`.
    read_ms, total_ms
        Times that the caller measured; the total is reading and planning when not given.
    """
    cloud, source = plan.cloud, plan.cloud.source
    document = Document(
        schema=SCHEMA_ID,
        status="ok" if plan.best is not None else "no_grasp",
        reason=plan.reason,
        source=SourcePart(
            path=source.path,
            topic=source.topic,
            stamp_ns=source.stamp_ns,
            frame_id=cloud.frame_id,
            points=len(cloud.points),
            dropped=cloud.dropped,
            index=source.index,
        ),
        frame_id=cloud.frame_id,
        gripper=plan.gripper,
        robot=None,
        settings=plan.settings,
        support_plane=None,
        objects=[_object(item, plan.settings.gravity.center) for item in plan.objects],
        timing_ms=TimingPart(
            read=round(read_ms, 3),
            scene=0.0,
            plan=round(plan.plan_ms, 3),
            total=round(read_ms + plan.plan_ms if total_ms is None else total_ms, 3),
        ),
    )
    return document.model_dump(mode="json", by_alias=True)


def to_json(document: dict[str, Any], *, indent: int | None = None) -> str:
    """The document as text; raises `ValueError` rather than write NaN."""
    separators = (",", ":") if indent is None else None
    return json.dumps(document, indent=indent, separators=separators, allow_nan=False, ensure_ascii=False)


def _object(item: ObjectPlan, used: Literal["area", "points"]) -> ObjectPart:
    trace, rejection = item.trace, item.rejection
    outline, box = trace.silhouette, trace.box
    return ObjectPart(
        id=item.object.id,
        points=len(item.object.points),
        status="ok" if item.grasps else "no_grasp",
        reason=rejection.reason if rejection else None,
        nearest_miss=rejection
        and MissPart(stage=rejection.stage, value=_number(rejection.value), limit=_number(rejection.limit)),
        obb=box and _box(box),
        aabb=box and AabbPart(min=_numbers(box.aabb[0]), max=_numbers(box.aabb[1])),
        silhouette=outline and _silhouette(outline),
        gravity_center=_gravity(outline, used) if outline is not None and outline.loops else None,
        fingers=FingersPart(
            step_m=_number(trace.steps[0].step_m) if trace.steps else None, doubted_directions=trace.doubted_directions
        ),
        funnel=[StagePart(stage=stage.stage, kept=stage.kept) for stage in item.funnel],
        grasps=[_grasp(grasp) for grasp in item.grasps],
    )


def _box(box: OrientedBox) -> BoxPart:
    return BoxPart(center=_numbers(box.frame.origin), axes=_numbers(box.frame.axes), size_m=_numbers(box.size))


def _silhouette(outline: Silhouette) -> SilhouettePart:
    return SilhouettePart(
        origin=_numbers(outline.frame.origin),
        axes=_numbers(outline.frame.axes[:2]),
        loops=[_numbers(loop) for loop in outline.loops],
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


def _grasp(grasp: Grasp) -> GraspPart:
    return GraspPart(
        rank=grasp.rank,
        pose=PosePart(position=_numbers(grasp.position), orientation=_numbers(grasp.orientation)),
        opening_m=_number(grasp.opening_m),
        width_m=_number(grasp.width_m),
        contacts=_numbers(grasp.contacts),
        fingers=grasp.fingers,
        metrics=MetricsPart(**{name: _number(getattr(grasp, name)) for name in MetricsPart.model_fields}),
        cage=None,
        reach=None,
    )


def _number(value: float | None) -> Any:
    """A rounded number, or None for what JSON cannot hold."""
    return None if value is None or not math.isfinite(value) else round(value, DECIMALS) + 0.0  # no −0.0


def _numbers(values: Any) -> Any:
    """A nested list of rounded numbers."""
    return (np.round(values, DECIMALS) + 0.0).tolist()
