"""The hand, seen along its approach and in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.path import Path

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.figures.style import GREEN, GREY, HALO, MM, ORANGE, RED
from flatgrasp_cli.results.hand_boxes import PALM_THICKNESS_M, finger_boxes
from flatgrasp_cli.results.view import View

AXIS_M, NAME_M = 0.012, 0.018
"""Length of the hand's axes, drawn beyond its rim where they hide nothing, and where their names are."""
WEDGE = np.array([[0.0, 0.0], [1.0, 0.5], [1.0, -0.5], [0.0, 0.0]])
"""A contact's mark: its tip on the contact, the rest outside of the object, so that it hides no narrow one."""
WEDGE_PT = 18.0
"""Twice the length of a contact's mark."""
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])


@dataclass(frozen=True, slots=True, eq=False)
class DrawnHand:
    """A grasp's hand in a drawing: its `origin` and its `x` and `y` axes (2,), millimetres for one."""

    origin: FloatArray
    x: FloatArray
    y: FloatArray

    @classmethod
    def of(cls, grasp: Grasp, view: View) -> DrawnHand:
        """The hand of a grasp."""
        hand_x, hand_y, _ = axes_from_quaternion(grasp.orientation)
        return cls(view.of_world(grasp.position[None])[0], view.of_direction(hand_x), view.of_direction(hand_y))

    def place(self, corners: FloatArray) -> FloatArray:
        """Points (n, 2) of the hand's x-y plane, metres, in the drawing."""
        return np.asarray(self.origin + MM * (corners[:, :1] * self.x + corners[:, 1:] * self.y))


def hand_solids(grasp: Grasp, gripper: Gripper) -> tuple[list[FloatArray], FloatArray]:
    """The corners (8, 3) of each closed finger's box, and of the palm's, in the answer's frame."""
    axes = axes_from_quaternion(grasp.orientation)
    length = gripper.finger_length_at_m(grasp.width_m)

    def box(x0: float, x1: float, y0: float, y1: float, z0: float, z1: float) -> FloatArray:
        low, high = np.array([x0, y0, z0]), np.array([x1, y1, z1])
        return np.asarray(grasp.position + (low + CORNERS * (high - low)) @ axes)

    x, y = gripper.hand_width_m / 2, gripper.palm_m / 2
    fingers = [box(*sides, -length, 0.0) for sides in finger_boxes(gripper, grasp.width_m)]
    return fingers, box(-x, x, -y, y, -length - PALM_THICKNESS_M, -length)


def hand_extent(grasp: Grasp, view: View, gripper: Gripper) -> FloatArray:
    """Points (n, 2) along what is drawn of a hand: fingers, palm, closing line and axes."""
    x, y = gripper.hand_width_m / 2, gripper.palm_m / 2
    rectangles = [*finger_boxes(gripper, grasp.opening_m), (-x, x, -y, y)]
    corners = np.array([_corners(*sides) for sides in rectangles])
    along = np.linspace(0.0, 1.0, 9)[:, None]
    edges = [a + along * (b - a) for box in corners for a, b in zip(box, np.roll(box, -1, axis=0), strict=True)]
    line = np.column_stack([np.zeros(9), (along[:, 0] - 0.5) * grasp.opening_m])
    arrows = [start + along * (name - start) for start, name, _ in _axes_beyond(grasp, gripper)]
    return DrawnHand.of(grasp, view).place(np.vstack([*edges, line, *arrows]))


def _axes_beyond(grasp: Grasp, gripper: Gripper) -> list[tuple[FloatArray, FloatArray, str]]:
    """Start and the name's place (1, 2) of each axis of the hand's x-y plane, beyond its rim, with its name."""
    rims = (gripper.hand_width_m / 2, max(gripper.palm_m, grasp.opening_m + 2 * gripper.finger_thickness_m) / 2)
    ways = ((np.array([[1.0, 0.0]]), "x"), (np.array([[0.0, 1.0]]), "y"))
    return [(rim * way, (rim + NAME_M) * way, name) for rim, (way, name) in zip(rims, ways, strict=True)]


def _corners(x0: float, x1: float, y0: float, y1: float) -> FloatArray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _rectangle(axes: Axes, hand: DrawnHand, *sides: float, **style: Any) -> None:
    axes.add_patch(Polygon(hand.place(_corners(*sides)), closed=True, **style))


def draw_fingers(
    axes: Axes, grasp: Grasp, view: View, gripper: Gripper, *, color: str, label: str | None = None
) -> None:
    """Fingers at the opening to approach with, the palm and the closing axis."""
    hand = DrawnHand.of(grasp, view)
    for k, sides in enumerate(finger_boxes(gripper, grasp.opening_m)):
        named = "fingers, as open as they come" if k == 0 else None
        _rectangle(axes, hand, *sides, fc=ORANGE, ec=color, lw=1.3, zorder=5, label=named)
    palm_x, palm_y = gripper.hand_width_m / 2, gripper.palm_m / 2
    style = {"fc": "none", "ec": color, "ls": "--", "lw": 0.9, "zorder": 4, "label": "palm, above them"}
    _rectangle(axes, hand, -palm_x, palm_x, -palm_y, palm_y, **style)
    line = hand.place(np.array([[0.0, -grasp.opening_m / 2], [0.0, grasp.opening_m / 2]]))
    axes.plot(line[:, 0], line[:, 1], color=color, lw=1.8, zorder=6, label=label)


def draw_refused(axes: Axes, grasp: Grasp, view: View, gripper: Gripper, label: str) -> None:
    """The hand of a grasp that the robot cannot carry out: hollow, grey, and crossed out."""
    hand = DrawnHand.of(grasp, view)
    for sides in finger_boxes(gripper, grasp.opening_m):
        _rectangle(axes, hand, *sides, fc="none", ec=GREY, ls=":", lw=1.5, zorder=5)
    half = 0.5 * grasp.opening_m
    line = hand.place(np.array([[0.0, -half], [0.0, half]]))
    axes.plot(line[:, 0], line[:, 1], ":", color=GREY, lw=1.8, zorder=6)
    axes.plot(*hand.origin, "x", color=GREY, ms=12, mew=2.5, zorder=7)
    axes.plot([], [], ":x", color=GREY, lw=1.8, ms=8, mew=2, label=label)


def draw_hand(axes: Axes, grasp: Grasp, view: View, gripper: Gripper) -> None:
    """The best grasp's hand, with the fingers' way to the object, the contacts and the hand's axes."""
    draw_fingers(axes, grasp, view, gripper, color=RED, label="final grasp: the closing line")
    hand = DrawnHand.of(grasp, view)
    for k, (x0, x1, y0, y1) in enumerate(finger_boxes(gripper, grasp.opening_m)):
        near = np.sign(y0 + y1) * grasp.width_m / 2
        way = (x0, x1, min(near, y0, y1, key=abs), max(y0, y1, key=abs))
        label = "the way the fingers close" if k == 0 else None
        _rectangle(axes, hand, *way, fc=ORANGE, alpha=0.25, ec="none", zorder=3, label=label)
    _draw_contacts(axes, view.of_world(grasp.contacts))
    for start, end, name in _axes_beyond(grasp, gripper):
        root, place = hand.place(start)[0], hand.place(end)[0]
        tip = root + AXIS_M / NAME_M * (place - root)
        arrow = {"arrowstyle": "-|>", "color": GREEN, "lw": 1.5, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", tuple(tip), tuple(root), arrowprops=arrow, zorder=8)
        words: dict[str, Any] = {"color": GREEN, "ha": "center", "va": "center", "fontsize": 9, "bbox": HALO}
        axes.text(float(place[0]), float(place[1]), name, zorder=8, **words)
    axes.plot([], [], ">-", color=GREEN, ms=5, label="axes of the hand: it closes along y")


def _draw_contacts(axes: Axes, contacts: FloatArray) -> None:
    """Wedges that point at the contacts (2, 2) from outside of the object."""
    for place, other in zip(contacts, contacts[::-1], strict=True):
        way = place - other
        length = float(np.linalg.norm(way))
        x, y = way / length if length > 0 else (0.0, 1.0)  # seen along the closing axis they are one
        marker = Path(WEDGE @ np.array([[x, y], [-y, x]]))
        axes.plot(*place, marker=marker, ms=WEDGE_PT, color=RED, mec="white", ls="none", zorder=8)
    axes.plot([], [], "^", ms=8, color=RED, mec="white", label="contacts")
