"""A picture 1200 pixels wide: a title, panels, a legend of all that is drawn in them, and a caption.

Panels have a fixed size, so that it is known while drawing where there is room for words.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.results.figures.style import CORNER_IN, DPI, TITLE_IN, entitle

WIDTH_IN = 10.0
LEFT_IN, RIGHT_IN, TOP_IN, BOTTOM_IN = 0.78, 0.12, 0.36, 0.62
"""Room around a panel for its title, ticks and labels."""
LEGEND_ROW_IN, CAPTION_ROW_IN = 0.215, 0.2
LABEL_IN = 1.05
"""Width of the caption's first column."""
CAPTION_CHARACTERS = 128
SMALL = 9.0
LEAST_SIZE_MM = 1.0
"""Of a panel: drawings of a single point have no size of their own."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A panel's place: its left and top edge on the page, and its size, inches, with its margins."""

    left: float
    top: float
    width: float
    height: float


ALONE, LEFT, RIGHT, BELOW = Cell(0, 0, 6.9, 6.2), Cell(0, 0, 5, 5), Cell(5, 0, 5, 5), Cell(0, 5, 5.6, 5)
LAYOUTS = {1: (ALONE,), 2: (LEFT, RIGHT), 3: (LEFT, RIGHT, BELOW)}
"""Where so many panels are; the legend of an odd number is beside the last, of two below them."""


class Page:
    """Panels, with `right_in` inches beside each, and what is written around them; `finish` it when all is drawn."""

    def __init__(self, title: str, panels: int, *, right_in: float = RIGHT_IN) -> None:
        self._cells, self._right_in = LAYOUTS[panels], right_in
        self._rows_in = TITLE_IN + max(cell.top + cell.height for cell in self._cells)
        self.figure = Figure(figsize=(WIDTH_IN, self._rows_in), dpi=DPI)
        FigureCanvasAgg(self.figure)
        self._panels: list[Axes] = []
        self._title = title

    def panel(self, title: str, **kinds: Any) -> Axes:
        """The next panel; `kinds` as of `Figure.add_axes`."""
        axes: Axes = self.figure.add_axes(self._place(len(self._panels)), **kinds)
        axes.set_title(title, loc="left", fontsize=10)
        axes.tick_params(labelsize=8)
        self._panels.append(axes)
        return axes

    def finish(self, caption: Sequence[tuple[str, str]]) -> Figure:
        """Write title, legend and caption, rows of a word and what it says, and give the page its height."""
        entries = _legend_entries(self._panels)
        beside = len(self._cells) % 2 == 1
        columns = 1 if beside else 3
        legend_in = 0.0 if beside else 0.1 + LEGEND_ROW_IN * -(-len(entries) // columns)
        lines = [(label, textwrap.wrap(text, CAPTION_CHARACTERS) or [""]) for label, text in caption]
        caption_in = 0.2 + CAPTION_ROW_IN * sum(len(wrapped) for _, wrapped in lines)
        height = self._rows_in + legend_in + caption_in
        self.figure.set_size_inches(WIDTH_IN, height)
        for k, axes in enumerate(self._panels):
            axes.set_position(self._place(k))
        entitle(self.figure, self._title)
        last = self._cells[-1]
        left, top = (last.left + last.width, TITLE_IN + last.top + TOP_IN) if beside else (CORNER_IN[0], self._rows_in)
        self.figure.legend(
            [handle for _, handle in entries],
            [label for label, _ in entries],
            loc="upper left",
            bbox_to_anchor=(left / WIDTH_IN, 1 - top / height),
            borderaxespad=0.0,
            ncols=columns,
            fontsize=SMALL,
            frameon=False,
        )
        self._write_caption(lines, self._rows_in + legend_in)
        return self.figure

    def _place(self, k: int) -> tuple[float, float, float, float]:
        """Panel k's left, bottom, width and height as shares of the page as high as it is."""
        cell, height = self._cells[k], float(self.figure.get_size_inches()[1])
        bottom = height - TITLE_IN - cell.top - cell.height + BOTTOM_IN
        size = cell.width - LEFT_IN - self._right_in, cell.height - TOP_IN - BOTTOM_IN
        return (cell.left + LEFT_IN) / WIDTH_IN, bottom / height, size[0] / WIDTH_IN, size[1] / height

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
