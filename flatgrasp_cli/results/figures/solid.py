"""The stages' figures in three dimensions: boxes, the force balance as a surface, the final grasp on the cloud."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import ObjectPlan, Silhouette
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.hand import draw_hand
from flatgrasp_cli.results.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PALE,
    PURPLE,
    RED,
    draw_outline,
    new_figure,
    plane_axes,
    thinned,
)


def boxes(plan: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 3: the oriented and the axis-aligned bounding box."""
    box = item.trace.box
    if box is None:
        return None
    figure = new_figure()
    axes = figure.add_subplot(projection="3d")
    points = thinned(plan.cloud.points)
    axes.scatter(*points.T, s=1, color=GREY, depthshade=False)
    unit = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
    _draw_box(axes, box.frame.to_world((unit - 0.5) * box.size), RED, "oriented box")
    _draw_box(axes, box.aabb[0] + unit * np.ptp(box.aabb, axis=0), BLUE, "axis-aligned box")
    for axis, color, name in zip(box.frame.axes, (ORANGE, GREEN, PURPLE), "xyz", strict=True):
        axes.quiver(*box.frame.origin, *(0.4 * box.size.max() * axis), color=color, label=f"{name} axis")
    _finish_3d(axes, "A.1 oriented bounding box and main plane")
    return figure


def _draw_box(axes: object, corners: FloatArray, color: str, name: str) -> None:
    for a in range(8):
        for bit in (1, 2, 4):
            if not a & bit:
                ends = corners[[a, a | bit]]
                axes.plot(*ends.T, color=color, lw=1.2, label=name if (a, bit) == (0, 1) else None)  # type: ignore[attr-defined]


def balance_surface(_: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 13 (a): the same as a surface."""
    height = resultant(item)
    if height is None:
        return None
    figure = new_figure()
    axes = figure.add_subplot(projection="3d")
    j, i = np.meshgrid(np.arange(height.shape[1]), np.arange(height.shape[0]))
    axes.plot_surface(i, j, height, cmap="cividis", vmin=0, vmax=2, rcount=120, ccount=120, linewidth=0)
    axes.set(xlabel="candidate i", ylabel="candidate j", zlabel="2 sin(γ/2)")
    axes.set_title("B.1 force balance", loc="left", fontsize=11)
    return figure


def resultant(item: ObjectPlan) -> FloatArray | None:
    """|n_i + n_j| = 2·sin(γ/2) of every pair: 0 for the best, 2 for the worst; None without a pair."""
    gamma = item.trace.force_balance_deg
    return None if gamma is None or gamma.size == 0 else 2 * np.sin(np.radians(gamma) / 2)


def final_on_cloud(plan: Plan, item: ObjectPlan) -> Figure | None:
    """Fig. 17 (b) and 18: the final grasp in the plane and on the cloud."""
    outline = item.trace.silhouette
    if outline is None or not item.grasps:
        return None
    figure = new_figure(12.0, 5.5)
    axes = plane_axes(figure, "the final grasp", 121)
    draw_outline(axes, outline)
    draw_hand(axes, item.grasps[0], outline.frame, plan.gripper)
    solid = figure.add_subplot(122, projection="3d")
    points, near = _near_pads(item, outline)
    solid.scatter(*thinned(points[~near]).T, s=1, color=PALE, depthshade=False)
    solid.scatter(*thinned(points[near]).T, s=3, color=BLUE, depthshade=False, label="under the pads")
    grasp = item.grasps[0]
    solid.plot(*grasp.contacts.T, "o-", color=RED, lw=2, label="grasping line")
    frame = Frame(grasp.position, outline.frame.axes)
    approach = frame.to_world(np.array([[0.0, 0.0, 0.06], [0.0, 0.0, 0.0]]))
    solid.plot(*approach.T, color=GREEN, lw=2, label="approach")
    solid.scatter(*approach[1], color=BLACK, s=12)
    _finish_3d(solid, "on the cloud")
    return figure


def _near_pads(item: ObjectPlan, outline: Silhouette) -> tuple[FloatArray, BoolArray]:
    """The object's points, and which of them lie under the two finger candidates of the final grasp."""
    fingers, grasp, points = item.trace.fingers, item.grasps[0], item.object.points
    near = np.zeros(len(points), dtype=np.bool_)
    if fingers is not None:
        projected = outline.frame.to_local(points)[:, :2]  # the outline may be that of a slice
        for k in grasp.fingers:
            away = np.linalg.norm(projected - fingers.contact[k], axis=1)
            near |= away < fingers.width[k] / 2
    return points, near


def _finish_3d(axes: object, title: str) -> None:
    axes.set_title(title, loc="left", fontsize=11)  # type: ignore[attr-defined]
    axes.set(xlabel="x (m)", ylabel="y (m)", zlabel="z (m)")  # type: ignore[attr-defined]
    axes.set_aspect("equal")  # type: ignore[attr-defined]
    axes.tick_params(labelsize=7)  # type: ignore[attr-defined]
    axes.legend(fontsize=8, frameon=False)  # type: ignore[attr-defined]
