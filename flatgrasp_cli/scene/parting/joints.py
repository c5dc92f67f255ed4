"""Pieces that cannot be things of their own: they would fall, or they are the bottom of a hollow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.scatter import quantile
from flatgrasp_cli.kernels.borders import borders
from flatgrasp_cli.scene.cells import SMOOTH_CELLS
from flatgrasp_cli.scene.parting.view_grid import ViewGrid

MOST = 0.9
"""Share of a piece that tells what all of it does: cells at an edge also hold points of what is behind, and of a
hollow's edge a little may touch another thing, or be hidden by one."""
ODD_SHARE = 0.05
"""Share of a piece's cells beyond its lower and its upper end, which also hold points of what is behind it."""


@dataclass(frozen=True, slots=True, eq=False)
class _Borders:
    """Where pieces meet, in steps from a cell to one beside it.

    `edge` (k,) counts the steps out of each piece, `hidden` (k,) those to something nearer, and `own` (k,) is the sum
    of the heights that they start from. `met` (k, k) counts the steps from a piece to each other one, `smooth` (k, k)
    those without a jump, and `beyond` (k, k) is the sum of the heights at which the latter end.
    """

    edge: FloatArray
    hidden: FloatArray
    own: FloatArray
    met: FloatArray
    smooth: FloatArray
    beyond: FloatArray


def held_together(grid: ViewGrid, names: IntArray, least_m: float, drop_m: float) -> IntArray:
    """The names (rows, columns) with those of pieces that are parts of another one replaced by its name.

    A thing that is held by nothing below it falls. So a piece that ends in the air, and does not lie on what it
    touches, is joined to that: a mug's handle, a wing. And a piece is joined to the one that stands around it, higher
    than itself: the inside of a mug, a pan's bottom.

    A piece hangs if it was seen down to its lower edge, and that lies higher above the support plane than half of the
    least part `least_m` is wide: noise and what the sensor loses at a foot are less, and few cells hold flying points.
    It lies on what it touches no more than `drop_m` above its lower end, as a lid does, and a handle does not.
    """
    names = np.where(grid.known, names, 0)
    count = int(names.max()) + 1
    meetings = _borders(grid, names, count)
    cells = np.maximum(np.bincount(names.ravel(), minlength=count), 1)
    height = np.where(grid.known, grid.height, 0.0).ravel()
    middle = np.bincount(names.ravel(), weights=height, minlength=count) / cells
    feet = np.bincount(names.ravel(), weights=height < 0.5 * least_m, minlength=count)
    hangs = (feet < SMOOTH_CELLS**2) & (meetings.hidden <= (1 - MOST) * meetings.edge)
    low, high = np.full((2, count), np.nan)
    meeting = (np.flatnonzero(meetings.met[1:].any(axis=1)) + 1).tolist()
    for name in meeting:
        own = height[names.ravel() == name]
        low[name], high[name] = quantile(own, ODD_SHARE), quantile(own, 1 - ODD_SHARE)
    joined = np.arange(count)
    for name in meeting:
        other = _around(meetings, name, middle, high)
        if other is None and hangs[name]:
            other = _held_by(meetings, name, low + drop_m)
        if other is not None:
            joined[joined == joined[name]] = joined[other]
    return np.asarray(joined[names])


def _around(borders: _Borders, name: int, middle: FloatArray, high: FloatArray) -> int | None:
    """The piece that stands around the one called `name`, higher than it; None if there is none."""
    edge, met = borders.edge[name], borders.met[name]
    other = int(met.argmax())
    # a rim may hide what is close behind it, and its own inside is lost where it is steep
    enclosed = 2 * met.sum() >= edge and met[other] >= MOST * met.sum()
    deeper = middle[name] < borders.own[name] / edge and high[name] < high[other]
    return other if enclosed and deeper else None


def _held_by(borders: _Borders, name: int, low: FloatArray) -> int | None:
    """The piece that holds the one called `name`, which hangs; None if it lies on what it touches, or is behind it."""
    steps = borders.smooth[name]
    other = int(steps.argmax())
    if 2 * steps[other] <= borders.met[name, other]:
        return None
    return other if borders.beyond[name, other] / steps[other] > low[name] else None


def _borders(grid: ViewGrid, names: IntArray, count: int) -> _Borders:
    """Where the pieces called `names` (rows, columns), 0 for cells without points, meet."""
    (edge, hidden, own), (met, smooth), beyond = borders(names, grid.height, grid.depth, grid.jump_m, count)
    return _Borders(edge=edge, hidden=hidden, own=own, met=met.sum(axis=0), smooth=smooth.sum(axis=0), beyond=beyond)
