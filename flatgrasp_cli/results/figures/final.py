"""The final grasp at a glance: where the hand goes, how wide, and why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Grasp, ObjectPlan
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.arm import draw_arm, has_arm, manipulability_in_words
from flatgrasp_cli.results.figures.close import draw_close
from flatgrasp_cli.results.figures.marks import sensor_in_words
from flatgrasp_cli.results.figures.page import Page
from flatgrasp_cli.results.figures.scene import draw_scene, picked
from flatgrasp_cli.results.figures.side import draw_side
from flatgrasp_cli.results.figures.style import ASLANT_DEG, MM, NO_BREAK, counted, in_numbers, numbered
from flatgrasp_cli.results.success import holds_in_words
from flatgrasp_cli.results.view import View, middle_of, normal_of, view_of

REASONS = 3
"""Objects without a grasp of which the caption says why."""


def final_figure(plan: Plan) -> Figure:
    """The best grasp close by; of a scene beside a view of all its objects, and of a robot with its arm."""
    normal, scene, close, arm = normal_of(plan), plan.scene.support is not None, bool(plan.objects), has_arm(plan)
    support = plan.scene.support if plan.best is not None and plan.best.tilt_deg > ASLANT_DEG else None
    view = view_of(plan, normal)
    source = replace(plan.cloud.source, path=Path(plan.cloud.source.path).name)
    panels = scene + close + (support is not None) + arm
    page = Page(f"{source} · {plan.gripper.description}", max(1, panels))
    if scene:
        draw_scene(page.panel(f"from above: {counted(len(plan.objects), 'object')} on a support plane"), plan, view)
    if close:
        item = plan.objects[0]
        axes = page.panel(f"object {item.object.id}{_level(item)}")
        draw_close(axes, plan, item, _along_approach(plan, item, view), places=not scene)
        if support is not None:
            draw_side(page.panel(f"object {item.object.id} from the side"), plan, item, support)
    if arm:
        draw_arm(page.panel(f"{plan.robot.name if plan.robot else ''} in its frame", solid=True), plan)
    if not scene and not close:
        page.panel("nothing to grasp").set_axis_off()
    return page.finish(_caption(plan, normal))


def _along_approach(plan: Plan, item: ObjectPlan, view: View) -> View:
    """The view of an object as its silhouette was taken: as the hand comes."""
    return view if item.silhouette is None else view_of(plan, item.silhouette.frame.axes[2])


def _level(item: ObjectPlan) -> str:
    level = item.level_m
    if level is None:
        return " in its main plane"
    if item.grasps and item.grasps[0].tilt_deg > ASLANT_DEG:
        return " as the hand comes"
    return f": silhouette of what is higher than {MM * level:.0f} mm"


def _caption(plan: Plan, normal: FloatArray) -> list[tuple[str, str]]:
    """Rows of a word and what it says."""
    camera = ("Camera", sensor_in_words(plan, middle_of(plan), normal))
    best = plan.best
    if best is None:
        stage = f" (stage {plan.objects[0].funnel[-1].stage.replace('_', ' ')})" if plan.objects else ""
        return [("No grasp", f"{plan.reason}{stage}"), camera]
    rows = [("Where", _where(plan, best)), ("How wide", _how_wide(plan, best)), ("Why", _why(plan, best))]
    if plan.robot is not None:
        rows.append(("Robot", f"{plan.robot.name} reaches it: {manipulability_in_words(best)}"))
    return [*rows, *_order(plan), camera, *_without_grasp(plan)]


def _order(plan: Plan) -> list[tuple[str, str]]:
    """What the numbers in circles are, and what comes late in that order."""
    things = [item.object for item in plan.objects[: picked(plan)]]
    if not things:
        return []
    notes = [f"on object {thing.id} lies {numbered(thing.supports)}" for thing in things if thing.supports]
    last = [thing.id for thing in things if thing.cut_off or thing.at_edge]
    notes += [f"at the edge of what was seen: object {numbered(last)}"] if last else []
    return [("Order", "; ".join(["the numbers in circles: pick one after the other", *notes]))]


def _without_grasp(plan: Plan) -> list[tuple[str, str]]:
    """Why other objects have none."""
    missed = [item for item in plan.objects if item.rejection is not None]
    reasons = [f"object {item.object.id}: {item.rejection.reason}" for item in missed if item.rejection]
    rows = [("No grasp", reason) for reason in reasons[:REASONS]]
    return rows if len(reasons) <= REASONS else [*rows, ("", f"and {counted(len(reasons) - REASONS, 'more object')}")]


def _where(plan: Plan, best: Grasp) -> str:
    approach = in_numbers(axes_from_quaternion(best.orientation)[2])
    rows = [f"the fingertips end at {_place(best.position)} in {plan.cloud.frame_name!r}, coming along {approach}"]
    if best.tilt_deg > ASLANT_DEG:
        rows.append(f"{best.tilt_deg:.0f}° from straight down")
        rows.extend(f"not straight down, for {why}" for why in (plan.objects[0].why_not_top,) if why)
    if best.tip_height_m is not None and best.grip_m is not None:
        over = "over the deepest that was seen of the object" if best.tilt_deg > ASLANT_DEG else "above the plane"
        rows.append(f"{MM * best.tip_height_m:.1f} mm {over}, where the pads cover {MM * best.grip_m:.1f} mm")
    if best.way is not None:
        rows.append(f"the flange is then at {_place(best.way.flange.pose.position)}")
    return "; ".join(rows)


def _place(position: FloatArray) -> str:
    """A place (3,) in words that stay on one line."""
    whole = np.round(MM * position) + 0.0  # no minus before a zero
    numbers = (f"{name}{NO_BREAK}{value:.0f}" for name, value in zip("xyz", whole, strict=True))
    return f",{NO_BREAK}".join(numbers).replace("-", "−") + " mm"


def _how_wide(plan: Plan, best: Grasp) -> str:
    hidden_mm = MM * best.hidden_m
    return (
        f"it comes open {MM * best.opening_m:.1f} of {MM * plan.gripper.max_opening_m:.0f} mm, and closes to "
        f"{MM * best.width_m:.1f} mm, the object's width there"
        + (f" if it goes on by half of the {hidden_mm:.0f} mm that it may out of sight" if hidden_mm >= 1 else "")
    )


def _why(plan: Plan, best: Grasp) -> str:
    reasons = [
        *holds_in_words(best),
        f"the best of the {plan.objects[0].funnel[-1].kept} that passed every stage",
        f"its sides are parallel within {best.force_balance_deg:.1f}° (force balance)",
        f"torque arm {MM * best.torque_arm_m:.1f} mm",
        f"needs friction {best.required_friction:.2f}, pads have {plan.gripper.pad_friction:.2f}",
        f"the line through the contacts passes {MM * best.gravity_distance_m:.1f} mm beside the centre of gravity",
        f"{100 * best.inside_share:.0f} % of it between them lies in the object",
    ]
    cage = best.cage
    if cage is not None and cage.squeezing and cage.opening_max_m is not None:
        reasons.append(f"caged below {MM * cage.opening_max_m:.0f} mm")
    return "; ".join(reasons)
