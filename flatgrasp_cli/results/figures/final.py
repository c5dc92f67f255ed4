"""The final grasp at a glance."""

from __future__ import annotations

import textwrap
from dataclasses import replace
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flatgrasp_cli.model import Grasp, ObjectPlan
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.figures.hand import draw_hand, hand_in_plane
from flatgrasp_cli.results.figures.scene import draw_scene
from flatgrasp_cli.results.figures.style import (
    GREY,
    MM,
    PURPLE,
    SKY,
    draw_outline,
    draw_points,
    draw_segments,
    legend,
    new_figure,
    plane_axes,
)

OTHERS = 5


def final_figure(plan: Plan) -> Figure:
    """The best grasp in the main plane, with the numbers below; of a scene beside a view of all its objects."""
    support = plan.scene.support
    figure = new_figure() if support is None else new_figure(14.0, 6.5)
    source = plan.cloud.source
    name = f"{replace(source, path=Path(source.path).name)} · {plan.gripper.name}"
    if support is not None:
        scene = figure.add_subplot(121)
        figure.suptitle(name, fontsize=11, x=0.02, ha="left")
        scene.set_title(f"{_count(plan)} on a support plane", loc="left", fontsize=11)
        draw_scene(scene, plan, support)
    if plan.objects:
        item = plan.objects[0]
        title = name if support is None else f"object {item.object.id}{_level(item)}"
        _draw_close(plane_axes(figure, title, 111 if support is None else 122), item, plan.gripper)
    figure.supxlabel(_caption(plan), fontsize=9, x=0.02, ha="left")
    return figure


def _count(plan: Plan) -> str:
    return "1 object" if len(plan.objects) == 1 else f"{len(plan.objects)} objects"


def _level(item: ObjectPlan) -> str:
    level = item.trace.level_m
    return "" if level is None else f": the outline of what is higher than {MM * level:.0f} mm"


def _draw_close(axes: Axes, item: ObjectPlan, gripper: Gripper) -> None:
    """One object in its main plane with outline, hand, contacts and centre of gravity."""
    outline = item.trace.silhouette
    if outline is None:
        return
    draw_points(axes, outline)
    draw_outline(axes, outline)
    _draw_hidden(axes, item)
    if item.grasps:
        _draw_others(axes, item)
        draw_hand(axes, item.grasps[0], outline.frame, gripper)
    if item.trace.gravity_center is not None:
        center = MM * item.trace.gravity_center
        axes.plot(*center, "P", color=PURPLE, ms=11, mec="white", zorder=8, label="centre of gravity")
    legend(axes)


def _draw_hidden(axes: Axes, item: ObjectPlan) -> None:
    """The sides behind which the object probably goes on, unseen, or whose thickness is not known."""
    fingers = item.trace.fingers
    if fingers is None:
        return
    unsure = (fingers.hidden > 0) | ~fingers.seen
    if unsure.any():
        start, end = fingers.start[unsure], fingers.end[unsure]
        lines = draw_segments(axes, start, end, colors=SKY, linewidths=3.0, alpha=0.6, zorder=2)
        lines.set_label("not seen behind")


def _draw_others(axes: Axes, item: ObjectPlan) -> None:
    """The next best grasps, as thin lines."""
    outline = item.trace.silhouette
    if outline is None:
        return
    for grasp in item.grasps[1 : 1 + OTHERS]:
        origin, _, along = hand_in_plane(grasp, outline.frame)
        half = 0.5 * grasp.width_m * along
        draw_segments(axes, origin[None] - half, origin[None] + half, colors=GREY, linewidths=0.8, zorder=3)


def _caption(plan: Plan) -> str:
    if plan.best is not None:
        return _numbers(plan.best, plan.gripper)
    stage = f" (stage {plan.objects[0].funnel[-1].stage.replace('_', ' ')})" if plan.objects else ""
    return textwrap.fill(f"no grasp: {plan.reason}{stage}", 110)


def _numbers(grasp: Grasp, gripper: Gripper) -> str:
    depth = ""
    if grasp.tip_height_m is not None and grasp.grip_m is not None:
        depth = (
            f"    fingertips {MM * grasp.tip_height_m:.1f} mm above the plane, pads {MM * grasp.grip_m:.1f} mm high on "
            f"the object"
        )
    return (
        f"width {MM * grasp.width_m:.1f} mm, open {MM * grasp.opening_m:.1f} of {MM * gripper.max_opening_m:.0f} mm"
        f"    force balance {grasp.force_balance_deg:.1f}°    torque arm {MM * grasp.torque_arm_m:.1f} mm{depth}\n"
        f"needs friction {grasp.required_friction:.2f} (pads {gripper.pad_friction:.2f})"
        f"    gravity distance {MM * grasp.gravity_distance_m:.1f} mm"
        f"    {100 * grasp.inside_share:.0f} % of the grasping line inside the object"
    )
