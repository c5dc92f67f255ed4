"""The final grasp at a glance."""

from __future__ import annotations

import textwrap
from pathlib import Path

from matplotlib.figure import Figure

from flatgrasp_cli.model import Grasp, ObjectPlan
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.figures.hand import draw_hand, hand_in_plane
from flatgrasp_cli.results.figures.style import (
    GREY,
    MM,
    PURPLE,
    draw_outline,
    draw_points,
    draw_segments,
    legend,
    new_figure,
    plane_axes,
)

OTHERS = 5


def final_figure(plan: Plan) -> Figure:
    """The cloud in the main plane with outline, hand, contacts and centre of gravity, and the numbers below."""
    figure = new_figure()
    item = plan.objects[0]
    axes = plane_axes(figure, f"{Path(plan.cloud.source.path).name} · {plan.gripper.name}")
    outline = item.trace.silhouette
    if outline is not None:
        draw_points(axes, outline)
        draw_outline(axes, outline)
        if item.grasps:
            _draw_others(axes, item)
            draw_hand(axes, item.grasps[0], outline.frame, plan.gripper)
        if item.trace.gravity_center is not None:
            center = MM * item.trace.gravity_center
            axes.plot(*center, "P", color=PURPLE, ms=11, mec="white", zorder=8, label="centre of gravity")
        legend(axes)
    figure.supxlabel(_caption(item, plan.gripper), fontsize=9, x=0.02, ha="left")
    return figure


def _draw_others(axes: object, item: ObjectPlan) -> None:
    """The next best grasps, as thin lines."""
    outline = item.trace.silhouette
    if outline is None:
        return
    for grasp in item.grasps[1 : 1 + OTHERS]:
        origin, _, along = hand_in_plane(grasp, outline.frame)
        half = 0.5 * grasp.width_m * along
        draw_segments(axes, origin[None] - half, origin[None] + half, colors=GREY, linewidths=0.8, zorder=3)  # type: ignore[arg-type]


def _caption(item: ObjectPlan, gripper: Gripper) -> str:
    if not item.grasps:
        reason = item.rejection.reason if item.rejection else ""
        stage = item.funnel[-1].stage.replace("_", " ")
        return textwrap.fill(f"no grasp: {reason} (stage {stage})", 110)
    return _numbers(item.grasps[0], gripper)


def _numbers(grasp: Grasp, gripper: Gripper) -> str:
    return (
        f"width {MM * grasp.width_m:.1f} mm, open {MM * grasp.opening_m:.1f} of {MM * gripper.max_opening_m:.0f} mm"
        f"    force balance {grasp.force_balance_deg:.1f}°    torque arm {MM * grasp.torque_arm_m:.1f} mm\n"
        f"needs friction {grasp.required_friction:.2f} (pads {gripper.pad_friction:.2f})"
        f"    gravity distance {MM * grasp.gravity_distance_m:.1f} mm"
        f"    {100 * grasp.inside_share:.0f} % of the grasping line inside the object"
    )
