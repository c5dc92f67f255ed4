"""Colours, axes and files that all figures share."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from flatgrasp_cli.errors import FigureError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.model import Silhouette

Scalar = TypeVar("Scalar", bound=np.generic)
# Okabe & Ito's palette: told apart by every kind of colour vision.
BLACK, GREY, PALE = "#000000", "#7f7f7f", "#c8c8c8"
ORANGE, SKY, GREEN, BLUE, RED, PURPLE = "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"

MM = 1e3
MAX_POINTS = 6000
"""Points drawn of a cloud: more only darken the picture."""


def new_figure(width: float = 8.0, height: float = 6.0) -> Figure:
    """An empty figure, in inches, that needs no display."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def as_png(draw: Callable[[], Figure | None]) -> bytes | None:
    """What `draw` draws, as PNG; None if it has nothing to draw.

    Raises
    ------
    FigureError
        If that fails: a cloud may have a shape that no axes hold.
    """
    content = io.BytesIO()
    try:
        with rc_context({"text.parse_math": False}), warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)  # names in any script
            figure = draw()
            if figure is None:
                return None
            figure.savefig(content, format="png", dpi=120)
    except Exception as error:
        raise FigureError(f"the picture cannot be drawn: {type(error).__name__}: {error}") from error
    return content.getvalue()


def plane_axes(figure: Figure, title: str, position: Any = 111) -> Axes:
    """Axes of the main plane in millimetres."""
    axes: Axes = figure.add_subplot(position)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("u (mm)")
    axes.set_ylabel("v (mm)")
    axes.set_title(title, loc="left", fontsize=11)
    axes.margins(0.08)
    return axes


def thinned(points: NDArray[Scalar]) -> NDArray[Scalar]:
    """An even sample of `points` (n, …), or of their indices, that a picture can hold."""
    return points[spread_indices(len(points), MAX_POINTS)]


def draw_points(axes: Axes, outline: Silhouette) -> None:
    """The projected cloud, pale."""
    points = MM * thinned(outline.points)
    axes.plot(points[:, 0], points[:, 1], ".", ms=1.5, mew=0, color=PALE, zorder=1, label="cloud")


def draw_outline(axes: Axes, outline: Silhouette, color: str = BLACK, **style: Any) -> None:
    """The loops of the concave hull."""
    for k, loop in enumerate(outline.loops):
        closed = MM * loop[[*range(len(loop)), 0]]
        axes.plot(
            closed[:, 0], closed[:, 1], color=color, lw=1.2, zorder=2, label="outline" if k == 0 else None, **style
        )


def draw_segments(axes: Axes, start: FloatArray, end: FloatArray, **style: Any) -> LineCollection:
    """Segments from `start` to `end` (n, 2), which also count for the axes' limits."""
    lines = LineCollection([(MM * a, MM * b) for a, b in zip(start, end, strict=True)], **style)
    axes.add_collection(lines)
    axes.autoscale_view()
    return lines


def legend(axes: Axes) -> None:
    """A legend outside the drawing."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=8, frameon=False)
