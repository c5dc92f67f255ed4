"""§III of the paper, paragraph by paragraph: one object's points → its grasps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import quaternion_from_axes
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.model import (
    FingerCandidates,
    Grasp,
    GraspCandidates,
    GravityCenter,
    ObjectCloud,
    ObjectPlan,
    OrientedBox,
    Rejection,
    Silhouette,
    Stage,
    Trace,
)
from flatgrasp_cli.planner.allen import point_finger_grasps
from flatgrasp_cli.planner.balance import force_balance, force_balanced, torque_balanced
from flatgrasp_cli.planner.certification import certified, surest_first
from flatgrasp_cli.planner.contacts import pad_contacts
from flatgrasp_cli.planner.depth import Landing, at_mid_height, land, upright
from flatgrasp_cli.planner.fingers import finger_candidates, inward_directions, step_points
from flatgrasp_cli.planner.funnel import Funnel, NothingLeft
from flatgrasp_cli.planner.gravity import RankingCost, best_first, gravity_center, landing_cost, ranking_cost
from flatgrasp_cli.planner.hand import Fit, centers, clear_of_palm, closing_axes, flat, in_range, on_pads, operable
from flatgrasp_cli.planner.main_plane import oriented_box
from flatgrasp_cli.planner.parts import Part, hanging_m, sliced, standing
from flatgrasp_cli.planner.shadow import of_known_thickness, seen_sides
from flatgrasp_cli.planner.silhouette import silhouette, without_strays
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings


def plan_object(cloud: ObjectCloud, gripper: Gripper, settings: PlannerSettings, top: int = 10) -> ObjectPlan:
    """Plan the best `top` grasps of one object, with `settings` as `PlannerSettings.resolve` returns them.

    An object alone is planned as in the paper. Over a support plane the method runs on each of the object's slices, and
    the grasps are those of the slice with the best one; a standing object that cannot be grasped from above is planned
    in the main plane of its own bounding box.
    """
    if cloud.support is None:
        cloud = replace(cloud, points=without_strays(cloud.points, settings.silhouette))
    box = oriented_box(cloud.points, cloud.toward, settings.main_plane.method, cloud.support)
    if box is None:
        return _nothing(cloud, "main_plane", _no_plane(cloud.points, settings.scene.crop is not None))
    parts = (
        [Part(box, box.frame, cloud.points)] if cloud.support is None else sliced(cloud, box, cloud.support, settings)
    )
    if hanging := hanging_m(parts[0]):
        reason = f"it hangs {1e3 * hanging:.0f} mm up in the air: only free space was seen below it"
        return _nothing(cloud, "support", reason)
    whole_outline = _silhouette(parts[0], settings)
    center = gravity_center(whole_outline, settings.gravity)
    cages_decide = settings.caging.require or settings.caging.prefer == "cage"

    def planned(part: Part, outline: Silhouette | None = None, center: GravityCenter = center) -> ObjectPlan:
        outline = outline or _silhouette(part, settings)
        considered = settings.caging.considered if cages_decide else top
        plan = _plan_part(cloud, part, (outline, center), gripper, settings, considered)
        return certified(plan, gripper, settings, top) if cages_decide else plan

    best_first = partial(_best_first, by_cage=settings.caging.prefer == "cage")
    if cages_decide or settings.method == "allen":  # whose costs are no lengths that add up
        best = min(map(planned, parts), key=best_first)
    else:
        best = _cheapest(parts, planned, settings)
    side = standing(cloud, box, settings) if cloud.support is not None and not best.grasps else None
    if side is not None:
        whole_side = _silhouette(side, settings)
        best = min(best, planned(side, whole_side, gravity_center(whole_side, settings.gravity)), key=best_first)
    return best if cages_decide else certified(best, gripper, settings, top)


def _nothing(cloud: ObjectCloud, stage: str, reason: str) -> ObjectPlan:
    """The plan of what cannot be planned at all."""
    return ObjectPlan(cloud, (Stage(stage, 0),), (), Rejection(stage, reason), Trace())


def _cheapest(parts: list[Part], planned: Callable[[Part], ObjectPlan], settings: PlannerSettings) -> ObjectPlan:
    """The plan of the part with the cheapest grasp.

    No term of the cost is negative and one grows with the fingertips' height, so a part that stands high need not be
    planned once a lower one has a grasp that costs less than its height alone.
    """
    whole, *others = parts
    best = planned(whole)
    for part in others:
        height_m = part.terrain.level_m - settings.depth.slice_step_m if part.terrain else 0.0
        least = best.grasps[0].cost_m if best.grasps else np.inf
        if settings.gravity.level_weight * height_m <= least:
            best = min(best, planned(part), key=_best_first)
    return best


def _best_first(plan: ObjectPlan, by_cage: bool = False) -> tuple[bool, float, float, int]:
    """Order of plans: by the best grasp's cost or cage; last those without, the one first that came furthest."""
    if not plan.grasps:
        return (True, np.inf, np.inf, -len(plan.funnel))
    return (*surest_first(plan.grasps[0]), 0) if by_cage else (False, 0.0, plan.grasps[0].cost_m, 0)


def _plan_part(
    cloud: ObjectCloud,
    part: Part,
    shape: tuple[Silhouette, GravityCenter],
    gripper: Gripper,
    settings: PlannerSettings,
    top: int,
) -> ObjectPlan:
    funnel, trace = Funnel(), Trace(box=part.box, level_m=part.terrain.level_m if part.terrain else None)
    grasps: tuple[Grasp, ...] = ()
    rejection: Rejection | None = None
    try:
        grasps = _section_three(part, shape, (gripper, settings), (funnel, trace), top)
    except NothingLeft as end:
        rejection = end.rejection
    trace.survivors = funnel.survivors
    return ObjectPlan(cloud, tuple(funnel.stages), grasps, rejection, trace)


def _silhouette(part: Part, settings: PlannerSettings) -> Silhouette:
    """A.2, after A.1, which is the part's box and its main plane."""
    return silhouette(part.points, part.frame, settings.silhouette, part.spacing_m)


def _section_three(
    part: Part,
    shape: tuple[Silhouette, GravityCenter],
    hand: tuple[Gripper, PlannerSettings],
    notes: tuple[Funnel, Trace],
    top: int,
) -> tuple[Grasp, ...]:
    """The method in the paper's order; what it finds on the way goes into the funnel and the trace."""
    (outline, center), (gripper, settings), (funnel, trace) = shape, hand, notes
    box, terrain = part.box, part.terrain
    funnel.count("silhouette", len(outline.loops), "the points are too scattered for an outline")
    trace.silhouette, trace.gravity_center = outline, center
    if settings.method == "allen":
        grasps = point_finger_grasps(outline, center.area, terrain.lowest_m if terrain else 0.0, settings)
        funnel.count("immobilising", len(grasps), "no two points of the outline hold it, as on any convex one")
        return grasps[:top]

    # A.3 step points, finger candidates, grasping directions
    steps = trace.steps = step_points(outline, settings.fingers)
    funnel.count("step_points", sum(len(step.points) for step in steps), "the outline has no step point")
    chords = finger_candidates(outline, steps, gripper, settings.fingers)
    funnel.count("finger_candidates", len(chords), _no_finger_place(box, gripper))
    fingers, trace.doubted_directions = inward_directions(outline, chords, settings.fingers, settings.seed)
    funnel.count("grasping_direction", len(fingers), "no finger candidate has the object before it")
    if terrain is not None and terrain.level_m > terrain.lowest_m:
        fingers = fingers.select(upright(fingers, terrain, settings.depth.wall_drop))
        funnel.count("upright", len(fingers), "the part that stands out has no steep side")
    if terrain is not None:
        fingers = seen_sides(fingers, terrain)
        funnel.count("open_sides", len(fingers), "the object's only side is that of a hole that was not seen through")
    trace.fingers = fingers

    # B.1 force balance of all pairs; B.2 torque balance
    gamma_deg = trace.force_balance_deg = force_balance(fingers)
    pairs = force_balanced(fingers, gamma_deg, settings.balance, funnel)
    pairs = torque_balanced(pairs, settings.balance, funnel)

    # B.3 grasping range; B.4 variance; B.5 operability
    pairs = closing_axes(fingers, pairs, settings.hand.closing_axis)
    pairs = on_pads(fingers, pairs, gripper, funnel)
    if terrain is not None:
        pairs = of_known_thickness(fingers, pairs, funnel)
    pairs = in_range(fingers, pairs, gripper, settings.hand, funnel)
    pairs = flat(fingers, pairs, settings.hand, funnel)
    pairs, fit = operable(outline, fingers, pairs, (gripper, settings.hand), funnel)
    if terrain is None:
        pairs, fit = clear_of_palm(outline, fingers, pairs, fit, gripper, funnel)
        landing = at_mid_height(fit, gripper, settings.hand)
    else:
        pairs, fit, landing = land(fingers, pairs, fit, terrain, (gripper, settings), funnel)

    # C gravity, and the final grasp
    ranking = ranking_cost(fingers, pairs, outline, center.place, fit, settings.gravity)
    cost = ranking.cost + landing_cost(landing, settings) if terrain else ranking.cost
    order = best_first(pairs, cost)
    trace.gravity_distance_m = ranking.distance[order]
    trace.ranked = np.column_stack([pairs.i, pairs.j])[order]
    best = order[:top]
    hands = (pairs.select(best), fit.select(best), ranking.select(best), landing.select(best))
    touched = pad_contacts(fingers, hands[0], hands[1], gripper, settings.hand.contact_tolerance_m)
    return _grasps(outline, fingers, hands, (touched, cost[best]), terrain is not None)


def _grasps(
    outline: Silhouette,
    fingers: FingerCandidates,
    hands: tuple[GraspCandidates, Fit, RankingCost, Landing],
    judged: tuple[FloatArray, FloatArray],
    on_support: bool,
) -> tuple[Grasp, ...]:
    """The records of pairs, best first.

    Hand y is the closing axis and hand z = −normal, so hand x = y × z = normal × y: y turned left in the plane.
    """
    (pairs, fit, ranking, landing), (touched, cost) = hands, judged
    frame = outline.frame
    position = frame.to_world(np.column_stack([centers(fingers, pairs, fit), landing.tip]))
    heights = np.repeat(landing.touch[:, None, None], 2, axis=1)
    contacts = frame.to_world(np.concatenate([touched, heights], axis=2))
    axes = np.empty((len(pairs), 3, 3))
    axes[:, 0], axes[:, 1] = left_normal(pairs.axis) @ frame.axes[:2], pairs.axis @ frame.axes[:2]
    axes[:, 2] = -frame.axes[2]
    columns = {
        "opening_m": landing.opening,
        "width_m": fit.width,
        "force_balance_deg": pairs.force_balance_deg,
        "torque_arm_m": pairs.torque_arm_m,
        "required_friction": pairs.required_friction,
        "variance_m": fingers.variance[pairs.i] + fingers.variance[pairs.j],
        "gravity_distance_m": ranking.distance,
        "inside_share": ranking.inside_share,
        "arc_ratio": np.maximum(fingers.arc_ratio[pairs.i], fingers.arc_ratio[pairs.j]),
        "cost_m": cost,
    }
    if on_support:
        columns |= {"tip_height_m": landing.tip, "grip_m": landing.grip, "unseen_m": landing.unseen}
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    places = zip(pairs.i.tolist(), pairs.j.tolist(), strict=True)
    return tuple(
        Grasp(
            rank=k + 1,
            position=position[k],
            orientation=quaternion_from_axes(axes[k]),
            contacts=contacts[k],
            fingers=place,
            **dict(zip(columns, row, strict=True)),
        )
        for k, (place, row) in enumerate(zip(places, rows, strict=True))
    )


def _no_plane(points: FloatArray, cropped: bool) -> str:
    if len(points) == 0 and cropped:
        return "no point lies in the region of interest"
    if len(points) == 0:
        return "no point of the cloud was measured: all are invalid, 0 0 0, or farther than 10 km from the origin"
    distinct = len(np.unique(points, axis=0))
    if distinct < 3:
        return f"the cloud has {distinct} distinct point{'s' if distinct > 1 else ''}, an outline needs three"
    return f"all {len(points)} points lie on a line"


def _no_finger_place(box: OrientedBox, gripper: Gripper) -> str:
    widest = max(gripper.jaw_width_m(0), gripper.jaw_width_m(1))
    return f"the outline is {box.size[0]:.3f} m × {box.size[1]:.3f} m, too small for fingers {widest:.3f} m wide"
