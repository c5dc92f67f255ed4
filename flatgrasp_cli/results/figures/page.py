"""A picture 1200 pixels wide: a title, panels, a legend of all that is drawn in them, and a caption.

Panels have a fixed size, so that it is known while drawing where there is room for words.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.legend import Legend

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.results.figures.style import CORNER_IN, DPI, NO_BREAK, TITLE_IN, TITLE_PT, entitle

WIDTH_IN = 10.0
LEFT_IN, RIGHT_IN, TOP_IN, BOTTOM_IN = 0.78, 0.2, 0.36, 0.62
"""Room around a panel for its title, ticks and labels."""
SOLID_IN = 0.25
"""That left of a panel in space and below it: its ticks and labels are inside."""
CAPTION_ROW_IN = 0.2
LABEL_IN = 1.05
"""Width of the caption's first column."""
HANDLE_IN, APART_IN = 0.45, 0.25
"""Width of what stands before the words of a legend, and between its columns."""
SMALL = 9.0
SMALL_PRINT, TITLE_PRINT = FontProperties(size=SMALL), FontProperties(size=TITLE_PT, weight="bold")
TITLE_LINES = 2
"""For which there is room; a path may be longer."""
UNIT = re.compile(r"(?<=\d) (?=(?:mm|%)(?:\W|$))")
"""The space between a number and its unit."""
LEAST_SIZE_MM = 1.0
"""Of a panel: drawings of a single point have no size of their own."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A panel's place: its left and top edge on the page, and its size, inches, with its margins."""

    left: float
    top: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Layout:
    """Where panels are; their legend has so many columns, below the panels or `beside` the last of them."""

    cells: tuple[Cell, ...]
    columns: int
    beside: bool


LAYOUTS = {
    1: Layout((Cell(0, 0, 6.9, 6.2),), columns=1, beside=True),
    2: Layout((Cell(0, 0, 5, 5), Cell(5, 0, 5, 5)), columns=3, beside=False),
    3: Layout((Cell(0, 0, 5, 4.4), Cell(5, 0, 5, 4.4), Cell(0, 4.4, 4.1, 3.6)), columns=2, beside=True),
    4: Layout(
        tuple(Cell(5 * column, 4.4 * row, 5, 4.4) for row in (0, 1) for column in (0, 1)), columns=3, beside=False
    ),
    6: Layout(
        tuple(Cell(10 / 3 * column, 3.3 * row, 10 / 3, 3.3) for row in (0, 1) for column in (0, 1, 2)),
        columns=3,
        beside=False,
    ),
}
"""By the number of panels; with three of them the page is about as high as wide."""


class Page:
    """Panels, and what is written around them; `finish` it when all is drawn.

    `left_in` and `right_in` are the inches left free beside each panel.
    """

    def __init__(self, title: str, panels: int, *, left_in: float = LEFT_IN, right_in: float = RIGHT_IN) -> None:
        self._layout, self._left_in, self._right_in = LAYOUTS[panels], left_in, right_in
        self._rows_in = TITLE_IN + max(cell.top + cell.height for cell in self._layout.cells)
        self.figure = Figure(figsize=(WIDTH_IN, self._rows_in), dpi=DPI)
        FigureCanvasAgg(self.figure)
        self._panels: list[Axes] = []
        self._solid: list[bool] = []
        self._title = title

    def panel(self, title: str, *, solid: bool = False) -> Axes:
        """The next panel, in the plane or, if `solid`, in space."""
        self._solid.append(solid)
        axes: Axes = self.figure.add_axes(self._place(len(self._panels)), projection="3d" if solid else None)
        # where it comes anyway: matplotlib would lay out all ticks to see that, a tenth of the time of a picture
        axes.set_title(title, loc="left", fontsize=10, y=1.0)
        axes.tick_params(labelsize=8)
        self._panels.append(axes)
        return axes

    def finish(self, caption: Sequence[tuple[str, str]]) -> Figure:
        """Write title, legend and caption, rows of a word and what it says, and give the page its height."""
        last, beside = self._layout.cells[-1], self._layout.beside
        left, top = (last.left + last.width, TITLE_IN + last.top + TOP_IN) if beside else (CORNER_IN[0], self._rows_in)
        legend, legend_in = self._legend(WIDTH_IN - left)
        caption_top = max(self._rows_in, top + legend_in + 0.1)
        room = WIDTH_IN - 2 * CORNER_IN[0] - LABEL_IN
        lines = [(label, in_lines(self.figure, text, room)) for label, text in caption]
        height = caption_top + 0.2 + CAPTION_ROW_IN * sum(len(wrapped) for _, wrapped in lines)
        self.figure.set_size_inches(WIDTH_IN, height)
        for k, axes in enumerate(self._panels):
            axes.set_position(self._place(k))
        title = in_lines(self.figure, self._title, WIDTH_IN - 2 * CORNER_IN[0], TITLE_PRINT)
        entitle(self.figure, "\n".join(title[:TITLE_LINES]))
        legend.set_bbox_to_anchor((left / WIDTH_IN, 1 - top / height))
        self._write_caption(lines, caption_top)
        return self.figure

    def _legend(self, width_in: float) -> tuple[Legend, float]:
        """The legend of all panels, no wider than `width_in`, not yet at its place; and its height, inches."""
        columns = self._layout.columns
        room = width_in / columns - HANDLE_IN - (APART_IN if columns > 1 else RIGHT_IN)
        entries = _legend_entries(self._panels)
        legend = self.figure.legend(
            [handle for _, handle in entries],
            ["\n".join(in_lines(self.figure, label, room)) for label, _ in entries],
            loc="upper left",
            borderaxespad=0.0,
            ncols=columns,
            fontsize=SMALL,
            frameon=False,
        )
        return legend, legend.get_window_extent().height / DPI if entries else 0.0

    def _place(self, k: int) -> tuple[float, float, float, float]:
        """Panel k's left, bottom, width and height as shares of the page as high as it is."""
        cell, height = self._layout.cells[k], float(self.figure.get_size_inches()[1])
        left, below = (SOLID_IN, SOLID_IN) if self._solid[k] else (self._left_in, BOTTOM_IN)
        bottom = height - TITLE_IN - cell.top - cell.height + below
        size = cell.width - left - self._right_in, cell.height - TOP_IN - below
        return (cell.left + left) / WIDTH_IN, bottom / height, size[0] / WIDTH_IN, size[1] / height

    def _write(self, left: float, top: float, text: str, **style: Any) -> None:
        """Text at a place in inches from the page's upper left corner."""
        height = float(self.figure.get_size_inches()[1])
        self.figure.text(left / WIDTH_IN, 1 - top / height, text, va="top", **style)

    def _write_caption(self, lines: list[tuple[str, list[str]]], top: float) -> None:
        for label, wrapped in lines:
            self._write(CORNER_IN[0], top, label, fontsize=SMALL, fontweight="bold")
            for line in wrapped:
                self._write(CORNER_IN[0] + LABEL_IN, top, line, fontsize=SMALL)
                top += CAPTION_ROW_IN


def in_lines(figure: Figure, text: str, width_in: float, font: FontProperties = SMALL_PRINT) -> list[str]:
    """Words of a figure in lines no longer than `width_in` inches; a word that is longer than that is cut.

    A number and its unit stay on one line.
    """
    text = UNIT.sub(NO_BREAK, text)
    line = figure.text(0.0, 0.0, "", fontproperties=font, parse_math=False)

    @cache
    def width(words: str) -> float:
        line.set_text(words)
        return float(line.get_window_extent().width)

    most, space = figure.dpi * width_in, width("x x") - width("xx")
    lines: list[list[str]] = [[]]
    used = 0.0
    for word in (part for each in text.split(" ") for part in _parts(each, most, width)):
        wide = space + width(word)
        if lines[-1] and used + wide > most:
            lines.append([])
            used = 0.0
        lines[-1].append(word)
        used += wide
    line.remove()
    return [" ".join(words) for words in lines]


def _parts(word: str, most: float, width: Callable[[str], float]) -> list[str]:
    """A word in parts no wider than `most`."""
    parts = [word]
    while len(parts[-1]) > 1 and width(parts[-1]) > most:
        rest = parts[-1]
        cut = bisect_right(range(2, len(rest)), most, key=lambda k: width(rest[:k])) + 1
        parts[-1:] = [rest[:cut], rest[cut:]]
    return parts


def _legend_entries(panels: Sequence[Axes]) -> list[tuple[str, Artist]]:
    """What is named in any of the panels, once each."""
    entries: dict[str, Artist] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    return list(entries.items())


def show(axes: Axes, points: FloatArray, margin: float) -> None:
    """Have a panel of equal scales show drawn points (n, 2), with a margin, in its whole area."""
    points = points if len(points) else np.zeros((1, 2))
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    box = axes.get_window_extent()
    middle, size = 0.5 * (low + high), np.array([box.width, box.height])
    half = 0.5 * size * max(float(((high - low) / size).max()), LEAST_SIZE_MM / float(size.max()))
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    axes.set_aspect("equal", adjustable="box")
