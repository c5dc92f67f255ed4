"""Beyond the paper: the side of an object that the sensor did not see.

The silhouette ends where the object was last seen. On the sensor's side that is its end. Behind it, in its shadow, the
object may go on as far as the envelope of the rays allows. How far it probably does, its heights tell: a flat top ends
at an edge, and a surface that turns away gently, as that of a can does, goes on in the shadow. Of what shows no top at
all, only a face, nobody knows how thick it is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.lines import fitted_lines
from flatgrasp_cli.geometry.polygon import dot
from flatgrasp_cli.kernels import flanks as kernels
from flatgrasp_cli.kernels import walls
from flatgrasp_cli.model import FingerCandidates
from flatgrasp_cli.surroundings.envelope import Envelope
from flatgrasp_cli.surroundings.maps import NOISE_M, HeightMaps
from flatgrasp_cli.surroundings.walls import ALONG_PAD, LEAST_SLOPE, chords_of

FAR_M = 0.04
"""How far inward and outward from a chord is looked, metres: half of the widest thing that hands span."""
LIMB_M = 0.012
"""Length of the profile, metres, that the slope of a face is told by, and the least breadth of a flank below a level
top: what is rounded over less is an edge, as a sensor blurs it."""
LOST_DEG = 15.0
"""A surface is last seen where it makes this angle with the ray, degrees: depth sensors return nothing at less."""


def seen_sides(
    fingers: FingerCandidates,
    maps: HeightMaps,
    envelope: Envelope,
    viewpoint: FloatArray,
    level_m: float,
    grip_m: float,
) -> FingerCandidates:
    """The candidates except those in holes that were not seen through, with how far the object goes on, out of sight.

    `viewpoint` (3,) is where the sensor was, in the height maps' frame. Holes are looked into `grip_m` below their rim,
    too: aslant, what is at the level may lie in the open behind the object, or below the floor.
    """
    bound = unseen_beyond(fingers, envelope, level_m)
    holes = np.flatnonzero((bound == 0) & (fingers.loop > 0))
    if len(holes) > 0:
        into = fingers.select(holes)
        rim = _profile(into, maps, _places(maps.surface)[:1])[0]
        bound[holes] = unseen_beyond(into, envelope, np.fmax(rim - grip_m, level_m))
    open_sides = (bound == 0) | (fingers.loop == 0)
    fingers, bound = fingers.select(open_sides), bound[open_sides]
    return replace(fingers, hidden=hidden_extent(fingers, maps, bound, viewpoint))


def unseen_beyond(fingers: FingerCandidates, envelope: Envelope, level_m: float | FloatArray) -> FloatArray:
    """How far (m,) the object may go on before each candidate, above `level_m` or its own (m,): as the rays allow.

    Metres; 0 where it was seen to end. The first cell is the silhouette's own uncertainty.
    """
    far = envelope.going_on(level_m, chords_of(fingers), _places(envelope.lowest)[1:], ALONG_PAD)
    return np.where(far > 0, (1 + far) * envelope.lowest.cell_m, 0.0)


def hidden_extent(fingers: FingerCandidates, maps: HeightMaps, bound: FloatArray, viewpoint: FloatArray) -> FloatArray:
    """How far (m,) the object at most goes on beyond the silhouette, metres, of the `bound` (m,) that the rays allow.

    Of two models that is taken which agrees better with the heights near the chord: a flat top that ends there, or a
    flank that goes on. What rises outward as steeply as a face has neither, and may go on as far as the bound. So may
    what turned away from the rays, plane as it may be, until none came back: it was lost from sight before its end.
    """
    extent = np.zeros(len(fingers))
    rows = np.flatnonzero(bound > 0)
    if len(rows) == 0:
        return extent
    fingers, bound = fingers.select(rows), bound[rows]
    inward = _places(maps.surface)
    heights = _profile(fingers, maps, inward)
    near = inward <= LIMB_M
    limb, slope = fitted_lines(inward[near], heights[near].T)
    face = (slope < -LEAST_SLOPE) | (2 * np.isfinite(heights[near]).sum(axis=0) < np.count_nonzero(near))
    fall = _limb_slope(fingers, limb, viewpoint)
    flank = _flank(inward, heights, fall)
    lost = (flank == 0) & (fall > 0) & (slope >= fall)
    extent[rows] = _with_neighbours(fingers, np.minimum(np.where(face | lost, np.inf, flank), bound))
    return extent


def _places(chart: HeightMap) -> FloatArray:
    """Distances (d,) from a chord, metres: one for each cell."""
    return np.asarray(np.arange(0.5, FAR_M / chart.cell_m) * chart.cell_m)


def _profile(fingers: FingerCandidates, maps: HeightMaps, inward: FloatArray) -> FloatArray:
    """Highest points (d, m) of the object at the distances `inward` (d,) from each chord, the mean along the pad."""
    surface, highest = maps.surface, maps.highest
    found: FloatArray = walls.profile(
        chords_of(fingers), inward, ALONG_PAD, surface.heights, highest.heights, surface.grid
    )
    return found


def _flank(inward: FloatArray, heights: FloatArray, slope: FloatArray) -> FloatArray:
    """How far (m,) flanks go on outward, metres, by the `heights` (d, m) that were seen `inward` (d,) of them.

    A flank is taken for an ellipse, as of an object that lies on its side: it is highest at H, the profile's highest
    point, and upright at b = H/2. If it falls with the `slope` s (m,) where it was last seen, t before its top, then
    u = t/a, the distance in half axes a, solves u² = (s·t/b)·√(1 − u²), and it goes on for a·(1 − u). That t is taken
    at which it agrees best with the heights. The answer is 0 where a plane top that ends at an edge agrees better, or
    within the heights' noise. Behind its top an ellipse falls again or, if it is broad enough, goes over into a level.
    """
    uneven = NOISE_M**2 / len(ALONG_PAD)
    return kernels.going_on(inward, heights, slope, LIMB_M, uneven)


def _with_neighbours(fingers: FingerCandidates, extent: FloatArray) -> FloatArray:
    """The largest `extent` (m,) of the candidates that a finger there would stand before, too, and that look its way.

    At a corner of the shadow a profile runs off the object's side, and tells nothing.
    """
    return kernels.most_nearby(extent, fingers.contact, fingers.direction, fingers.width)


def _limb_slope(fingers: FingerCandidates, limb: FloatArray, viewpoint: FloatArray) -> FloatArray:
    """Slope (m,) of a surface last seen at each chord, at heights `limb` (m,); 0 on the sensor's side."""
    ray = fingers.contact - viewpoint[:2]
    away = -dot(ray, fingers.direction)
    fall = np.arctan2(viewpoint[2] - limb, np.maximum(away, 1e-9))
    return np.where(away > 0, np.tan(np.clip(fall - np.radians(LOST_DEG), 0.0, np.radians(85))), 0.0)
