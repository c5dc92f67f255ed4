"""The words of a figure as they come out on the page: where each is, and which of them collide."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any
from unittest.mock import patch

import numpy as np
import shapely
from matplotlib.figure import Figure
from matplotlib.text import Text
from shapely import Polygon
from shapely.affinity import rotate
from shapely.geometry import box

TOUCH_PX = 1.0
"""Words that share less than this much of their boxes' edges do not collide: letters do not fill their boxes."""
LEAST_PT = 7.0


@dataclass(frozen=True, slots=True, eq=False)
class DrawnText:
    """A text that was drawn, the area that it takes on the page in pixels, turned as it is, and its size in points."""

    text: str
    area: Polygon
    size_pt: float


def drawn_texts(figure: Figure) -> list[DrawnText]:
    """Every text that drawing the figure writes: ticks, labels, legends, captions, words in space.

    All is placed as for the picture, but no pixel is coloured: that would take most of the time.
    """
    found: list[DrawnText] = []
    with _recorded(found):
        figure.draw_without_rendering()
    return found


def collisions(figure: Figure, texts: list[DrawnText]) -> list[str]:
    """What is wrong with a figure's words: those over others, over the page's edge, and too small to read."""
    page = box(*figure.bbox.extents)
    wrong = [f"{text.text!r} leaves the page" for text in texts if not page.contains(text.area)]
    wrong += [f"{text.text!r} is {text.size_pt} pt" for text in texts if text.size_pt < LEAST_PT]
    areas = shapely.buffer([text.area for text in texts], -TOUCH_PX)
    pairs = shapely.STRtree(areas).query(areas, predicate="intersects").T
    wrong += [f"{texts[i].text!r} is over {texts[j].text!r}" for i, j in sorted(pairs.tolist()) if i < j]
    return wrong


@contextmanager
def _recorded(found: list[DrawnText]) -> Iterator[None]:
    """Have every text that is drawn add itself to `found`."""
    draw = Text.draw

    def noted(self: Text, renderer: Any, *args: Any, **kwargs: Any) -> None:
        if (
            self.get_bbox_patch() is not None
        ):  # drawing puts it around the words; else there is nothing but pixels to do
            draw(self, renderer, *args, **kwargs)
        if self.get_visible() and self.get_text().strip():
            found.append(DrawnText(self.get_text(), _area(self, renderer), float(self.get_fontsize())))

    with patch.object(Text, "draw", noted):
        yield


def _area(text: Text, renderer: Any) -> Polygon:
    """The text's rectangle, turned with it, or that of the box around it."""
    extent, turned = text.get_window_extent(renderer), text.get_rotation()
    frame = text.get_bbox_patch()
    if frame is not None:
        return box(*frame.get_window_extent(renderer).extents)
    if not turned:
        return box(*extent.extents)
    text.set_rotation(0.0)
    width, height = text.get_window_extent(renderer).size
    text.set_rotation(turned)
    middle, half = np.mean([extent.min, extent.max], axis=0), 0.5 * np.array([width, height])
    return rotate(box(*(middle - half), *(middle + half)), turned)
