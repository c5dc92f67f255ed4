"""One object and its best grasp, close by."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Grasp, ObjectPlan, Silhouette
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.hand import DrawnHand, draw_hand, draw_refused, hand_extent
from flatgrasp_cli.results.figures.labels import Label, free_corner, put
from flatgrasp_cli.results.figures.marks import TRIAD_PX, draw_places, draw_triad
from flatgrasp_cli.results.figures.page import show
from flatgrasp_cli.results.figures.style import (
    BLACK,
    BLUE,
    GREY,
    HALO,
    MM,
    PALE,
    PURPLE,
    RED,
    SKY,
    closed,
    draw_dots,
    draw_segments,
    thinned,
    tick_labels,
)
from flatgrasp_cli.results.view import View

OTHERS = 5
MARGIN_SHARE = 0.15
"""Room around an object and its hand, of what is drawn."""
MAX_MISSED = 60
"""Pairs that are drawn of those that the last stage removed."""


def draw_close(axes: Axes, plan: Plan, item: ObjectPlan, view: View, *, places: bool = False) -> None:
    """An object with its silhouette, hand, contacts and centre of gravity, and the axes of the frame.

    With `places` also where the camera and the robot's base are.
    """
    silhouette = item.silhouette
    if silhouette is None:
        drawn = view.of_world(item.object.points)
        draw_dots(axes, drawn, PALE, "cloud")
    else:
        drawn = _draw_silhouette(axes, item, silhouette, view)
    hands = [hand_extent(grasp, view, plan.gripper) for grasp in (*item.grasps[:1], *item.refused[:1])]
    drawn = np.vstack([drawn, *hands])
    _draw_grasps(axes, plan, item, view)
    center = item.gravity_center
    if center is not None and silhouette is not None:
        place = view.of_plane(silhouette.frame, center.place[None])
        axes.plot(*place.T, "P", color=PURPLE, ms=9, mec="white", zorder=7, ls="none", label="centre of gravity")
        drawn = np.vstack([drawn, place])
    _show(axes, drawn)
    tick_labels(axes, view)
    labels = draw_places(axes, view, plan, drawn) if places else []
    drawn = np.vstack([drawn, *(label.thing for label in labels)])
    drawn = np.vstack([drawn, draw_triad(axes, view, plan.cloud.frame_name, drawn)])
    if item.grasps:
        labels.insert(0, _widths(item.grasps[0], hands[0]))
    put(axes, labels, drawn)


def _show(axes: Axes, drawn: FloatArray) -> None:
    """Show points (n, 2) with room around them, and more of it where all corners are taken: one is for the axes."""
    size = float(np.ptp(drawn, axis=0).max()) if len(drawn) else 0.0
    show(axes, drawn, MARGIN_SHARE * size)
    if free_corner(axes, drawn, TRIAD_PX)[1]:
        share = TRIAD_PX / min(axes.get_window_extent().size)
        show(axes, drawn, share / (1.0 - 2.0 * share) * size)


def _widths(grasp: Grasp, hand: FloatArray) -> Label:
    """How wide the hand is before and after, beside where it is drawn (n, 2)."""
    words = f"open {MM * grasp.opening_m:.1f} mm\nclosed {MM * grasp.width_m:.1f} mm"
    return Label(words, hand, {"fontsize": 9, "color": RED, "bbox": HALO})


def _draw_silhouette(axes: Axes, item: ObjectPlan, silhouette: Silhouette, view: View) -> FloatArray:
    """Points and silhouette; where they are (n, 2)."""
    points = view.of_plane(silhouette.frame, silhouette.points)
    draw_dots(axes, points, PALE, "cloud")
    draw_loops(axes, silhouette, view)
    fingers = item.trace.fingers
    if fingers is not None:
        unsure = fingers.hidden > 0
        if unsure.any():
            start, end = (view.of_plane(silhouette.frame, ends[unsure]) for ends in (fingers.start, fingers.end))
            style = {"colors": SKY, "linewidths": 3.0, "alpha": 0.6, "zorder": 2}
            draw_segments(axes, start, end, **style).set_label("not seen behind: it may go on")
    loops = [view.of_plane(silhouette.frame, closed(loop)) for loop in silhouette.loops]
    return np.concatenate([*loops, thinned(points)])


def draw_loops(axes: Axes, silhouette: Silhouette, view: View, color: str = BLACK) -> None:
    """The loops of the concave hull."""
    for k, loop in enumerate(silhouette.loops):
        drawn = view.of_plane(silhouette.frame, closed(loop))
        axes.plot(drawn[:, 0], drawn[:, 1], color=color, lw=1.2, zorder=2, label="silhouette" if k == 0 else None)


def _draw_grasps(axes: Axes, plan: Plan, item: ObjectPlan, view: View) -> None:
    """The best grasp and the next ones, or what came nearest to one."""
    others = item.grasps[1 : 1 + OTHERS]
    for k, grasp in enumerate(others):
        hand, half = DrawnHand.of(grasp, view), 0.5 * grasp.width_m
        line = hand.place(np.array([[0.0, -half], [0.0, half]]))
        ranks = f"rank {others[0].rank}" if len(others) == 1 else f"ranks {others[0].rank} to {others[-1].rank}"
        axes.plot(line[:, 0], line[:, 1], color=GREY, lw=1.0, zorder=3, label=None if k else f"next best, {ranks}")
    if item.grasps:
        draw_hand(axes, item.grasps[0], view, plan.gripper)
    elif not item.refused:
        _draw_missed(axes, item, view)
    if item.refused and plan.robot is not None:
        draw_refused(axes, item.refused[0], view, plan.gripper, f"best grasp that {plan.robot.name} does not reach")


def _draw_missed(axes: Axes, item: ObjectPlan, view: View) -> None:
    """The last pairs of contacts that were left before there was no grasp."""
    silhouette, fingers = item.silhouette, item.trace.fingers
    left = [(stage, pairs) for stage, pairs in item.trace.survivors.items() if len(pairs)]
    if silhouette is None or fingers is None or not left:
        return
    _, pairs = left[-1]
    stage = item.rejection.stage.replace("_", " ") if item.rejection else "the next stage"
    contacts = [view.of_plane(silhouette.frame, fingers.contact[pairs[:MAX_MISSED, side]]) for side in (0, 1)]
    lines = draw_segments(axes, *contacts, colors=BLUE, linewidths=0.6, zorder=3)
    lines.set_label(f"the last pairs, refused by: {stage}")
