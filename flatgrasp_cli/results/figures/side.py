"""A hand that comes aslant, seen from the side: the table is a line, and the hand comes from the left."""

from __future__ import annotations

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import Grasp, ObjectPlan, SupportPlane
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.hand import hand_solids
from flatgrasp_cli.results.figures.page import show
from flatgrasp_cli.results.figures.style import BLACK, GREEN, GREY, MM, ORANGE, PALE, RED, draw_dots

AROUND_M = 0.1
"""How far before and behind the hand other things are drawn, metres: those that it may meet."""
MARGIN_SHARE = 0.1


def draw_side(axes: Axes, plan: Plan, item: ObjectPlan, support: SupportPlane) -> None:
    """The best grasp of an object from the side: object, what stands around it, table, hand and the way it comes."""
    grasp = item.grasps[0]
    frame = _sideways(grasp, support)
    near = item.object.obstacles[np.abs(frame.to_local(item.object.obstacles)[:, 2]) < AROUND_M]
    draw_dots(axes, _drawn(frame, near), GREY, "what else stands there")
    points = _drawn(frame, item.object.points)
    draw_dots(axes, points, PALE, "cloud")
    fingers, palm = hand_solids(grasp, plan.gripper)
    for k, (solid, fill) in enumerate([*((finger, ORANGE) for finger in fingers), (palm, "white")]):
        outline = cv2.convexHull(_drawn(frame, solid).astype(np.float32))[:, 0]
        label = "hand, closed" if k == 0 else None
        axes.add_patch(Polygon(outline, closed=True, fc=fill, ec=RED, lw=1.2, alpha=0.8, zorder=5 - k, label=label))
    contacts = _drawn(frame, grasp.contacts)
    axes.plot(*contacts.T, "o-", color=RED, lw=1.8, ms=5, zorder=7, label="final grasp: the closing line")
    way = _drawn(frame, np.stack([grasp.pre_grasp.position, grasp.position]))
    arrow = {"arrowstyle": "-|>", "color": GREEN, "lw": 1.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", tuple(way[1]), tuple(way[0]), arrowprops=arrow, zorder=8)
    axes.plot([], [], ">-", color=GREEN, ms=5, label="the way the fingertips come")
    drawn = np.vstack([points, way, *(_drawn(frame, solid) for solid in (*fingers, palm))])
    show(axes, np.vstack([drawn, [[drawn[0, 0], 0.0]]]), MARGIN_SHARE * float(np.ptp(drawn, axis=0).max()))
    axes.axhline(0.0, color=BLACK, lw=1.2, zorder=1, label="support plane")
    axes.set_xlabel("along the hand's way, level (mm)", fontsize=9)
    axes.set_ylabel("over the support plane (mm)", fontsize=9)


def _sideways(grasp: Grasp, support: SupportPlane) -> Frame:
    """The frame to draw in: x to where the hand goes, y up, from the foot of the grasp on the plane."""
    forward = grasp.approach.direction - (grasp.approach.direction @ support.normal) * support.normal
    forward = forward / np.linalg.norm(forward)
    foot = grasp.position - float(support.heights(grasp.position[None])[0]) * support.normal
    return Frame(foot, np.stack([forward, support.normal, np.cross(forward, support.normal)]))


def _drawn(frame: Frame, points: FloatArray) -> FloatArray:
    """Where points (n, 3) are drawn, (n, 2), millimetres."""
    return np.asarray(MM * frame.to_local(points)[:, :2])
