"""Grasps in the plane → grasps in space, ranked, with the way in which hand and arm carry them out."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion, quaternion_from_axes
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.model import (
    Approach,
    Grasp,
    GraspCandidates,
    ObjectCloud,
    ObjectPlan,
    Pose,
    Reach,
    Rejection,
    Stage,
    Success,
    SupportPlane,
)
from flatgrasp_cli.planner.silhouette import without_strays
from flatgrasp_cli.planning.answers import Answer, assessed, finished, proved
from flatgrasp_cli.planning.objects import answer_for
from flatgrasp_cli.planning.search import Search
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot
from flatgrasp_cli.proof import Certificates
from flatgrasp_cli.ranking import CAUSES, by_probability, differing
from flatgrasp_cli.robot import Motion, Plane, flange_at, is_too_far, reach, way_to
from flatgrasp_cli.surroundings import tilt_deg

SAME_WAY = 1e-5
"""Unit vectors that differ by less are the same: rounding makes them differ by less still."""
LISTED = 10
"""How many grasps of an object are listed as a rule. What is found out of grasps last decides the order among so many
at a time: then the first are the same, however many are asked for."""
REACH_CANDIDATES = 500
"""The best grasps of an object that a robot is asked about: a third of a second."""


def plan_object(
    cloud: ObjectCloud,
    gripper: Gripper,
    settings: PlannerSettings,
    top: int = LISTED,
    robot: Robot | None = None,
    *,
    between: bool = False,
) -> ObjectPlan:
    """The best `top` grasps of one object that differ, with `settings` as `PlannerSettings.resolve` returns them.

    Of those that a `robot` cannot carry out, the best `top` that differ are listed as refused. Aslant, hands come from
    the sides `between` those that are tried first if that is wanted.
    """
    if cloud.support is None:
        cloud = replace(cloud, points=without_strays(cloud.points, settings.silhouette))
    answer = answer_for(cloud, replace(_search(cloud, gripper, settings, robot), between=between))
    item = ObjectPlan(
        object=cloud,
        funnel=answer.funnel,
        grasps=(),
        rejection=answer.rejection,
        box=answer.box,
        shape=answer.shape,
        level_m=answer.level_m,
        trace=answer.trace,
        why_not_top=answer.why_not_top,
    )
    if answer.grasps is None or answer.shape is None:
        return item
    plane = answer.shape.silhouette.frame
    rows, reaches = range(len(answer.grasps)), answer.reaches
    if robot is not None and reaches is not None:
        rows = rows[: len(reaches)]
        item = _with_reach(item, robot, reaches)
    served = [k for k in rows if reaches[k].ok] if reaches else rows
    listed = differing(answer.grasps, served, settings.variety, LISTED * math.ceil(top / LISTED))
    refused = differing(answer.grasps, [k for k in rows if not reaches[k].ok] if reaches else [], settings.variety, top)
    chosen = [*listed, *refused]
    final = proved(finished(answer.of(chosen), gripper, settings), gripper, settings)
    final = assessed(final, gripper, settings)
    found = _lifted(final, plane, gripper, _motion(cloud, plane, gripper, settings), cloud.support)
    order = [*_order(final, len(listed), settings), *range(len(listed), len(chosen))]
    ranks = [*range(1, len(listed) + 1), *(k + 1 for k in refused)]
    grasps = [
        found.record(n, rank=rank, reached=reaches[chosen[n]] if reaches else None)
        for n, rank in zip(order, ranks, strict=True)
    ]
    return replace(item, grasps=tuple(grasps[: len(listed)][:top]), refused=tuple(grasps[len(listed) :]))


def _search(cloud: ObjectCloud, gripper: Gripper, settings: PlannerSettings, robot: Robot | None) -> Search:
    """What looks for grasps, those first that a robot reaches, if there is one."""
    if robot is None:
        return Search(gripper, settings)
    tools = (gripper.tool_length_m(0.0), gripper.tool_length_m(gripper.max_opening_m))

    def reaches(answer: Answer) -> tuple[Reach, ...]:
        assert answer.grasps is not None and answer.shape is not None  # noqa: S101, PT018 (asked only where there are)
        plane, first = answer.shape.silhouette.frame, answer.grasps.first(REACH_CANDIDATES)
        motion = _motion(cloud, plane, gripper, settings)
        return _reaches(first, plane, gripper, motion, robot, cloud.support)

    def is_too_far_from(toward: FloatArray) -> bool:
        tips = _between_table_and_top(cloud)
        grasp = np.concatenate([tips + tool * toward for tool in tools])
        return is_too_far(robot, grasp) or is_too_far(robot, grasp + settings.depth.approach_m * toward)

    return Search(gripper, settings, reaches, is_too_far_from)


def _between_table_and_top(cloud: ObjectCloud) -> FloatArray:
    """Places (n, 3) around all those where fingertips hold an object: its points, and their feet on its support."""
    if cloud.support is None:
        return cloud.points
    feet = cloud.points - cloud.support.heights(cloud.points)[:, None] * cloud.support.normal
    return np.concatenate([cloud.points, feet])


def _order(final: Answer, count: int, settings: PlannerSettings) -> list[int]:
    """The order of the first `count` grasps of an answer: as they are, unless what most probably holds comes first."""
    grasps = final.grasps
    if grasps is None or len(grasps.probability) == 0 or settings.ranking.prefer != "success":
        return list(range(count))
    order: list[int] = []
    for begin in range(0, count, LISTED):
        some = slice(begin, min(begin + LISTED, count))
        order += (begin + by_probability(grasps.probability[some], grasps.gravity_distance[some])).tolist()
    return order


def _success(grasps: GraspCandidates, k: int) -> Success | None:
    """What was found out about row `k`; None for a method that knows no hand."""
    if len(grasps.probability) == 0:
        return None
    clear, closes, lifts = grasps.success[k].tolist()
    causes = dict(zip(CAUSES, grasps.causes[k].tolist(), strict=True))
    return Success(probability=float(grasps.probability[k]), clear=clear, closes=closes, lifts=lifts, causes=causes)


@dataclass(frozen=True, slots=True, eq=False)
class _Lifted:
    """A grasp table in space: the fingertips' poses, the contacts (k, 2, 3), and how the hand moves."""

    grasps: GraspCandidates
    certificates: Certificates | None
    tips: tuple[Pose, ...]
    contacts: FloatArray
    gripper: Gripper
    motion: Motion
    approach: Approach

    def record(self, k: int, *, rank: int, reached: Reach | None = None) -> Grasp:
        """The grasp in row `k`."""
        grasps, proved = self.grasps, self.certificates
        over_support = len(grasps.grip) > 0 and np.isfinite(grasps.grip[k])
        width, twin = float(grasps.width[k]), reached is not None and reached.twin
        return Grasp(
            rank=rank,
            position=self.tips[k].position,
            orientation=self.tips[k].orientation,
            opening_m=float(grasps.opening[k]),
            width_m=width,
            contacts=self.contacts[k],
            fingers=(int(grasps.i[k]), int(grasps.j[k])),
            force_balance_deg=float(grasps.force_balance_deg[k]),
            torque_arm_m=float(grasps.torque_arm_m[k]),
            required_friction=float(grasps.required_friction[k]),
            variance_m=float(grasps.variance[k]),
            gravity_distance_m=float(grasps.gravity_distance[k]),
            inside_share=float(grasps.inside_share[k]),
            arc_ratio=float(grasps.arc_ratio[k]),
            approach=self.approach,
            way=way_to(self.tips[k], width, self.gripper, self.motion, twin=twin),
            tip_height_m=float(grasps.tip[k]) if over_support else None,
            grip_m=float(grasps.grip[k]) if over_support else None,
            unseen_m=float(grasps.unseen[k]) if over_support else None,
            hidden_m=float(grasps.hidden[k].sum()) if len(grasps.hidden) else 0.0,
            success=_success(grasps, k),
            cage=None if proved is None else proved.cages[k],
            closure=None if proved is None else proved.closures[k],
            reach=reached,
        )


def _lifted(answer: Answer, plane: Frame, gripper: Gripper, motion: Motion, support: SupportPlane | None) -> _Lifted:
    """The grasps of an answer, which lie in the x-y plane of a frame, in space."""
    grasps = answer.grasps
    assert grasps is not None  # noqa: S101 (an object without grasps is not lifted)
    heights = np.repeat(grasps.touch[:, None, None], 2, axis=1)
    return _Lifted(
        grasps=grasps,
        certificates=answer.certificates,
        tips=_fingertips(grasps, plane),
        contacts=plane.to_world(np.concatenate([grasps.contacts, heights], axis=2)),
        gripper=gripper,
        motion=motion,
        approach=Approach(
            direction=-plane.axes[2],
            tilt_deg=0.0 if support is None else tilt_deg(plane.axes[2], support.normal),
            known_from=answer.direction.known_from if answer.direction else "top" if support else "main_plane",
        ),
    )


def _fingertips(grasps: GraspCandidates, plane: Frame) -> tuple[Pose, ...]:
    """The fingertips' poses of grasps in the x-y plane of a frame.

    Hand y is the closing axis and hand z = −normal, so hand x = y × z = normal × y: y turned left in the plane.
    """
    position = plane.to_world(np.column_stack([grasps.center, grasps.tip]))
    axes = np.empty((len(grasps), 3, 3))
    axes[:, 0], axes[:, 1] = left_normal(grasps.axis) @ plane.axes[:2], grasps.axis @ plane.axes[:2]
    axes[:, 2] = -plane.axes[2]
    return tuple(Pose(where, quaternion_from_axes(turn)) for where, turn in zip(position, axes, strict=True))


def _motion(cloud: ObjectCloud, plane: Frame, gripper: Gripper, settings: PlannerSettings) -> Motion:
    """How the hand comes to an object, and goes: up from the support plane, or back from an object alone.

    One that came aslant goes back first: only of that way is it known that nothing is in it.
    """
    away = plane.axes[2] if cloud.support is None else cloud.support.normal
    aslant = float(np.abs(plane.axes[2] - away).max()) > SAME_WAY
    return Motion(settings.depth.approach_m, settings.depth.lift_m, away, gripper.symmetric, back_first=aslant)


def _reaches(
    grasps: GraspCandidates,
    plane: Frame,
    gripper: Gripper,
    motion: Motion,
    robot: Robot,
    support: SupportPlane | None,
) -> tuple[Reach, ...]:
    """Whether the robot can carry out each of the grasps in the x-y plane of a frame."""
    width = grasps.width
    flanges = [flange_at(tips, float(width[k]), gripper) for k, tips in enumerate(_fingertips(grasps, plane))]
    positions = np.array([flange.position for flange in flanges])
    axes = np.array([axes_from_quaternion(flange.orientation) for flange in flanges])
    table = None if support is None else Plane(support.normal, support.offset_m)
    return reach(robot, positions, axes, motion, table)


def _with_reach(item: ObjectPlan, robot: Robot, reaches: tuple[Reach, ...]) -> ObjectPlan:
    """The plan with how many of the grasps the robot can carry out, and why none if none."""
    kept = sum(answer.ok for answer in reaches)
    funnel = (*item.funnel, Stage("reach", kept))
    return replace(item, funnel=funnel, rejection=None if kept else _why_not(robot, reaches))


def _why_not(robot: Robot, answers: tuple[Reach, ...]) -> Rejection:
    """The commonest way in which the robot fails; the limit that it fails by is the cause."""
    ways = [(str(answer.limit), str(answer.waypoint)) for answer in answers]
    limit, waypoint = commonest = max(set(ways), key=lambda way: (ways.count(way), way))
    way = f"{limit} at the {waypoint.replace('_', '-')} in {ways.count(commonest)}"
    return Rejection("reach", f"{robot.name} reaches none of the {len(answers)} best grasps: {way}", cause=limit)
