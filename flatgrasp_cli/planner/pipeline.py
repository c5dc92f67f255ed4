"""§III of the paper, paragraph by paragraph: one object's points → its grasps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import quaternion_from_axes
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.model import (
    FingerCandidates,
    Grasp,
    GraspCandidates,
    ObjectCloud,
    ObjectPlan,
    OrientedBox,
    Rejection,
    Silhouette,
    Trace,
)
from flatgrasp_cli.planner.balance import force_balance, force_balanced, torque_balanced
from flatgrasp_cli.planner.fingers import finger_candidates, inward_directions, step_points
from flatgrasp_cli.planner.funnel import Funnel, NothingLeft
from flatgrasp_cli.planner.gravity import RankingCost, best_first, ranking_cost
from flatgrasp_cli.planner.hand import Fit, centers, closing_axes, flat, in_range, on_pads, openings, operable
from flatgrasp_cli.planner.main_plane import oriented_box
from flatgrasp_cli.planner.silhouette import silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings


def plan_object(cloud: ObjectCloud, gripper: Gripper, settings: PlannerSettings, top: int = 10) -> ObjectPlan:
    """Plan the best `top` grasps of one object, with `settings` as `PlannerSettings.resolve` returns them."""
    funnel, trace = Funnel(), Trace()
    grasps: tuple[Grasp, ...] = ()
    rejection: Rejection | None = None
    try:
        grasps = _section_three(cloud, gripper, settings, (funnel, trace), top)
    except NothingLeft as end:
        rejection = end.rejection
    trace.survivors = funnel.survivors
    return ObjectPlan(cloud, tuple(funnel.stages), grasps, rejection, trace)


def _section_three(
    cloud: ObjectCloud, gripper: Gripper, settings: PlannerSettings, notes: tuple[Funnel, Trace], top: int
) -> tuple[Grasp, ...]:
    """The method in the paper's order; what it finds on the way goes into the funnel and the trace."""
    funnel, trace = notes
    # A.1 the oriented bounding box and its main plane; A.2 the silhouette
    box = trace.box = oriented_box(cloud.points, cloud.viewpoint, settings.main_plane.method)
    if box is None:
        raise funnel.nothing("main_plane", _no_plane(cloud.points))
    outline = trace.silhouette = silhouette(cloud.points, box, settings.silhouette)
    funnel.count("silhouette", len(outline.loops), "the points are too scattered for an outline")

    # A.3 step points, finger candidates, grasping directions
    steps = trace.steps = step_points(outline, settings.fingers)
    funnel.count("step_points", sum(len(step.points) for step in steps), "the outline has no step point")
    chords = finger_candidates(outline, steps, gripper, settings.fingers)
    funnel.count("finger_candidates", len(chords), _no_finger_place(box, gripper))
    fingers, trace.doubted_directions = inward_directions(outline, chords, settings.fingers, settings.seed)
    trace.fingers = fingers
    funnel.count("grasping_direction", len(fingers), "no finger candidate has the object before it")

    # B.1 force balance of all pairs; B.2 torque balance
    gamma_deg = trace.force_balance_deg = force_balance(fingers)
    pairs = force_balanced(fingers, gamma_deg, settings.balance, funnel)
    pairs = torque_balanced(pairs, settings.balance, funnel)

    # B.3 grasping range; B.4 variance; B.5 operability
    pairs = closing_axes(fingers, pairs, settings.hand.closing_axis)
    pairs = on_pads(fingers, pairs, gripper, funnel)
    pairs = in_range(fingers, pairs, gripper, settings.hand, funnel)
    pairs = flat(fingers, pairs, settings.hand, funnel)
    pairs, fit = operable(outline, fingers, pairs, (gripper, settings.hand), funnel)

    # C gravity, and the final grasp
    ranking = ranking_cost(fingers, pairs, outline, fit.width, settings.gravity)
    order = best_first(pairs, ranking.cost)
    trace.gravity_center, trace.gravity_distance_m = ranking.center, ranking.distance[order]
    trace.ranked = np.column_stack([pairs.i, pairs.j])[order]
    best = order[:top]
    hands = _Hands(pairs.select(best), fit.select(best), ranking.select(best))
    return tuple(_grasp(k, outline, fingers, hands, (gripper, settings)) for k in range(len(best)))


@dataclass(frozen=True, slots=True, eq=False)
class _Hands:
    """The final grasps, best first, as the stages left them."""

    pairs: GraspCandidates
    fit: Fit
    ranking: RankingCost


def _grasp(
    k: int,
    outline: Silhouette,
    fingers: FingerCandidates,
    hands: _Hands,
    profile: tuple[Gripper, PlannerSettings],
) -> Grasp:
    """The record of the k-th best pair, its fingertip frame at the box's mid-height, facing away from the sensor.

    Hand y is the closing axis and hand z = −normal, so hand x = y × z = normal × y: y turned left in the plane.
    """
    only = np.array([k])
    pairs, fit, ranking = hands.pairs.select(only), hands.fit.select(only), hands.ranking.select(only)
    frame, i, j = outline.frame, int(pairs.i[0]), int(pairs.j[0])
    hand_axes = [left_normal(pairs.axis) @ frame.axes[:2], pairs.axis @ frame.axes[:2], -frame.axes[2:]]
    gripper, settings = profile
    return Grasp(
        rank=k + 1,
        position=frame.to_world(centers(fingers, pairs, fit)[0]),
        orientation=quaternion_from_axes(np.concatenate(hand_axes)),
        opening_m=openings(fit, gripper, settings.hand).item(),
        width_m=fit.width.item(),
        contacts=frame.to_world(fingers.contact[[i, j]]),
        fingers=(i, j),
        force_balance_deg=pairs.force_balance_deg.item(),
        torque_arm_m=pairs.torque_arm_m.item(),
        required_friction=pairs.required_friction.item(),
        variance_m=float(fingers.variance[i] + fingers.variance[j]),
        gravity_distance_m=ranking.distance.item(),
        inside_share=ranking.inside_share.item(),
        arc_ratio=float(fingers.arc_ratio[[i, j]].max()),
        cost_m=ranking.cost.item(),
    )


def _no_plane(points: FloatArray) -> str:
    if len(points) == 0:
        return "the cloud has no finite point"
    distinct = len(np.unique(points, axis=0))
    if distinct < 3:
        return f"the cloud has {distinct} distinct point{'s' if distinct > 1 else ''}, an outline needs three"
    return f"all {len(points)} points lie on a line"


def _no_finger_place(box: OrientedBox, gripper: Gripper) -> str:
    return (
        f"the outline is {box.size[0]:.3f} m × {box.size[1]:.3f} m, "
        f"too small for a finger of {gripper.finger_width_m:.3f} m"
    )
