"""One figure for each stage of the method, after the paper's Figs. 3 to 17."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import IntArray
from flatgrasp_cli.geometry.sampling import even_sample
from flatgrasp_cli.model import ObjectPlan
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.page import Page
from flatgrasp_cli.results.figures.plane import PlaneDrawing
from flatgrasp_cli.results.figures.solid import (
    BALANCED,
    FORCES,
    PAIRS,
    RESULTANT,
    balance_surface,
    boxes,
    final_on_cloud,
    resultant,
)
from flatgrasp_cli.results.figures.style import (
    BLUE,
    MM,
    PALE,
    PURPLE,
    RED,
    SKY,
    counted,
    draw_dots,
    draw_scale,
    entitle,
)

Draw = Callable[[Plan, ObjectPlan], Figure]

MAX_PAIRS = 250
PAIR_STAGES = {
    "force_balance": ("B.1", "the two fingers press against each other: γ between their directions is small enough"),
    "torque_balance": ("B.2", "they press along almost the same line, so that nothing turns in the hand"),
    "pads": ("B.3", "both contacts lie under the pads, although they are not quite opposite each other"),
    "grasping_range": ("B.3", "the object is wide enough there, and not too wide for the hand"),
    "variance": ("B.4", "the silhouette under the pads is even enough"),
    "operability": ("B.5", "open fingers have room beside the object, and their way to it is free"),
    "depth": ("B.5", "the fingers get deep enough beside the object to hold it, and touch nothing on the way down"),
    "seen": ("B.5", "a finger comes to a side of the object that was seen"),
    "palm": ("B.5", "the palm stays clear of the object"),
}
"""The sections of the paper that stages are from, or carry further, and what is true of the pairs that they keep."""


def stage_figures(plan: Plan) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """Numbered names of the stages that the first object got to, in the method's order, and what draws each."""
    if not plan.objects:
        return
    item = plan.objects[0]
    for number, (name, draw) in enumerate(_drawings(item), start=1):
        yield f"{number:02d}_{name}", partial(_numbered, number, draw, plan, item)


def _drawings(item: ObjectPlan) -> Iterator[tuple[str, Draw]]:
    """What can be drawn of an object."""
    trace = item.trace
    known = item.silhouette is not None
    fingers = known and trace.fingers is not None
    balanced = known and resultant(item).size > 0
    drawings: list[tuple[bool, str, Draw]] = [
        (item.box is not None, "obb", boxes),
        (known, "projection", _projection),
        (known and bool(trace.steps), "step_points", _step_points),
        (fingers, "finger_candidates", _finger_candidates),
        (fingers, "grasping_directions", _directions),
        (balanced, "force_balance_image", _balance_image),
        (balanced, "force_balance_surface", balance_surface),
        (True, "funnel", _funnel),
        *((fingers, stage, _pairs_of(stage)) for stage in trace.survivors if stage in PAIR_STAGES),
        (fingers and trace.ranked is not None and trace.gravity_distance_m is not None, "gravity", _gravity),
        (known and bool(item.grasps), "final_grasp", final_on_cloud),
    ]
    return ((name, draw) for drawn, name, draw in drawings if drawn)


def _numbered(number: int, draw: Draw, plan: Plan, item: ObjectPlan) -> Figure:
    """A stage's figure with its number in the title, the same as in the file's name."""
    figure = draw(plan, item)
    entitle(figure, f"{number}. {figure.get_suptitle()}")
    return figure


def _projection(plan: Plan, item: ObjectPlan) -> Figure:
    """Figs. 4 and 5: the projection and its concave hull, in serial order."""
    silhouette = item.silhouette
    assert silhouette is not None  # noqa: S101
    holes = max(len(silhouette.loops) - 1, 0)
    plane = PlaneDrawing(
        plan, item, f"A.2 projection and concave hull: α = {MM * silhouette.alpha_m:.1f} mm, {counted(holes, 'hole')}"
    )
    draw_dots(plane.axes, plane.of(silhouette.points), PALE, "projected cloud")
    for loop in silhouette.loops:
        drawn = plane.of(loop)
        plane.axes.scatter(drawn[:, 0], drawn[:, 1], c=np.arange(len(loop)), cmap="viridis", s=14, zorder=3)
    plane.axes.plot([], [], "o", ms=4, color="#440154", label="vertices: the first")
    plane.axes.plot([], [], "o", ms=4, color="#fde725", label="vertices: the last")
    return plane.finish(
        "the concave hull of the points in the main plane is an α-shape; its vertices are in serial order"
    )


def _step_points(plan: Plan, item: ObjectPlan) -> Figure:
    """Fig. 7: step points."""
    steps = item.trace.steps
    total = sum(len(step.points) for step in steps)
    plane = PlaneDrawing(plan, item, f"A.3.1 {counted(total, 'step point')}, r = {MM * steps[0].step_m:.1f} mm", BLUE)
    drawn = plane.of(np.concatenate([step.points for step in steps]))
    plane.axes.plot(*drawn.T, "o", ms=3, color=RED, zorder=3, label="step points")
    return plane.finish("points r apart along the silhouette (eq. 1): each is where a place for a finger begins")


def _finger_candidates(plan: Plan, item: ObjectPlan) -> Figure:
    """Fig. 8: finger candidates."""
    fingers = item.trace.fingers
    assert fingers is not None  # noqa: S101
    plane = PlaneDrawing(plan, item, f"A.3.2 {counted(len(fingers), 'finger candidate')}")
    for width, color in zip(np.unique(fingers.width), (PURPLE, SKY), strict=False):
        chosen = fingers.width == width
        label = f"{counted(int(chosen.sum()), 'candidate')} for w_f = {MM * width:.1f} mm"
        plane.segments(fingers.start[chosen], fingers.end[chosen], label, colors=color, linewidths=1.2, zorder=3)
    return plane.finish("chords of the silhouette as wide as what presses there, w_f: a finger, or two side by side")


def _directions(plan: Plan, item: ObjectPlan) -> Figure:
    """Fig. 11 (c): inside grasping directions."""
    silhouette, fingers = item.silhouette, item.trace.fingers
    assert silhouette is not None  # noqa: S101
    assert fingers is not None  # noqa: S101
    plane = PlaneDrawing(plan, item, f"A.3.3 grasping directions, {item.trace.doubted_directions} doubted")
    length = 0.05 * float(np.ptp(silhouette.loops[0], axis=0).max())
    plane.segments(fingers.start, fingers.end, "finger candidates", colors=PURPLE, linewidths=0.6, zorder=3)
    tips = fingers.contact + length * fingers.direction
    plane.segments(fingers.contact, tips, "grasping directions: inward", colors=BLUE, linewidths=0.8, zorder=4)
    plane.axes.plot(*plane.of(tips).T, ".", ms=3, color=BLUE, zorder=5)
    return plane.finish("at right angles to each finger candidate, into the object; candidates in doubt are left out")


def _balance_image(_: Plan, item: ObjectPlan) -> Figure:
    """Fig. 13 (b): the resultant force of all pairs as an image."""
    page = Page("B.1 force balance of all pairs, as an image", 1)
    axes = page.panel(PAIRS)
    style: dict[str, Any] = {"origin": "lower", "interpolation": "nearest", "aspect": "auto"}
    image = axes.imshow(resultant(item), cmap="cividis", vmin=0, vmax=2, **style)
    draw_scale(axes, image, RESULTANT, left=1.06, height=0.6)
    axes.set_xlabel("finger candidate j", fontsize=9)
    axes.set_ylabel("finger candidate i", fontsize=9)
    axes.plot([], [], "s", ms=8, color=BALANCED, label="dark: the pair is balanced")
    return page.finish([("Method", f"{FORCES}; a pair is balanced where that is little")])


def _funnel(_: Plan, item: ObjectPlan) -> Figure:
    """How many candidates each stage kept."""
    page = Page("The funnel: how many candidates each stage kept", 1, left_in=1.6)
    axes = page.panel(f"object {item.object.id}")
    names = [stage.stage.replace("_", " ") for stage in item.funnel]
    kept = [stage.kept for stage in item.funnel]
    bars = axes.barh(names, kept, color=BLUE, label="candidates that are left after the stage")
    axes.bar_label(bars, padding=3, fontsize=9)
    axes.set_xscale("symlog", linthresh=1)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_xlim(0, 5 * max(1, *kept))
    axes.invert_yaxis()
    axes.set_xlabel("candidates kept", fontsize=9)
    words = "stages in their order from above; places for a finger at first, and from 'pairs' on two of them"
    return page.finish([("Method", words)])


def _pairs_of(stage: str) -> Draw:
    """Drawing of the pairs that a stage kept, over those that it removed."""

    def draw(plan: Plan, item: ObjectPlan) -> Figure:
        trace = item.trace
        kept, names = trace.survivors[stage], [each.stage for each in item.funnel]
        before = item.funnel[names.index(stage) - 1].kept if stage in names[1:] else len(kept)
        order = list(trace.survivors)
        earlier = trace.survivors[order[order.index(stage) - 1]] if order.index(stage) else kept
        section, words = PAIR_STAGES[stage]
        title = f"{section} {stage.replace('_', ' ')}: kept {len(kept)} of {counted(before, 'pair')}"
        plane = PlaneDrawing(plan, item, title)
        _draw_pairs(plane, item, _difference(earlier, kept), "removed", colors=PALE, linewidths=0.7, zorder=3)
        _draw_pairs(plane, item, kept, "kept", colors=BLUE, linewidths=0.7, zorder=4)
        return plane.finish(words)

    return draw


def _difference(pairs: IntArray, without: IntArray) -> IntArray:
    gone = {(int(i), int(j)) for i, j in without}
    return np.array([pair for pair in pairs.tolist() if tuple(pair) not in gone], dtype=np.intp).reshape(-1, 2)


def _draw_pairs(plane: PlaneDrawing, item: ObjectPlan, pairs: IntArray, word: str, **style: Any) -> None:
    """Grasping lines of an even sample of pairs."""
    fingers = item.trace.fingers
    if fingers is None or not len(pairs):
        return
    shown = even_sample(pairs, MAX_PAIRS)
    label = f"{word} ({len(shown)} of {len(pairs)} shown)" if len(shown) < len(pairs) else f"{word} ({len(pairs)})"
    plane.segments(fingers.contact[shown[:, 0]], fingers.contact[shown[:, 1]], label, **style)


def _gravity(plan: Plan, item: ObjectPlan) -> Figure:
    """Fig. 17: grasping lines by their distance to the centre of gravity, and the final grasp."""
    trace, fingers = item.trace, item.trace.fingers
    assert fingers is not None  # noqa: S101
    assert trace.ranked is not None  # noqa: S101
    assert trace.gravity_distance_m is not None  # noqa: S101
    plane = PlaneDrawing(plan, item, "C gravity: grasps by their distance to the centre of gravity")
    step = max(1, len(trace.ranked) // MAX_PAIRS)
    shown, distance = trace.ranked[::step][::-1], MM * trace.gravity_distance_m[::step][::-1]
    contact = fingers.contact
    words = f"grasps ({len(shown)} of {len(trace.ranked)}), coloured by it"
    lines = plane.segments(contact[shown[:, 0]], contact[shown[:, 1]], words, linewidths=0.9, zorder=3)
    lines.set(array=distance, cmap="viridis")
    draw_scale(plane.axes, lines, "gravity distance (mm)", left=1.06, height=0.6)
    best = trace.ranked[0]
    for k in best:
        ends = plane.of(np.stack([fingers.start[k], fingers.end[k]]))
        label = "the final grasp's finger candidates" if k == best[0] else None
        plane.axes.plot(*ends.T, color=RED, lw=4, zorder=5, solid_capstyle="butt", label=label)
    plane.axes.plot(*plane.of(contact[best]).T, color=RED, lw=1.5, zorder=5, label="the final grasp")
    if item.gravity_center is not None:
        center = plane.of(item.gravity_center.place[None])
        plane.axes.plot(*center.T, "P", color=PURPLE, ms=9, mec="white", ls="none", zorder=6, label="centre of gravity")
    return plane.finish(
        "the gravity distance is how far beside the centre of gravity the line through the contacts passes"
    )
