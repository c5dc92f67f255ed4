"""What tells where a drawing is: the frame's axes, the sensor, the robot's base."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Sensor
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.labels import Label, free_corner
from flatgrasp_cli.results.figures.style import BLACK, HALO, MM, SKY
from flatgrasp_cli.results.view import NAMES, View

TRIAD_PX = 104.0
BEHIND = 2.4
"""The order of what hides the cloud and the silhouette, but not the panel's rim."""
ARROW_PX = 42.0
"""Length of an axis that lies in the drawing."""
FORESHORTENED = 0.25
"""An axis that is drawn shorter than this share of its length is drawn as a sign: it comes out, or goes in."""
NAME_PX, ASIDE_PX, SIGN_PX = 9.0, 11.0, 14.0
"""How far names of axes are beyond their arrows' ends, beside them, and from a sign."""
ALIKE = float(np.cos(np.radians(25)))
"""Arrows closer than this to each other's direction are named beside their ends: beyond them is the other arrow."""
INSET, ARROW_SHARE, APART_SHARE = 0.03, 0.08, 0.08
"""Of a panel: how far from its edge, and how long, an arrow to something outside is, and how far apart two are."""
SHIFTS = (0, 1, -1, 2, -2, 3, -3, 4, -4)
"""By how many times that an arrow may be moved along its edge, the least first."""
MARK_POINTS = 8
IN_PIXELS: dict[str, Any] = {
    "xycoords": "axes pixels",
    "textcoords": "axes pixels",
    "zorder": 11,
    "annotation_clip": False,
}
IN_WORDS = {
    "option": "as stated",
    "projection": "the image's centre of projection",
    "viewpoint": "the viewpoint that was stated",
    "inverse_viewpoint": "the inverse of the viewpoint that was stated",
    "frame": "the origin of the cloud's own frame",
    "transforms": "by the recording's transforms",
    "visibility": "judged by the cloud's shape",
    "up": "only the way up is known",
    "assumed": "assumed: nothing says where it was",
    "all_sides": "seen from all sides",
}


def draw_triad(axes: Axes, view: View, frame_id: str, drawn: FloatArray) -> FloatArray:
    """The frame's axes in the corner where they hide the least of `drawn` (m, 2); points (n, 2) of what they take."""
    corner, _ = free_corner(axes, drawn, TRIAD_PX)
    size = np.array(axes.get_window_extent().size)
    flat = view.frame.axes[:2].T  # a row for each axis of the frame
    signs = np.linalg.norm(flat, axis=1) < FORESHORTENED
    ends = np.where(signs[:, None], 0.0, ARROW_PX * flat)
    extent = np.vstack([ends, np.zeros(2)])
    at = np.where(corner, size - TRIAD_PX, 0.0)
    origin = at + 0.5 * TRIAD_PX - 0.5 * (extent.min(axis=0) + extent.max(axis=0))
    low, share = at / size, TRIAD_PX / size
    paper: dict[str, Any] = {"transform": axes.transAxes, "fc": "white", "ec": "none", "alpha": 0.8, "zorder": BEHIND}
    axes.add_patch(Rectangle(tuple(low), *share, **paper))
    for k, name in enumerate(NAMES):
        if signs[k]:
            _write(axes, origin, "⊙" if view.frame.axes[2, k] > 0 else "⊗", fontsize=14)
            _write(axes, origin - SIGN_PX * np.sign(ends.sum(axis=0) + 1e-9), name, fontsize=9)
        else:
            arrow = {"arrowstyle": "-|>", "color": BLACK, "lw": 1.2, "shrinkA": 6 if signs.any() else 0, "shrinkB": 0}
            axes.annotate("", origin + ends[k], origin, arrowprops=arrow, **IN_PIXELS)
            _write(axes, origin + _name_place(ends, k), name, fontsize=9)
    axes.add_line(
        Line2D([], [], color=BLACK, marker=">", ms=5, lw=1.2, label=f"x, y, z: axes of the frame {frame_id!r}")
    )
    square = np.stack(np.meshgrid(*np.linspace(at, at + TRIAD_PX, 9).T), axis=-1).reshape(-1, 2)
    return np.asarray(axes.transData.inverted().transform(square + axes.get_window_extent().min))


def _write(axes: Axes, place: FloatArray, text: str, *, fontsize: int) -> None:
    axes.annotate(text, tuple(place), tuple(place), ha="center", va="center", fontsize=fontsize, **IN_PIXELS)


def _name_place(ends: FloatArray, k: int) -> FloatArray:
    """Where the name of arrow k is, of arrows from a common origin to their `ends` (3, 2), pixels."""
    end, lengths = ends[k], np.linalg.norm(ends, axis=1)
    way = end / lengths[k]
    if ((ends @ way > ALIKE * lengths) & (lengths > lengths[k])).any():
        aside = np.array([-way[1], way[0]])
        return np.asarray(end - ASIDE_PX * (aside if aside @ ends.sum(axis=0) > 0 else -aside))
    return np.asarray(end + NAME_PX * way)


def draw_places(axes: Axes, view: View, plan: Plan, drawn: FloatArray) -> list[Label]:
    """Where the sensor was and the robot's base is, if that is known and can be drawn; with their labels.

    Where there is a choice they are kept off what is `drawn` (n, 2).
    """
    places = []
    if plan.robot is not None:
        base = view.of_world(np.zeros((1, 3)))[0]
        places.append((base, f"base of {plan.robot.name}", "robot's base, and the way to here", BLACK))
    sensor = plan.cloud.sensor
    if sensor is not None and sensor.position is not None:
        name = "camera (assumed)" if sensor.known_from == "assumed" else "camera"
        places.append((view.of_world(sensor.position[None])[0], name, "camera, and the way it looks", SKY))
    labels: list[Label] = []
    for place, name, meaning, color in places:
        labels.append(draw_place(axes, place, name, color=color, drawn=drawn))
        drawn = np.vstack([drawn, labels[-1].thing])
        axes.add_line(Line2D([], [], color=color, marker="s", ms=6, lw=2.0, label=meaning))
    return labels


def draw_place(axes: Axes, place: FloatArray, name: str, *, color: str, drawn: FloatArray) -> Label:
    """A place (2,), with an arrow to the drawing's middle; of one outside the arrow comes from that edge.

    There it is moved along the edge, as little as need be, where it would come too close to what is `drawn` (n, 2).
    """
    low, high = np.column_stack([axes.get_xlim(), axes.get_ylim()])
    middle, half, size = 0.5 * (low + high), (0.5 - INSET) * (high - low), float((high - low).max())
    away = place - middle
    share = np.abs(away / half)
    outside, along = share.max() > 1, np.eye(2)[int(np.argmin(share))]

    def mark(shift: int) -> FloatArray:
        start = middle + away / max(share.max(), 1.0) + shift * APART_SHARE * size * along
        way = middle - start
        end = start + way * min(1.0, ARROW_SHARE * size / max(float(np.linalg.norm(way)), 1e-9))
        return np.asarray(np.linspace(start, end, MARK_POINTS))

    def room(shift: int) -> float:
        points = mark(shift)
        if (np.abs(points - middle) > half + 1e-9 * size).any():
            return -1.0
        gap = np.linalg.norm(points[:, None] - drawn[None], axis=2).min(initial=np.inf)
        return min(float(gap), 0.5 * APART_SHARE * size)

    points = mark(max(SHIFTS, key=room) if outside else 0)
    arrow = {"arrowstyle": "-|>", "color": color, "lw": 2.0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", tuple(points[-1]), tuple(points[0]), arrowprops=arrow, zorder=8)
    axes.plot(*points[0], "s", color=color, ms=7, zorder=8)
    return Label(name, points, {"fontsize": 9, "color": color, "bbox": HALO})


def sensor_in_words(plan: Plan, place: FloatArray, normal: FloatArray) -> str:
    """Where the sensor was, seen from a `place` (3,) in a plane with a `normal` (3,), and how that is known."""
    sensor = plan.cloud.sensor or Sensor("assumed")
    known = IN_WORDS[sensor.known_from]
    if sensor.position is None:
        return known if sensor.sees_all_sides else f"its place is not known; it is taken to have looked down ({known})"
    away = sensor.toward(place)
    distance = float(np.linalg.norm(away))
    sine = float(away @ normal) / max(distance, 1e-9)
    steep = float(np.degrees(np.arcsin(np.clip(sine, -1.0, 1.0))))
    side = "below" if steep < 0 else "above"
    return f"{MM * distance:.0f} mm away, {abs(steep):.0f}° {side} the drawing's plane ({known})"
