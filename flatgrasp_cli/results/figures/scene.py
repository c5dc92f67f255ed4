"""A scene from above: its objects, numbered, and the best grasp of each."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from flatgrasp_cli.geometry.arrays import ByteArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import ObjectPlan, SupportPlane
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.hand import draw_fingers
from flatgrasp_cli.results.figures.style import BLACK, BLUE, GREEN, GREY, MM, ORANGE, PALE, PURPLE, RED, SKY, thinned

COLORS = (BLUE, GREEN, PURPLE, SKY, ORANGE)
MARGIN_M = 0.12


def draw_scene(axes: Axes, plan: Plan, support: SupportPlane) -> None:
    """The scene seen along the support plane's normal, with what is farther from the sensor further up."""
    frame = _from_above(plan, support)
    shown = [item.object.points for item in plan.objects] or [plan.cloud.points]
    local = frame.to_local(np.concatenate(shown))[:, :2]
    low, high = local.min(axis=0) - MARGIN_M, local.max(axis=0) + MARGIN_M
    if plan.cloud.colors is None:
        _dots(axes, frame, plan.cloud.points, PALE, (low, high))
        _dots(axes, frame, plan.scene.clutter, BLACK, (low, high))
        for k, item in enumerate(plan.objects):
            _dots(axes, frame, item.object.points, COLORS[k % len(COLORS)])
    else:
        _colored(axes, frame, plan.cloud.points, plan.cloud.colors, (low, high))
    for k, item in enumerate(plan.objects):
        _draw_object(axes, plan, item, frame, COLORS[k % len(COLORS)])
    axes.set_xlim(MM * low[0], MM * high[0])
    axes.set_ylim(MM * low[1], MM * high[1])
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel("mm")


def _draw_object(axes: Axes, plan: Plan, item: ObjectPlan, frame: Frame, color: str) -> None:
    best = bool(item.grasps) and item.grasps[0] is plan.best
    outline = item.trace.silhouette
    for loop in outline.loops if outline else ():
        closed = MM * frame.to_local(outline.frame.to_world(loop[[*range(len(loop)), 0]]))  # type: ignore[union-attr]
        axes.plot(closed[:, 0], closed[:, 1], color=BLACK, lw=0.8, zorder=3)
    if item.grasps:
        draw_fingers(axes, item.grasps[0], frame, plan.gripper, RED if best else GREY)
    seen = MM * frame.to_local(item.object.points)[:, :2]
    corner = seen[np.argmax(seen.sum(axis=1))]  # on the object: its box's may lie amid others
    axes.annotate(
        f"{item.object.id}" + ("" if item.grasps else " no grasp"),
        tuple(corner),
        xytext=(4, 4),
        textcoords="offset points",
        color=RED if best else BLACK,
        fontsize=11,
        fontweight="bold" if best else "normal",
        bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": color, "alpha": 0.85},
        zorder=9,
    )


def _dots(
    axes: Axes, frame: Frame, points: FloatArray, color: str, limits: tuple[FloatArray, FloatArray] | None = None
) -> None:
    local = frame.to_local(points)[:, :2]
    if limits is not None:
        local = local[((local > limits[0]) & (local < limits[1])).all(axis=1)]
    local = MM * thinned(local)
    axes.plot(local[:, 0], local[:, 1], ".", ms=1.5, mew=0, color=color, zorder=1)


def _colored(
    axes: Axes, frame: Frame, points: FloatArray, colors: ByteArray, limits: tuple[FloatArray, FloatArray]
) -> None:
    """The points as the camera saw them."""
    local = frame.to_local(points)[:, :2]
    shown = thinned(np.flatnonzero(((local > limits[0]) & (local < limits[1])).all(axis=1)))
    axes.scatter(MM * local[shown, 0], MM * local[shown, 1], s=2, lw=0, c=colors[shown] / 255, zorder=1)


def _from_above(plan: Plan, support: SupportPlane) -> Frame:
    """A frame in the support plane, its y axis away from the sensor."""
    middle = plan.cloud.points.mean(axis=0)
    away = np.zeros(3) if plan.cloud.sensor is None else -plan.cloud.sensor.toward(middle)
    away = away - (away @ support.normal) * support.normal
    length = float(np.linalg.norm(away))
    if length < 1e-6:
        away = np.cross(support.normal, np.eye(3)[int(np.argmin(np.abs(support.normal)))])
        length = float(np.linalg.norm(away))
    y = away / length
    origin = middle - support.heights(middle[None])[0] * support.normal
    return Frame(origin, np.stack([np.cross(y, support.normal), y, support.normal]))
