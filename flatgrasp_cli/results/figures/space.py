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
from flatgrasp_cli.results.figures.style import BLACK, GREY, MM, ORANGE

WORLD = Frame(np.zeros(3), np.eye(3))
FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
"""Corners of a box's faces, in the order of `hand.CORNERS`."""
ELEVATION_DEG = 22.0


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


def draw_axes_of(axes: Any, origin: FloatArray, directions: FloatArray, length_m: float, label: str) -> None:
    """The axes, rows of `directions` (3, 3), of a frame at `origin` (3,), with their names."""
    for k, (direction, name) in enumerate(zip(directions, "xyz", strict=True)):
        ends = MM * np.stack([origin, origin + length_m * direction])
        axes.plot(*ends.T, color=BLACK, lw=1.4, label=None if k else label)
        axes.text(
            *(MM * (origin + 1.15 * length_m * direction)), name, color=BLACK, fontsize=9, ha="center", va="center"
        )


def draw_box(axes: Any, corners: FloatArray, color: str, label: str) -> None:
    """The edges of a box with corners (8, 3), in the order of `hand.CORNERS`."""
    for k, face in enumerate(FACES):
        for a, b in pairwise((*face, face[0])):
            first = (k, a, b) == (0, FACES[0][0], FACES[0][1])
            axes.plot(*(MM * corners[[a, b]].T), color=color, lw=1.2, label=label if first else None)


def finish_space(axes: Any, drawn: FloatArray, names: tuple[str, str, str], azimuth_deg: float) -> None:
    """Equal scales around the points (n, 3), metres, few ticks, and the eye a little above."""
    low, high = MM * drawn.min(axis=0), MM * drawn.max(axis=0)
    pad = 0.03 * float((high - low).max())
    size = high - low + 2 * pad
    for axis, name, least, most in zip((axes.xaxis, axes.yaxis, axes.zaxis), names, low - pad, high + pad, strict=True):
        axis.set_major_locator(MaxNLocator(4))
        axis.set_label_text(name, fontsize=9)
        axis.pane.set_edgecolor(GREY)
        getattr(axes, f"set_{axis.axis_name}lim")(least, most)
    axes.set_box_aspect(size / size.max(), zoom=0.88)
    axes.tick_params(labelsize=7, pad=0)
    axes.view_init(elev=ELEVATION_DEG, azim=azimuth_deg)
