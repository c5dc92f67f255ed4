"""One figure for each stage of the method, after the paper's Figs. 3 to 17."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import IntArray
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.model import FingerCandidates, ObjectPlan
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.solid import balance_surface, boxes, final_on_cloud, resultant
from flatgrasp_cli.results.figures.style import (
    BLUE,
    GREY,
    MM,
    PALE,
    PURPLE,
    RED,
    SKY,
    draw_outline,
    draw_points,
    draw_segments,
    legend,
    new_figure,
    plane_axes,
)

MAX_PAIRS = 250
PAIR_STAGES = {
    "force_balance": "B.1",
    "torque_balance": "B.2",
    "pads": "B.3",
    "grasping_range": "B.3",
    "variance": "B.4",
    "seen": "B.3",
    "operability": "B.5",
    "depth": "B.5",
    "palm": "B.5",
}


def stage_figures(plan: Plan) -> Iterator[tuple[str, Callable[[], Figure | None]]]:
    """Name of each stage in the method's order, and what draws it: None where the first object did not get so far."""
    if not plan.objects:
        return
    item = plan.objects[0]
    drawings: list[tuple[str, Callable[[Plan, ObjectPlan], Figure | None]]] = [
        ("obb", boxes),
        ("projection", _projection),
        ("step_points", _step_points),
        ("finger_candidates", _finger_candidates),
        ("grasping_directions", _directions),
        ("force_balance_image", _balance_image),
        ("force_balance_surface", balance_surface),
        ("funnel", _funnel),
        *((stage, _pairs_of(stage)) for stage in PAIR_STAGES),
        ("gravity", _gravity),
        ("final_grasp", final_on_cloud),
    ]
    for number, (name, draw) in enumerate(drawings, start=1):
        yield f"{number:02d}_{name}", partial(draw, plan, item)


def _projection(_: Plan, item: ObjectPlan) -> Figure | None:
    """Figs. 4 and 5: the projection and its concave hull, in serial order."""
    outline = item.trace.silhouette
    if outline is None:
        return None
    figure = new_figure()
    holes = max(len(outline.loops) - 1, 0)
    title = (
        f"A.2 projection and concave hull: α = {MM * outline.alpha_m:.1f} mm, {holes} hole{'' if holes == 1 else 's'}"
    )
    axes = plane_axes(figure, title)
    draw_points(axes, outline)
    draw_outline(axes, outline)
    for loop in outline.loops:
        axes.scatter(MM * loop[:, 0], MM * loop[:, 1], c=np.arange(len(loop)), cmap="viridis", s=14, zorder=3)
    axes.plot([], [], "o", ms=1.5, color="C2", label="vertices in serial order")
    legend(axes)
    return figure


def _step_points(_: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 7: step points."""
    outline, steps = item.trace.silhouette, item.trace.steps
    if outline is None or not steps:
        return None
    figure = new_figure()
    total = sum(len(step.points) for step in steps)
    axes = plane_axes(figure, f"A.3.1 {total} step points, r = {MM * steps[0].step_m:.1f} mm")
    draw_outline(axes, outline, BLUE)
    for step in steps:
        axes.plot(*(MM * step.points).T, "o", ms=3, color=RED, zorder=3)
    return figure


def _finger_candidates(_: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 8: finger candidates."""
    outline, fingers = item.trace.silhouette, item.trace.fingers
    if outline is None or fingers is None:
        return None
    figure = new_figure()
    widths = ", ".join(f"{MM * width:.1f}" for width in np.unique(fingers.width))
    axes = plane_axes(figure, f"A.3.2 {len(fingers)} finger candidates, w_f = {widths} mm")
    draw_outline(axes, outline, GREY)
    for width, color in zip(np.unique(fingers.width), (PURPLE, SKY), strict=False):
        chosen = fingers.width == width
        draw_segments(axes, fingers.start[chosen], fingers.end[chosen], colors=color, linewidths=1.0, zorder=3)
    return figure


def _directions(_: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 11 (c): inside grasping directions."""
    outline, fingers = item.trace.silhouette, item.trace.fingers
    if outline is None or fingers is None:
        return None
    figure = new_figure()
    axes = plane_axes(figure, f"A.3.3 grasping directions, {item.trace.doubted_directions} doubted")
    draw_outline(axes, outline, GREY)
    length = 0.05 * float(np.ptp(outline.loops[0], axis=0).max())
    draw_segments(axes, fingers.start, fingers.end, colors=PURPLE, linewidths=0.6, zorder=3)
    tips = fingers.contact + length * fingers.direction
    draw_segments(axes, fingers.contact, tips, colors=BLUE, linewidths=0.8, zorder=4)
    axes.plot(*(MM * tips).T, ".", ms=2, color=BLUE, zorder=5)
    return figure


def _balance_image(_: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 13 (b): the resultant force of all pairs as an image."""
    height = resultant(item)
    if height is None:
        return None
    figure = new_figure()
    axes = figure.add_subplot()
    image = axes.imshow(height, cmap="cividis", vmin=0, vmax=2, origin="lower", interpolation="nearest")
    figure.colorbar(image, ax=axes, label="resultant of two unit forces, 2 sin(γ/2)")
    axes.set_xlabel("finger candidate j")
    axes.set_ylabel("finger candidate i")
    axes.set_title("B.1 force balance: dark pairs are balanced", loc="left", fontsize=11)
    return figure


def _funnel(_: Plan, item: ObjectPlan) -> Figure:
    """How many candidates each stage kept."""
    figure = new_figure()
    axes = figure.add_subplot()
    names = [stage.stage.replace("_", " ") for stage in item.funnel]
    kept = [stage.kept for stage in item.funnel]
    bars = axes.barh(names, kept, color=BLUE)
    axes.bar_label(bars, padding=3)
    axes.set_xscale("symlog", linthresh=1)
    axes.set_xlim(0, 5 * max(1, *kept))
    axes.invert_yaxis()
    axes.set_xlabel("kept")
    axes.set_title("The funnel", loc="left", fontsize=11)
    return figure


def _pairs_of(stage: str) -> Callable[[Plan, ObjectPlan], Figure | None]:
    """Drawing of the pairs that a stage kept, over those that it removed."""

    def draw(_: Plan, item: ObjectPlan) -> Figure | None:
        trace = item.trace
        outline, fingers = trace.silhouette, trace.fingers
        if outline is None or fingers is None or stage not in trace.survivors:
            return None
        order = list(trace.survivors)
        kept = trace.survivors[stage]
        before = trace.survivors[order[order.index(stage) - 1]] if order.index(stage) else kept
        figure = new_figure()
        axes = plane_axes(
            figure, f"{PAIR_STAGES[stage]} {stage.replace('_', ' ')}: kept {len(kept)} of {len(before)} pairs"
        )
        draw_outline(axes, outline)
        _draw_pairs(
            axes, fingers, _difference(before, kept), "removed", {"colors": PALE, "linewidths": 0.5, "zorder": 3}
        )
        _draw_pairs(axes, fingers, kept, "kept", {"colors": BLUE, "linewidths": 0.6, "zorder": 4})
        legend(axes)
        return figure

    return draw


def _difference(pairs: IntArray, without: IntArray) -> IntArray:
    gone = {(int(i), int(j)) for i, j in without}
    return np.array([pair for pair in pairs.tolist() if tuple(pair) not in gone], dtype=np.intp).reshape(-1, 2)


def _draw_pairs(axes: object, fingers: FingerCandidates, pairs: IntArray, label: str, style: dict[str, object]) -> None:
    """Grasping lines of an even sample of pairs."""
    shown = pairs[spread_indices(len(pairs), MAX_PAIRS)]
    lines = draw_segments(axes, fingers.contact[shown[:, 0]], fingers.contact[shown[:, 1]], **style)  # type: ignore[arg-type]
    lines.set_label(
        f"{label} ({len(shown)} of {len(pairs)} shown)" if len(shown) < len(pairs) else f"{label} ({len(pairs)})"
    )


def _gravity(_: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 17: grasping lines by their distance to the centre of gravity, and the final grasp."""
    trace = item.trace
    if trace.silhouette is None or trace.fingers is None or trace.ranked is None or trace.gravity_distance_m is None:
        return None
    figure = new_figure()
    axes = plane_axes(figure, "C gravity: the final grasp (bold), all others by gravity distance")
    draw_outline(axes, trace.silhouette)
    step = max(1, len(trace.ranked) // MAX_PAIRS)
    shown, distance = trace.ranked[::step][::-1], MM * trace.gravity_distance_m[::step][::-1]
    contact = trace.fingers.contact
    lines = draw_segments(axes, contact[shown[:, 0]], contact[shown[:, 1]], linewidths=0.8, zorder=3)
    lines.set(array=distance, cmap="viridis")
    figure.colorbar(lines, ax=axes, label="gravity distance (mm)", shrink=0.7)
    best = trace.ranked[0]
    for k in best:
        ends = MM * np.stack([trace.fingers.start[k], trace.fingers.end[k]])
        axes.plot(ends[:, 0], ends[:, 1], color=RED, lw=4, zorder=5, solid_capstyle="butt")
    axes.plot(*(MM * contact[best]).T, color=RED, lw=1.5, zorder=5)
    if trace.gravity_center is not None:
        axes.plot(*(MM * trace.gravity_center), "P", color=PURPLE, ms=11, mec="white", zorder=6)
    return figure
