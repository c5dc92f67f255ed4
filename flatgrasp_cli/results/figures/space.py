"""Drawings in three dimensions: a hand of boxes, axes of frames, equal scales."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.figures.hand import hand_solids
from flatgrasp_cli.results.figures.style import BLACK, GREY, HALO, MM, ORANGE

WORLD = Frame(np.zeros(3), np.eye(3))
FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
"""Corners of a box's faces, in the order of `hand.CORNERS`."""
ELEVATION_DEG = 22.0
NAME_SHARE = 0.15
"""How far an axis's name is beyond its end, of the longest axis."""
ZOOM = 0.82
"""Of a drawing in its panel: what is left is for numbers and names."""
LABEL_PAD_PT = 6.0
"""Room between an axis and its name, for the numbers."""
MOST_STEPS = 4
"""Between the numbers of an axis; half as many where it is less than half as long as the longest."""
LEAST_SHARE = 0.4
"""Of the longest side of a drawing: a shorter side leaves no room for its own numbers."""


def draw_hand_in_space(
    axes: Any, grasp: Grasp, gripper: Gripper, *, color: str, label: str, frame: Frame = WORLD
) -> FloatArray:
    """Fingers, palm and what is between it and the flange, drawn in `frame`; all corners (n, 3) in that frame."""
    boxes, back = hand_solids(grasp, gripper)
    fingers, palm = [frame.to_local(box) for box in boxes], frame.to_local(back)
    for box, fill, alpha in [*((finger, ORANGE, 0.7) for finger in fingers), (palm, "white", 0.25)]:
        faces = Poly3DCollection([MM * box[list(face)] for face in FACES], fc=fill, ec=color, lw=1.0, alpha=alpha)
        axes.add_collection3d(faces)
    approach = axes_from_quaternion(grasp.orientation)[2]
    top = palm.mean(axis=0)
    flange = top - gripper.palm_offset_m * (frame.axes @ approach)
    ends = np.stack([flange, top])
    axes.plot(*(MM * ends.T), color=color, lw=2.5, label=label)
    return np.vstack([*fingers, palm, ends])


def draw_axes_of(
    axes: Any, origin: FloatArray, directions: FloatArray, length_m: float | FloatArray, label: str
) -> FloatArray:
    """The axes, rows of `directions` (3, 3), of a frame at `origin` (3,); where their names are (3, 3).

    All are as long, or have lengths (3,) of their own.
    """
    lengths = np.broadcast_to(length_m, 3)
    tips = origin + lengths[:, None] * directions
    names = np.asarray(tips + NAME_SHARE * lengths.max() * directions)
    for tip, place, name in zip(tips, names, "xyz", strict=True):
        axes.plot(*(MM * np.stack([origin, tip]).T), color=BLACK, lw=1.4, label=label if name == "x" else None)
        axes.text(*(MM * place), name, color=BLACK, fontsize=9, ha="center", va="center", bbox=HALO)
    return names


def draw_box(axes: Any, corners: FloatArray, color: str, label: str) -> None:
    """The edges of a box with corners (8, 3), in the order of `hand.CORNERS`."""
    for k, face in enumerate(FACES):
        for a, b in pairwise((*face, face[0])):
            first = (k, a, b) == (0, FACES[0][0], FACES[0][1])
            axes.plot(*(MM * corners[[a, b]].T), color=color, lw=1.2, label=label if first else None)


def finish_space(axes: Any, drawn: FloatArray, names: tuple[str, str, str], azimuth_deg: float) -> None:
    """Equal scales around the points (n, 3), metres, few ticks, and the eye a little above."""
    low, high = MM * drawn.min(axis=0), MM * drawn.max(axis=0)
    longest = float((high - low).max())
    size = np.maximum(high - low + 0.06 * longest, LEAST_SHARE * longest)
    low, high = 0.5 * (low + high - size), 0.5 * (low + high + size)
    for axis, name, least, most in zip((axes.xaxis, axes.yaxis, axes.zaxis), names, low, high, strict=True):
        axis.set_major_locator(MaxNLocator(MOST_STEPS if most - least > 0.5 * size.max() else MOST_STEPS // 2))
        axis.set_label_text(name, fontsize=9)
        axis.labelpad = LABEL_PAD_PT
        axis.pane.set_edgecolor(GREY)
        getattr(axes, f"set_{axis.axis_name}lim")(least, most)
    axes.set_box_aspect(size / size.max(), zoom=ZOOM)
    axes.tick_params(labelsize=8, pad=1)
    axes.view_init(elev=ELEVATION_DEG, azim=azimuth_deg)
