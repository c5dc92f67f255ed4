"""What pads find to rest on beside the silhouette: upright walls, or flanks that they slip off."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.lines import fitted_lines
from flatgrasp_cli.model import FingerCandidates

INWARD_M = np.array([0.001, 0.002, 0.003, 0.004, 0.005, 0.007, 0.009])
"""Distances from a chord inward, metres, at which heights tell whether the pad rests on a wall or on a flank: close
together at first, and as far in as pads are about to hold in height."""
WALL_PLACES = 5
"""How many of those distances, counted from the chord, are the boundary itself, and can show the wall's top: 5 mm, for
the edge of a wall is rounded by the sensor."""
LEAST_SLOPE = 0.5
"""A surface that rises less steeply than this, height over breadth (27°), is the object's top."""
ALONG_PAD = np.array([-0.4, -0.2, 0.0, 0.2, 0.4])
"""Places along a pad, in widths of it: the ends are left out, for the silhouette bends away there."""


class Walls(NamedTuple):
    """What pads rest on at m finger candidates: heights (m,) over the plane, metres.

    `top` is the median over the places along the pad, `boundary` the mean of what was seen at the boundary, and `flank`
    how much of the wall's height is only a flank. `profile` (distances, m) are the heights at `INWARD_M`, the median
    along the pad, and `crests` the same of the highest points.
    """

    top: FloatArray
    boundary: FloatArray
    flank: FloatArray
    profile: FloatArray
    crests: FloatArray

    def recess(self, rows: IntArray, levels: FloatArray, *, of_crests: bool = False) -> FloatArray:
        """How far (p,) inward from the boundary the walls of the candidates `rows` (p,) come up to `levels` (p,).

        Metres, from the first place that heights are known at; those that never do begin behind the last.
        """
        profile = (self.crests if of_crests else self.profile)[:, rows]
        above = np.where((profile >= levels).any(axis=0), (profile >= levels).argmax(axis=0), len(INWARD_M) - 1)
        below, columns = np.maximum(above - 1, 0), np.arange(len(rows))
        low, high = profile[below, columns], profile[above, columns]
        share = ((levels - low) / np.where(high > low, high - low, 1.0)).clip(0.0, 1.0)
        return np.asarray(INWARD_M[below] + share * (INWARD_M[above] - INWARD_M[below]) - INWARD_M[0])


def pad_places(fingers: FingerCandidates, inward: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """X and y (inward, along, m) of places at distances `inward` from each candidate's chord and shares `along` it."""
    way = fingers.end - fingers.start
    x, y = (
        fingers.contact[:, k] + along[:, None] * way[:, k] + (inward[:, None] * fingers.direction[:, k])[:, None]
        for k in (0, 1)
    )
    return x, y


def upright(fingers: FingerCandidates, rest: HeightMap, level_m: float, wall_drop: float) -> BoolArray:
    """Which candidates (m,) stand before a wall, and not on a flank that goes on outward below `level_m`.

    `rest` holds the heights of what the slice stands on. A wall falls by at least `wall_drop` times the way outward, at
    half of the places or more.
    """
    out = INWARD_M[1 : WALL_PLACES - 1]  # beyond the silhouette's noise, but within a slice's height of a steep flank
    below = rest.over(*pad_places(fingers, -out, ALONG_PAD))
    drop = level_m - np.maximum(below, 0.0)
    steep = drop >= wall_drop * out[:, None, None]
    return np.asarray(steep.mean(axis=(0, 1)) >= 0.5)


def walls(fingers: FingerCandidates, surface: HeightMap, highest: HeightMap, level_m: float, friction: float) -> Walls:
    """The walls before m candidates, from the mean heights of the `surface`; the slice's level where nothing was seen.

    What rises inward less steeply than 1/μ is a flank, and only its height at the boundary is a wall. The slope is that
    of the `highest` points, for the mean height of an upright face is half of its own.
    """
    places = pad_places(fingers, INWARD_M, ALONG_PAD)
    heights = surface.over(*places)  # (distances, places, m)
    known = np.isfinite(heights)
    tops = heights[:WALL_PLACES].max(axis=0)
    top = np.sort(np.where(np.isfinite(tops), tops, level_m), axis=0)[len(ALONG_PAD) // 2]
    near, count = heights[:WALL_PLACES], known[:WALL_PLACES].sum(axis=(0, 1))
    total = np.where(known[:WALL_PLACES], near, 0.0).sum(axis=(0, 1))
    boundary = np.where(count > 0, total / np.maximum(count, 1), level_m)
    counts, totals = known.sum(axis=1), np.where(known, highest.over(*places), 0.0).sum(axis=1)
    _, slope = fitted_lines(INWARD_M, np.where(counts > 0, totals / np.maximum(counts, 1), np.nan).T)
    flank = (slope > LEAST_SLOPE) & (slope < 1 / friction)
    profile, crests = (
        np.sort(np.where(known, each, 0.0), axis=1)[:, len(ALONG_PAD) // 2] for each in (heights, highest.over(*places))
    )
    return Walls(
        top=top,
        boundary=boundary,
        flank=np.where(flank, slope * INWARD_M[WALL_PLACES - 1], 0.0),
        profile=profile,
        crests=crests,
    )
