"""The words of a figure as they come out on the page: where each is, and which of them collide."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import combinations
from typing import Any
from unittest.mock import patch

import numpy as np
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
    """Every text that drawing the figure writes: ticks, labels, legends, captions, words in space."""
    found: list[DrawnText] = []
    with _recorded(found):
        figure.canvas.draw()
    return found


def collisions(figure: Figure) -> list[str]:
    """What is wrong with a figure's words: those over others, over the page's edge, and too small to read."""
    texts, page = drawn_texts(figure), box(*figure.bbox.extents)
    wrong = [f"{text.text!r} leaves the page" for text in texts if not page.contains(text.area)]
    wrong += [f"{text.text!r} is {text.size_pt} pt" for text in texts if text.size_pt < LEAST_PT]
    for one, other in combinations(texts, 2):
        if one.area.buffer(-TOUCH_PX).intersects(other.area.buffer(-TOUCH_PX)):
            wrong.append(f"{one.text!r} is over {other.text!r}")
    return wrong


@contextmanager
def _recorded(found: list[DrawnText]) -> Iterator[None]:
    """Have every text that is drawn add itself to `found`."""
    draw = Text.draw

    def noted(self: Text, renderer: Any, *args: Any, **kwargs: Any) -> None:
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
    text.set_rotation(0.0)
    width, height = text.get_window_extent(renderer).size
    text.set_rotation(turned)
    middle, half = np.mean([extent.min, extent.max], axis=0), 0.5 * np.array([width, height])
    return rotate(box(*(middle - half), *(middle + half)), turned)
