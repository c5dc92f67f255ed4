"""A scene from above: its objects, numbered, and the best grasp of each."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.hand import draw_fingers, draw_refused, hand_extent
from flatgrasp_cli.results.figures.labels import Label, put
from flatgrasp_cli.results.figures.marks import draw_places, draw_triad
from flatgrasp_cli.results.figures.page import show
from flatgrasp_cli.results.figures.style import (
    ASLANT_DEG,
    BLACK,
    BLUE,
    GREEN,
    GREY,
    MM,
    ORANGE,
    PALE,
    PURPLE,
    RED,
    SKY,
    closed,
    draw_dots,
    thinned,
    tick_labels,
)
from flatgrasp_cli.results.view import View

COLORS = (BLUE, GREEN, PURPLE, SKY, ORANGE)
MARGIN_MM = 120.0
CROWD = 10
"""With more objects there is no room for words beside each."""
PLACES = "①②③④⑤⑥⑦⑧⑨⑩"
"""Numbers in circles, as far as Matplotlib's own font has them; those after them are in brackets."""


def draw_scene(axes: Axes, plan: Plan, view: View) -> None:
    """The scene seen along the support plane's normal."""
    things = [view.of_world(item.object.points) for item in plan.objects]
    show(axes, np.concatenate(things or [view.of_world(plan.cloud.points)]), MARGIN_MM)
    obstacles = _draw_cloud(axes, plan, view)
    labels = [_draw_object(axes, plan, k, view) for k in range(len(plan.objects))]
    labels += draw_places(axes, view, plan, np.concatenate([np.empty((0, 2)), *(label.thing for label in labels)]))
    drawn = np.concatenate([obstacles, *map(thinned, things), *(label.thing for label in labels)])
    tick_labels(axes, view)
    put(axes, labels, np.concatenate([drawn, draw_triad(axes, view, plan.cloud.frame_name, drawn)]))


def _draw_cloud(axes: Axes, plan: Plan, view: View) -> FloatArray:
    """All points: as the camera saw them, or each object in a colour of its own; where the obstacles are (n, 2)."""
    low, high = np.column_stack([axes.get_xlim(), axes.get_ylim()])

    def within(points: FloatArray) -> tuple[FloatArray, IntArray]:
        drawn = view.of_world(points)
        inside = np.flatnonzero(((drawn > low) & (drawn < high)).all(axis=1))
        return drawn[inside], inside

    drawn, inside = within(plan.cloud.points)
    obstacles, container = (thinned(within(points)[0]) for points in (plan.scene.clutter, plan.scene.container))
    if plan.cloud.colors is not None:
        draw_dots(axes, drawn, plan.cloud.colors[inside] / 255, "cloud, in its colours")
    else:
        draw_dots(axes, drawn, PALE, "cloud")
        if len(obstacles):
            draw_dots(axes, obstacles, BLACK, "obstacles that are no object")
    if len(container):
        draw_dots(axes, container, GREY, "container, an obstacle")
    for k, item in enumerate(plan.objects):
        if plan.cloud.colors is None or item.object.group is not None:  # what was parted is told apart by colours only
            draw_dots(axes, view.of_world(item.object.points), _color(k), "objects, a colour each" if k == 0 else None)
    return np.concatenate([obstacles, container])


def _color(k: int) -> str:
    return COLORS[k % len(COLORS)]


def _draw_object(axes: Axes, plan: Plan, k: int, view: View) -> Label:
    """The object's silhouette and its best hand, or the best that the robot does not reach; its label."""
    item = plan.objects[k]
    best = bool(item.grasps) and item.grasps[0] is plan.best
    parts = [thinned(view.of_world(item.object.points))]
    silhouette = item.silhouette
    aslant = bool(item.grasps) and item.grasps[0].tilt_deg > ASLANT_DEG
    for loop in silhouette.loops if silhouette and not aslant else ():
        drawn = view.of_plane(silhouette.frame, closed(loop))  # type: ignore[union-attr]
        axes.plot(drawn[:, 0], drawn[:, 1], color=BLACK, lw=0.9, zorder=3)
    if item.grasps:
        name = "final grasp: the closing line" if best else "best grasps of the other objects"
        draw_fingers(axes, item.grasps[0], view, plan.gripper, color=RED if best else GREY, label=name)
        parts.append(hand_extent(item.grasps[0], view, plan.gripper))
    elif item.refused and plan.robot is not None:
        draw_refused(axes, item.refused[0], view, plan.gripper, f"best grasp that {plan.robot.name} does not reach")
        parts.append(hand_extent(item.refused[0], view, plan.gripper))
    box = {"boxstyle": "round,pad=0.2", "fc": "white", "ec": _color(k), "alpha": 0.9}
    weight = "bold" if best else "normal"
    style = {"fontsize": 10, "fontweight": weight, "color": RED if best else BLACK, "bbox": box}
    return Label(_words(plan, k), np.concatenate(parts), style)


def picked(plan: Plan) -> int:
    """How many objects are picked one after the other: the first ones; none where there is but one."""
    count = sum(bool(item.grasps) for item in plan.objects)
    return count if count > 1 else 0


def _words(plan: Plan, k: int) -> str:
    """The place in the order of picking, the object's number, and how wide it is there, or that it has no grasp.

    In a crowd the number alone stands for the latter.
    """
    item = plan.objects[k]
    if item.grasps:
        place = "" if k >= picked(plan) else f"{PLACES[k]} " if k < len(PLACES) else f"({k + 1}) "
        return f"{place}{item.object.id}: {MM * item.grasps[0].width_m:.0f} mm"
    if len(plan.objects) > CROWD:
        return str(item.object.id)
    return f"{item.object.id}: {'out of reach' if item.refused else 'no grasp'}"
