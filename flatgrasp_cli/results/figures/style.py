"""Colours, axes and files that all figures share."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import cv2
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from flatgrasp_cli.errors import FigureError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.sampling import even_sample
from flatgrasp_cli.results.view import View

Scalar = TypeVar("Scalar", bound=np.generic)
# Okabe & Ito's palette: told apart by every kind of colour vision.
BLACK, GREY, PALE = "#000000", "#7f7f7f", "#c8c8c8"
ORANGE, SKY, GREEN, BLUE, RED, PURPLE = "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"

ASLANT_DEG = 0.5
"""A hand that is tilted by less comes straight down, but for rounding."""
MM = 1e3
NO_BREAK = "\N{NO-BREAK SPACE}"
DPI = 120
PNG = (cv2.IMWRITE_PNG_COMPRESSION, 3, cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_NONE)
"""Drawings have few colours and large areas: filters, made for photographs, take time and make them larger."""
CORNER_IN, TITLE_IN, TITLE_PT = (0.2, 0.12), 0.42, 11.0
"""Where titles begin, the room above the drawings that is theirs, and their size."""
HALO = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8}
"""Behind words that may come to lie on a drawing."""
TEXT: Any = {"text.parse_math": False, "text.hinting": "no_hinting"}
"""Names are no formulae; letters are even without hints, whose programs would take a third of the time to draw."""
MAX_POINTS = 6000
"""Points drawn of a cloud: more only darken the picture."""


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, in inches, that needs no display."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def entitle(figure: Figure, title: str) -> None:
    """Write a title in the figure's upper left corner; a second one takes its place."""
    width, height = figure.get_size_inches()
    place = {"x": CORNER_IN[0] / width, "y": 1 - CORNER_IN[1] / height, "ha": "left", "va": "top"}
    figure.suptitle(title, fontsize=TITLE_PT, fontweight="bold", **place)


def as_png(draw: Callable[[], Figure | None]) -> bytes | None:
    """What `draw` draws, as PNG; None if it has nothing to draw.

    Raises
    ------
    FigureError
        If that fails: a cloud may have a shape that no axes hold.
    """
    try:
        with rc_context(TEXT), warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)  # names in any script
            figure = draw()
            return None if figure is None else _encoded(figure)
    except Exception as error:
        raise FigureError(f"the picture cannot be drawn: {type(error).__name__}: {error}") from error


def _encoded(figure: Figure) -> bytes:
    """A figure's pixels as PNG: OpenCV takes a fifth of the time of `savefig`, for a smaller file."""
    canvas: Any = figure.canvas
    canvas.draw()
    pixels = cv2.cvtColor(np.asarray(canvas.buffer_rgba()), cv2.COLOR_RGBA2BGR)
    _, content = cv2.imencode(".png", pixels, PNG)
    return content.tobytes()


def thinned(points: NDArray[Scalar]) -> NDArray[Scalar]:
    """An even sample of `points` (n, …), or of their indices, that a picture can hold."""
    return even_sample(points, MAX_POINTS)


def counted(number: int, thing: str) -> str:
    """So many of a thing, in words."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def numbered(numbers: Iterable[int]) -> str:
    """Numbers in words: "1, 2 and 5"."""
    *first, last = map(str, numbers)
    return f"{', '.join(first)} and {last}" if first else last


def in_numbers(direction: FloatArray) -> str:
    """A direction (3,) in words that stay on one line."""
    numbers = (f"{value + 0.0:.2f}" for value in np.round(direction, 2))
    return f"({f',{NO_BREAK}'.join(numbers)})".replace("-", "−")


def draw_scale(axes: Axes, colored: ScalarMappable, label: str, *, left: float, height: float = 1.0) -> None:
    """What colours stand for, beside a panel; `left` and `height` are shares of the panel's width and height."""
    place = axes.inset_axes((left, 0.0, 0.04, height))
    bar = axes.get_figure(root=True).colorbar(colored, cax=place)  # type: ignore[union-attr]
    bar.set_label(label, fontsize=9)
    place.tick_params(labelsize=8)


def closed(loop: FloatArray) -> FloatArray:
    """A loop (n, 2) with its first vertex again at its end."""
    return loop[[*range(len(loop)), 0]]


def draw_dots(axes: Axes, drawn: FloatArray, color: Any, label: str | None = None) -> None:
    """Points (n, 2) in the drawing, thinned; `color` for all or (n, 3) for each."""
    shown = thinned(np.arange(len(drawn)))
    colors = color[shown] if isinstance(color, np.ndarray) else color
    axes.scatter(drawn[shown, 0], drawn[shown, 1], s=3, lw=0, c=colors, zorder=1)
    if label is not None:  # that of a dot would not be seen
        axes.plot([], [], "o", ms=4, mew=0, color=PALE if isinstance(color, np.ndarray) else color, label=label)


def draw_segments(axes: Axes, start: FloatArray, end: FloatArray, **style: Any) -> LineCollection:
    """Segments from `start` to `end` (n, 2) in the drawing, which also count for the axes' limits."""
    lines = LineCollection(list(np.stack([start, end], axis=1)), **style)
    axes.add_collection(lines)
    axes.autoscale_view()
    return lines


def tick_labels(axes: Axes, view: View) -> None:
    """Name the axes of a drawing, and number them in the frame's coordinates where it is seen along one."""
    for k, axis in enumerate((axes.xaxis, axes.yaxis)):
        name, sign = view.label(k)
        axis.set_label_text(name, fontsize=9)
        axis.set_major_formatter(FuncFormatter(lambda value, _, sign=sign: f"{sign * value + 0.0:g}".replace("-", "−")))


def draw_dots_in_space(axes: Any, points: FloatArray, color: str, label: str) -> None:
    """Points (n, 3), metres, thinned."""
    axes.scatter(*(MM * thinned(points).T), s=2, lw=0, color=color, depthshade=False)
    axes.plot([], [], [], "o", ms=4, mew=0, color=color, label=label)
