"""Words in a drawing, where they hide nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.sampling import even_sample
from flatgrasp_cli.results.figures.style import GREY

DIRECTIONS = np.column_stack([f(2 * np.pi * np.arange(16) / 16) for f in (np.cos, np.sin)])
DISTANCES_PX = (4.0, 12.0, 24.0, 40.0, 64.0, 100.0, 150.0)
FAR_PX = 10.0
"""A label farther from its thing than this has a line to it."""
LEADER_POINTS = 24
MOST_POINTS = 500
"""Of a thing that its label's place is measured from."""
PADDING_PX = 6.0
"""Room that a label needs around its letters: for its frame, and for some paper around that."""
OVER_LABEL, OUTSIDE = 1e3, 1e6
"""Costs, where covering a drawn point costs 1, and a pixel of distance as much as `PER_PX`."""
PER_PX = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """A `text` for a thing that is drawn at points (n, 2)."""

    text: str
    thing: FloatArray
    style: dict[str, Any] = field(default_factory=dict)


def put(axes: Axes, labels: Sequence[Label], drawn: FloatArray) -> None:
    """Write each label beside its thing, where it covers the least of the points `drawn` (m, 2), and no other label.

    The axes' limits must be those of the finished drawing.
    """
    page = _Page(axes.get_window_extent().get_points(), axes.transData.transform(drawn), [])
    for label in labels:
        thing = axes.transData.transform(even_sample(label.thing, MOST_POINTS))
        style: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 10} | label.style
        text = axes.text(0.0, 0.0, label.text, **style)
        half = 0.5 * np.array(text.get_window_extent().size) + PADDING_PX
        spot, leader = _best_spot(thing, half, page)
        page.taken.append(np.stack([spot - half, spot + half]))
        to_data = axes.transData.inverted().transform
        text.set_position(tuple(to_data(spot)))
        if _length(leader) > FAR_PX:
            page.busy = np.vstack([page.busy, leader])
            axes.plot(*to_data(leader).T, color=GREY, lw=0.7, zorder=9)


@dataclass(slots=True, eq=False)
class _Page:
    """The corners (2, 2) of where labels may be, points (m, 2) that are not to be covered, and labels' boxes (2, 2)."""

    area: FloatArray
    busy: FloatArray
    taken: list[FloatArray]


def _best_spot(thing: FloatArray, half: FloatArray, page: _Page) -> tuple[FloatArray, FloatArray]:
    """The middle (2,) of a label of half a size (2,), and points (k, 2) of the line from its edge to its thing."""
    best = (np.inf, thing[0], thing[:1])
    for distance in DISTANCES_PX:
        if best[0] <= PER_PX * distance:  # from here on the distance alone costs more
            break
        for spot in _spots(thing, half, distance):
            leader = _leader(thing, spot, half)
            cost = _cost(spot, half, page.busy, page.area) + PER_PX * _length(leader)
            cost += OVER_LABEL * _covered(page.taken, spot, half, leader)
            if cost < best[0]:
                best = (cost, spot, leader)
    return best[1:]


def _length(line: FloatArray) -> float:
    return float(np.linalg.norm(line[0] - line[-1]))


def _leader(thing: FloatArray, spot: FloatArray, half: FloatArray) -> FloatArray:
    """Points (k, 2) along the shortest line from the edge of a label of half a size (2,) to its thing."""
    edge = np.clip(thing, spot - half, spot + half)
    nearest = np.argmin(np.linalg.norm(thing - edge, axis=1))
    return np.linspace(edge[nearest], thing[nearest], LEADER_POINTS)


def _spots(thing: FloatArray, half: FloatArray, distance: float) -> FloatArray:
    """Places (k, 2) all around a thing for the middle of a label of half a size (2,)."""
    middle = 0.5 * (thing.min(axis=0) + thing.max(axis=0))
    reach = ((thing - middle) @ DIRECTIONS.T).max(axis=0) + np.abs(DIRECTIONS) @ half
    return np.asarray(middle + (reach + distance)[:, None] * DIRECTIONS)


def _cost(spot: FloatArray, half: FloatArray, busy: FloatArray, area: FloatArray) -> float:
    """What a label at a spot costs for what it covers, and for leaving the drawing."""
    low, high = spot - half, spot + half
    outside = bool((low < area[0]).any() or (high > area[1]).any())
    return int(((busy > low) & (busy < high)).all(axis=1).sum()) + OUTSIDE * outside


def _covered(taken: list[FloatArray], spot: FloatArray, half: FloatArray, leader: FloatArray) -> int:
    """How many labels, boxes (2, 2), one at a spot or its leader (k, 2) would cover."""
    low, high = spot - half, spot + half
    over = [(low < box[1]).all() and (high > box[0]).all() for box in taken]
    crossed = [((leader > box[0]) & (leader < box[1])).all(axis=1).any() for box in taken]
    return sum(bool(a or b) for a, b in zip(over, crossed, strict=True))


def free_corner(axes: Axes, drawn: FloatArray, size_px: float) -> tuple[tuple[int, int], int]:
    """The corner in which a square covers the least of the points `drawn` (m, 2), and how many of them it covers.

    Corners are (0 or 1, 0 or 1) from the lower left.
    """
    low, high = axes.get_window_extent().get_points()
    busy = axes.transData.transform(drawn)

    def covered(corner: tuple[int, int]) -> int:
        at = np.where(corner, high - size_px, low)
        return int(((busy > at) & (busy < at + size_px)).all(axis=1).sum())

    best = min(((0, 0), (1, 0), (0, 1), (1, 1)), key=covered)
    return best, covered(best)
