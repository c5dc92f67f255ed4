"""A page with one drawing in an object's main plane."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import ObjectPlan
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.figures.close import draw_loops
from flatgrasp_cli.results.figures.page import Page, show
from flatgrasp_cli.results.figures.style import GREY, draw_segments, tick_labels
from flatgrasp_cli.results.view import view_of

MARGIN_MM = 20.0


class PlaneDrawing:
    """A page with one drawing of an object's silhouette in the main plane."""

    def __init__(self, plan: Plan, item: ObjectPlan, title: str, color: str = GREY) -> None:
        silhouette = item.silhouette
        assert silhouette is not None  # noqa: S101 - stages that were not reached are not drawn
        self._silhouette, self._view = silhouette, view_of(plan, silhouette.frame.axes[2])
        self._page = Page(title, 1)
        self.axes: Axes = self._page.panel(f"object {item.object.id} in its main plane")
        draw_loops(self.axes, silhouette, self._view, color)
        show(self.axes, np.concatenate([self.of(loop) for loop in silhouette.loops]), MARGIN_MM)
        tick_labels(self.axes, self._view)

    def of(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) of the main plane in the drawing."""
        return self._view.of_plane(self._silhouette.frame, points)

    def segments(self, start: FloatArray, end: FloatArray, label: str, **style: Any) -> LineCollection:
        """Segments between points (n, 2) of the main plane."""
        lines = draw_segments(self.axes, self.of(start), self.of(end), **style)
        lines.set_label(label)
        return lines

    def finish(self, words: str) -> Figure:
        """The page with its legend, and below it what the stage does, in words."""
        return self._page.finish([("Method", words)])
