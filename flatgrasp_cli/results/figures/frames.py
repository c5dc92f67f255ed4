"""Which frames the poses of a grasp are, and how far apart they lie: a hand from the side and from its flange.

Both panels have the closing axis y to the right, millimetres from the fingertips' frame. Colours of axes are those of
robotics: x red, y green, z blue.
"""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.figures.style import BLACK, BLUE, GREEN, GREY, MM, ORANGE, PALE, RED, new_figure
from flatgrasp_cli.results.hand_boxes import finger_boxes

AXIS_MM = 33.0
"""Length of the arrows that stand for a frame's axes."""
OBJECT_MM, OBJECT_LENGTH_MM, TABLE_MM = 40.0, 84.0, 4.0
"""Of the object held: its height and length; and how far the table is below the fingertips."""
COLORS = {"x": RED, "y": GREEN, "z": BLUE}
OPEN: dict[str, Any] = {"fc": "none", "ec": GREY, "ls": "--"}
CLOSED: dict[str, Any] = {"fc": ORANGE, "ec": BLACK, "label": "fingers, closed to width_m"}
THING: dict[str, Any] = {"fc": "#efefef", "ec": GREY, "hatch": "//", "label": "object"}


def frames_figure(gripper: Gripper, opening_m: float, width_m: float) -> Figure:
    """The fingertips' frame and the flange's, on a gripper that came open and has closed to a width."""
    figure = new_figure(10.0, 6.0)
    side, along = figure.subplots(1, 2, width_ratios=(1.45, 1.0))
    _draw_side(side, gripper, opening_m, width_m)
    _draw_from_flange(along, gripper, opening_m, width_m)
    figure.suptitle(f"The frames of a grasp, on {gripper.name}: z approaches, y closes, x = y × z", fontsize=13)
    figure.legend(*side.get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    return figure


def _draw_side(axes: Axes, gripper: Gripper, opening_m: float, width_m: float) -> None:
    """The hand seen along x, its approach downward."""
    tool, length = MM * gripper.tool_length_m(width_m), MM * gripper.finger_length_at_m(width_m)
    short = length - MM * gripper.finger_length_at_m(opening_m)
    palm, half = MM * gripper.palm_m / 2, MM * width_m / 2
    edge = max(palm, MM * (opening_m / 2 + gripper.finger_thickness_m))
    _box(axes, (-half, half), (TABLE_MM - OBJECT_MM, TABLE_MM), **THING)
    axes.axhline(TABLE_MM, color=GREY, lw=1.5)
    axes.text(edge + 76.0, TABLE_MM + 2.0, "support plane", ha="right", va="top", fontsize=9)
    _box(axes, (-palm, palm), (-tool, -length), fc=PALE, ec=BLACK, label="hand")
    _draw_fingers(axes, gripper, opening_m, (-length, -short), OPEN | {"label": "fingers, open to opening_m"})
    _draw_fingers(axes, gripper, width_m, (-length, 0.0), CLOSED)
    _box(axes, (-0.6 * palm, 0.6 * palm), (-tool - 14.0, -tool), fc="white", ec=BLACK)
    axes.text(0.0, -tool - 7.0, "arm", ha="center", va="center", fontsize=9)
    _draw_frame(axes, (0.0, -tool), "yz")
    _draw_frame(axes, (0.0, 0.0), "yz")
    for top, end, name in ((-tool, -length, "palm_offset_m"), (-length, 0.0, "finger length\nat width_m")):
        _measure(axes, (edge + 10.0, top), (edge + 10.0, end))
        axes.text(edge + 14.0, (top + end) / 2, f"{name}\n{end - top:.0f} mm", va="center", fontsize=9)
    _name(axes, (-edge - 8.0, -tool), "flange (tool0)")
    _name(axes, (-edge - 8.0, 0.0), "pose: fingertips")
    if short > 0:
        _name(axes, (-edge - 8.0, -short - 10.0), f"open: {short:.1f} mm short\n(tip_shift_m)")
    axes.set_xlim(-edge - 92.0, edge + 78.0)
    axes.set_ylim(TABLE_MM + AXIS_MM + 10.0, -tool - 20.0)
    _finish(axes, "seen along x", "z (mm)")


def _draw_from_flange(axes: Axes, gripper: Gripper, opening_m: float, width_m: float) -> None:
    """The hand seen from the flange, along its approach."""
    half, length = MM * width_m / 2, OBJECT_LENGTH_MM / 2
    palm_x, palm_y = MM * gripper.hand_width_m / 2, MM * gripper.palm_m / 2
    _box(axes, (-half, half), (-length, length), **THING)
    _box(axes, (-palm_y, palm_y), (-palm_x, palm_x), fc="none", ec=BLACK, lw=0.8)
    _draw_fingers(axes, gripper, opening_m, None, OPEN)
    _draw_fingers(axes, gripper, width_m, None, CLOSED)
    _draw_frame(axes, (0.0, 0.0), "yx")
    axes.plot([-half, half], [0.0, 0.0], "o", color=BLACK, mec="white", ms=7, zorder=8)
    for y, name in ((-half, "contacts[0]"), (half, "contacts[1]")):
        below = (1.9 * y, -max(length, palm_x) - 6.0)
        axes.annotate(name, (y, 0.0), below, ha="center", va="top", fontsize=9, arrowprops={"arrowstyle": "-"})
    top = max(length, palm_x)
    for opening, height, name in ((width_m, top + 5.0, "width_m"), (opening_m, top + 16.0, "opening_m")):
        _measure(axes, (-MM * opening / 2, height), (MM * opening / 2, height))
        axes.text(0.0, height + 1.5, f"{name} {MM * opening:.0f} mm", ha="center", va="bottom", fontsize=9)
    axes.text(-palm_y + 2.0, palm_x - 2.0, "hand", va="top", fontsize=9)
    axes.set_xlim(-palm_y - 10.0, palm_y + 10.0)
    axes.set_ylim(-top - 18.0, top + 27.0)
    _finish(axes, "seen from the flange, along z", "x (mm)")


def _draw_fingers(
    axes: Axes, gripper: Gripper, opening_m: float, ends: tuple[float, float] | None, style: dict[str, Any]
) -> None:
    """The fingers at an opening: between `ends` along the approach, or, for None, across it."""
    for k, (x0, x1, y0, y1) in enumerate(finger_boxes(gripper, opening_m)):
        own = style if k == 0 else {key: value for key, value in style.items() if key != "label"}
        _box(axes, (MM * y0, MM * y1), (MM * x0, MM * x1) if ends is None else ends, **own)


def _box(axes: Axes, horizontal: tuple[float, float], vertical: tuple[float, float], **style: Any) -> None:
    (left, right), (low, high) = horizontal, vertical
    axes.add_patch(Rectangle((left, low), right - left, high - low, **{"lw": 1.2, **style}))


def _draw_frame(axes: Axes, origin: tuple[float, float], shown: str) -> None:
    """A frame by its axes to the right and to the other side, in that order; the third goes into the page."""
    across, upright = shown[0], shown[1]
    (into,) = set("xyz") - set(shown)
    right, ahead = (origin[0] + AXIS_MM, origin[1]), (origin[0], origin[1] + AXIS_MM)
    for name, end in ((across, right), (upright, ahead)):
        arrow = {"arrowstyle": "-|>", "color": COLORS[name], "lw": 2.5, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", end, origin, arrowprops=arrow, zorder=9)
    axes.plot(*origin, "o", color="white", mec=COLORS[into], ms=11, mew=1.8, zorder=10)
    axes.plot(*origin, "x", color=COLORS[into], ms=6, mew=1.8, zorder=11)
    for name, end, offset in ((across, right, (0, 8)), (upright, ahead, (9, 0)), (into, origin, (-10, -10))):
        bold: dict[str, Any] = {"color": COLORS[name], "weight": "bold", "ha": "center", "va": "center"}
        axes.annotate(name, end, offset, textcoords="offset points", zorder=9, **bold)


def _measure(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """A dimension line."""
    axes.annotate("", start, end, arrowprops={"arrowstyle": "<->", "color": BLACK, "shrinkA": 0, "shrinkB": 0})


def _name(axes: Axes, place: tuple[float, float], text: str) -> None:
    """What lies at that height, to the left of the hand."""
    axes.text(*place, text, ha="right", va="center", fontsize=10)
    axes.plot([place[0] + 2.0, 0.0], [place[1], place[1]], color=GREY, lw=0.8, ls=":", zorder=0)


def _finish(axes: Axes, title: str, upright: str) -> None:
    axes.set_aspect("equal")
    axes.set_title(title, loc="left", fontsize=11)
    axes.set_xlabel("y (mm)")
    axes.set_ylabel(upright)
