"""The hand, seen along its approach."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.figures.style import GREEN, MM, ORANGE, RED

AXIS_MM = 12.0


def hand_in_plane(grasp: Grasp, frame: Frame) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The hand's origin and its x and y axes (2,) in the main plane's coordinates."""
    hand_x, hand_y, _ = axes_from_quaternion(grasp.orientation)
    origin = frame.to_local(grasp.position[None])[0, :2]
    return origin, frame.axes[:2] @ hand_x, frame.axes[:2] @ hand_y


def finger_boxes(gripper: Gripper, opening_m: float) -> list[tuple[float, float, float, float]]:
    """Each finger as (x_min, x_max, y_min, y_max) in the hand's frame, metres."""
    half, inner, outer = gripper.finger_width_m / 2, opening_m / 2, opening_m / 2 + gripper.finger_thickness_m
    minus = [(offset - half, offset + half, -outer, -inner) for offset in gripper.jaws[0]]
    plus = [(offset - half, offset + half, inner, outer) for offset in gripper.jaws[1]]
    return minus + plus


def _placed(corners: FloatArray, hand: tuple[FloatArray, FloatArray, FloatArray]) -> FloatArray:
    """Corners (n, 2) of the hand's x-y plane in the drawing's millimetres."""
    origin, hand_x, hand_y = hand
    return np.asarray(MM * (origin + corners[:, :1] * hand_x + corners[:, 1:] * hand_y))


def _rectangle(axes: Axes, hand: tuple[FloatArray, FloatArray, FloatArray], *sides: float, **style: Any) -> None:
    x0, x1, y0, y1 = sides
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    axes.add_patch(Polygon(_placed(corners, hand), closed=True, **style))


def draw_fingers(
    axes: Axes, grasp: Grasp, frame: Frame, gripper: Gripper, color: str, label: str | None = None
) -> None:
    """Fingers at the opening to approach with, the palm and the closing axis, in a view of several hands."""
    hand = hand_in_plane(grasp, frame)
    for sides in finger_boxes(gripper, grasp.opening_m):
        _rectangle(axes, hand, *sides, fc=ORANGE, ec=color, lw=1.3, zorder=5)
    palm_x, palm_y = gripper.hand_width_m / 2, gripper.palm_m / 2
    _rectangle(axes, hand, -palm_x, palm_x, -palm_y, palm_y, fc="none", ec=color, ls="--", lw=0.8, zorder=4)
    line = _placed(np.array([[0.0, -grasp.opening_m / 2], [0.0, grasp.opening_m / 2]]), hand)
    axes.plot(line[:, 0], line[:, 1], color=color, lw=1.8, zorder=6, label=label)


def draw_hand(axes: Axes, grasp: Grasp, frame: Frame, gripper: Gripper) -> None:
    """The same, with the fingers' way to the object, the contacts and the hand's axes."""
    draw_fingers(axes, grasp, frame, gripper, RED, "final grasp")
    hand = origin, hand_x, hand_y = hand_in_plane(grasp, frame)
    for x0, x1, y0, y1 in finger_boxes(gripper, grasp.opening_m):
        near = np.sign(y0 + y1) * grasp.width_m / 2
        way = (x0, x1, min(near, y0, y1, key=abs), max(y0, y1, key=abs))
        _rectangle(axes, hand, *way, fc=ORANGE, alpha=0.25, ec="none", zorder=3)
    contacts = MM * frame.to_local(grasp.contacts)[:, :2]
    axes.plot(contacts[:, 0], contacts[:, 1], "o", color=RED, ms=6, mec="white", zorder=7, label="contacts")
    axes.plot([], [], "s", color=ORANGE, mec=RED, ms=4, label="fingers, open")
    axes.plot([], [], "--", color=RED, lw=0.8, label="palm")
    u, v = MM * origin
    for axis, name in ((hand_x, "x"), (hand_y, "y")):
        du, dv = AXIS_MM * axis
        arrow = {"arrowstyle": "-|>", "color": GREEN}
        axes.annotate("", (u + du, v + dv), (u, v), arrowprops=arrow, zorder=8)
        axes.text(u + 1.25 * du, v + 1.25 * dv, name, color=GREEN, ha="center", va="center", fontsize=9, zorder=8)
