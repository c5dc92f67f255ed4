"""The stages' figures in three dimensions: boxes, the force balance as a surface, the final grasp on the cloud."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import ObjectPlan, OrientedBox, Silhouette
from flatgrasp_cli.planner.balance import force_balance
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.close import draw_close
from flatgrasp_cli.results.figures.hand import CORNERS
from flatgrasp_cli.results.figures.page import Page
from flatgrasp_cli.results.figures.space import (
    ZOOM,
    draw_axes_of,
    draw_box,
    draw_hand_in_space,
    finish_space,
)
from flatgrasp_cli.results.figures.style import (
    BLUE,
    GREEN,
    GREY,
    MM,
    PALE,
    RED,
    draw_dots_in_space,
    draw_scale,
    in_numbers,
)
from flatgrasp_cli.results.view import view_of

PAIRS = "each pair of finger candidates"
RESULTANT = "resultant of two unit forces, 2 sin(γ/2)"
FORCES = "what is left of two unit forces along the grasping directions of i and j, with γ between them"
BALANCED = "#00224e"
"""The darkest of the colours of `cividis`."""
UPRIGHT = ("to the right (mm)", "away (mm)", "up (mm)")
AZIMUTH_DEG = -45.0
TRIAD_SHARE = 0.2
"""Length of the frame's axes, of the drawing's size."""
OUTSIDE_SHARE = 0.1
"""How far a box's axes go beyond its faces, of its longest side."""


def boxes(plan: Plan, item: ObjectPlan) -> Figure:
    """Fig. 3: the oriented and the axis-aligned bounding box."""
    box = item.box
    assert box is not None  # noqa: S101 - stages that were not reached are not drawn
    page = Page("A.1 oriented bounding box and main plane", 1)
    draw_boxes(page.panel(f"object {item.object.id}", solid=True), plan, item, box)
    size = " × ".join(f"{MM * length:.0f}" for length in box.size)
    words = f"{size} mm along its axes x (major), y (middle) and z (minor, toward the sensor)"
    return page.finish([("Box", f"{words}; x and y span the main plane")])


def draw_boxes(axes: Any, plan: Plan, item: ObjectPlan, box: OrientedBox) -> None:
    """An object's points in its oriented and its axis-aligned bounding box."""
    frame = _upright(plan, item)
    points = frame.to_local(item.object.points)
    draw_dots_in_space(axes, points, GREY, "object")
    corners = [box.frame.to_world((CORNERS - 0.5) * box.size), box.aabb[0] + CORNERS * np.ptp(box.aabb, axis=0)]
    for found, color, name in zip(corners, (RED, BLUE), ("oriented box", "axis-aligned box"), strict=True):
        draw_box(axes, frame.to_local(found), color, name)
    center = frame.to_local(box.frame.origin[None])[0]
    toward = box.frame.axes @ frame.axes.T
    lengths = 0.5 * box.size + OUTSIDE_SHARE * box.size.max()
    names = draw_axes_of(axes, center, toward, lengths, "x, y, z: axes of the oriented box")
    finish_space(axes, np.vstack([points, names, *map(frame.to_local, corners)]), UPRIGHT, AZIMUTH_DEG)


def balance_surface(_: Plan, item: ObjectPlan) -> Figure:
    """Fig. 13 (a): the force balance of all pairs as a surface."""
    height = resultant(item)
    page = Page("B.1 force balance of all pairs, as a surface", 1)
    axes: Any = page.panel(PAIRS, solid=True)
    j, i = np.meshgrid(np.arange(height.shape[1]), np.arange(height.shape[0]))
    surface = axes.plot_surface(i, j, height, cmap="cividis", vmin=0, vmax=2, rcount=120, ccount=120, linewidth=0)
    draw_scale(axes, surface, RESULTANT, left=1.04, height=0.6)
    for axis, name in (
        (axes.xaxis, "finger candidate i"),
        (axes.yaxis, "finger candidate j"),
        (axes.zaxis, "2 sin(γ/2)"),
    ):
        axis.set_label_text(name, fontsize=9)
        axis.set_major_locator(MaxNLocator(5))
    axes.set_box_aspect(None, zoom=ZOOM)
    axes.plot([], [], "s", ms=8, color=BALANCED, label="valleys: the pair is balanced")
    return page.finish([("Method", f"{FORCES}; a pair is balanced where that is little")])


def resultant(item: ObjectPlan) -> FloatArray:
    """|n_i + n_j| = 2·sin(γ/2) of every pair: 0 for the best, 2 for the worst."""
    fingers = item.trace.fingers
    return np.empty((0, 0)) if fingers is None else np.asarray(2 * np.sin(np.radians(force_balance(fingers)) / 2))


def final_on_cloud(plan: Plan, item: ObjectPlan) -> Figure:
    """Fig. 17 (b) and 18: the final grasp in the plane and on the cloud."""
    silhouette, grasp = item.silhouette, item.grasps[0]
    assert silhouette is not None  # noqa: S101 - of a grasp there is one
    view = view_of(plan, silhouette.frame.axes[2])
    page = Page("C the final grasp", 2)
    draw_close(page.panel(f"object {item.object.id} in the main plane"), plan, item, view)
    draw_on_cloud(page.panel("on the cloud", solid=True), plan, item, silhouette)
    approach = in_numbers(axes_from_quaternion(grasp.orientation)[2])
    return page.finish([("Approach", f"along {approach} in {plan.cloud.frame_name!r}")])


def draw_on_cloud(axes: Any, plan: Plan, item: ObjectPlan, silhouette: Silhouette) -> None:
    """The final grasp in space: the points under the pads, the grasping line, and the closed hand."""
    grasp, frame = item.grasps[0], _upright(plan, item)
    near = _near_pads(item, silhouette)
    points = frame.to_local(item.object.points)
    draw_dots_in_space(axes, points[~near], PALE, "object")
    draw_dots_in_space(axes, points[near], BLUE, "under the pads")
    contacts = MM * frame.to_local(grasp.contacts)
    axes.plot(*contacts.T, "o-", color=RED, lw=2, label="grasping line and contacts, in space")
    hand = draw_hand_in_space(
        axes, grasp, plan.gripper, color=GREEN, label="hand, closed: from flange to palm", frame=frame
    )
    names = _draw_frame(axes, frame, plan, np.vstack([points, hand]))
    finish_space(axes, np.vstack([points, hand, names]), UPRIGHT, AZIMUTH_DEG)


def _draw_frame(axes: object, frame: Frame, plan: Plan, drawn: FloatArray) -> FloatArray:
    """The directions of the answer's frame, in the drawing's upper left corner; where their names are (3, 3)."""
    corner, size = np.append(drawn.min(axis=0)[:2], drawn[:, 2].max()), float(np.ptp(drawn, axis=0).max())
    label = f"x, y, z: axes of the frame {plan.cloud.frame_name!r}"
    return draw_axes_of(axes, corner, frame.axes.T, TRIAD_SHARE * size, label)


def _upright(plan: Plan, item: ObjectPlan) -> Frame:
    """The frame to draw an object in, so that it stands upright."""
    support, box = item.object.support, item.box
    normal = support.normal if support is not None else box.frame.axes[2] if box is not None else -np.eye(3)[2]
    return view_of(plan, normal).upright(on_plane=support is not None)


def _near_pads(item: ObjectPlan, silhouette: Silhouette) -> BoolArray:
    """Which of the object's points lie under the two finger candidates of the final grasp."""
    fingers, grasp, points = item.trace.fingers, item.grasps[0], item.object.points
    near = np.zeros(len(points), dtype=np.bool_)
    if fingers is not None:
        projected = silhouette.frame.to_local(points)[:, :2]  # the silhouette may be that of a slice
        for k in grasp.fingers:
            away = np.linalg.norm(projected - fingers.contact[k], axis=1)
            near |= away < fingers.width[k] / 2
    return near
