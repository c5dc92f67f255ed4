"""What pads find to rest on beside the silhouette: upright walls, or flanks that they slip off."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.lines import fitted_lines
from flatgrasp_cli.kernels import walls as kernels
from flatgrasp_cli.model import FingerCandidates
from flatgrasp_cli.surroundings.envelope import Envelope
from flatgrasp_cli.surroundings.maps import NOISE_M

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
BELOW_M = 0.003
"""How far inward of a chord it is looked below a rim, metres: so much rays pass of what a cell of the maps blurs."""
RAISED = 4
"""Heights of the fingertips, from where they should be up to a wall's top, that its lean is told for: what they miss by
is a fraction of the grip as a rule."""


class Walls(NamedTuple):
    """What pads rest on at m finger candidates: heights (m,) over the plane, metres.

    `top` is the median over the places along the pad, `boundary` the mean of what was seen at the boundary, and `flank`
    how much of the wall's height is only a flank. `crests` (distances, m) are the highest points at `INWARD_M`, medians
    along the pad. `foot` is how far down the wall was seen, and `free` up to where rays passed below it; where neither
    is known, `as_where_known`.
    """

    top: FloatArray
    boundary: FloatArray
    flank: FloatArray
    crests: FloatArray
    foot: FloatArray
    free: FloatArray

    def lean(self, pairs: IntArray, tip: FloatArray, top: FloatArray) -> FloatArray:
        """Tangents (p, RAISED) of the angle by which the walls of `pairs` (2, p) lean, over the lower half of the grip.

        They are those for fingertips that end at `tip` (p,), below the walls' `top` (p,), and for such that end higher,
        by equal shares of the grip: then walls lean at least as much. They lean by their highest points, for the mean
        height of an upright face that was seen is half of its own.
        """
        found: FloatArray = kernels.leans(self.crests, INWARD_M, pairs, tip, top, RAISED, NOISE_M)
        return found

    def feet(self, pairs: IntArray, tip: FloatArray) -> FloatArray:
        """Between which heights (p, 2, 2), the lower first, the walls of `pairs` (2, p) end below: a rim overhangs.

        It does if rays passed below it higher up than where the fingertips end, at `tip` (p,). Otherwise a wall goes
        down to those, seen or not.
        """
        free, foot = self.free[pairs], self.foot[pairs]
        bounds = np.stack([np.minimum(free, foot), foot], axis=-1)
        return np.ascontiguousarray(np.where((free > tip)[..., None], bounds, tip[:, None]).swapaxes(0, 1))


def chords_of(fingers: FingerCandidates) -> FloatArray:
    """The candidates' chords (m, 6): the middle, the way along it and the way inward."""
    return np.concatenate([fingers.contact, fingers.end - fingers.start, fingers.direction], axis=1)


def pad_places(chords: FloatArray, inward: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """X and y (inward, along, m) of places at distances `inward` from each of `chords` (m, 6) and shares `along` it."""
    x, y = (
        chords[:, k] + along[:, None] * chords[:, 2 + k] + (inward[:, None] * chords[:, 4 + k])[:, None] for k in (0, 1)
    )
    return x, y


def upright(fingers: FingerCandidates, rest: HeightMap, level_m: float, wall_drop: float) -> BoolArray:
    """Which candidates (m,) stand before a wall, and not on a flank that goes on outward below `level_m`.

    `rest` holds the heights of what the slice stands on. A wall falls by at least `wall_drop` times the way outward, at
    half of the places or more.
    """
    out = INWARD_M[1 : WALL_PLACES - 1]  # beyond the silhouette's noise, but within a slice's height of a steep flank
    below = rest.over(*pad_places(chords_of(fingers), -out, ALONG_PAD))
    drop = level_m - np.maximum(below, 0.0)
    steep = drop >= wall_drop * out[:, None, None]
    return np.asarray(steep.mean(axis=(0, 1)) >= 0.5)


def walls(fingers: FingerCandidates, surface: HeightMap, envelope: Envelope, level_m: float, friction: float) -> Walls:
    """The walls before m candidates, from the mean heights of the `surface`; the slice's level where nothing was seen.

    What rises inward less steeply than 1/μ is a flank, and only its height at the boundary is a wall. The slope is that
    of the highest points, for the mean height of an upright face is half of its own.
    """
    chords, maps = chords_of(fingers), (surface.heights, envelope.lowest.heights, surface.grid)
    (top, boundary, foot), crests, means = kernels.faces(chords, INWARD_M, ALONG_PAD, *maps, level_m, WALL_PLACES)
    _, slope = fitted_lines(INWARD_M, means.T)
    flank = (slope > LEAST_SLOPE) & (slope < 1 / friction)
    free = envelope.free_below(top, chords, BELOW_M, ALONG_PAD)
    free, foot = as_where_known(fingers.loop, free, foot, level_m)
    return Walls(
        top=top,
        boundary=boundary,
        flank=np.where(flank, slope * INWARD_M[WALL_PLACES - 1], 0.0),
        crests=crests,
        foot=foot,
        free=free,
    )


def as_where_known(
    loops: IntArray, free: FloatArray, foot: FloatArray, level_m: float
) -> tuple[FloatArray, FloatArray]:
    """Up to where it is `free` (m,) below walls, and their `foot` (m,); where nobody saw either, as where it is known.

    It is known where rays passed below a wall, or it was seen down to `level_m`. Where not, both are the medians of
    what is known on the same one of the `loops` (m,): a plate's far rim overhangs, too. A foot is no higher than what
    was seen of its own wall.
    """
    known = (free > 0) | (foot <= level_m + NOISE_M)
    free, foot = free.copy(), foot.copy()
    for loop in np.unique(loops[~known]):
        here = loops == loop
        seen, unseen = here & known, here & ~known
        if seen.any():
            free[unseen] = np.median(free[seen])
            foot[unseen] = np.minimum(foot[unseen], np.median(foot[seen]))
    return free, foot
