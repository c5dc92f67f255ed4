"""Beyond the paper: the side of an object that the sensor did not see.

Behind an object, in its shadow, no free space was seen. If its surface turns away gently, as that of a can does, the
object goes on in there; if it ends at an edge, it does not. The silhouette alone cannot tell, but heights can.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.lines import fitted_lines
from flatgrasp_cli.geometry.polygon import dot
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.surroundings.maps import HeightMaps
from flatgrasp_cli.surroundings.view import View
from flatgrasp_cli.surroundings.walls import pad_places

OUTWARD_M = (0.003, 0.005, 0.007)
"""Distances from a chord outward, metres, at which the finger's space is looked into: beyond the silhouette's noise,
and within the thickness of a finger."""
HEIGHTS_M, BEHIND_M = (0.003, 0.010), 0.006
"""Heights over the fingertips' level, metres, at which it is looked into: within the least grip and above it. And how
far behind a surface space must lie to be hidden by it: two pixels of the range image."""
SHADOW_SHARE, HOLE_SHARE = 0.5, 0.2
"""Shares of that space beyond which a side counts as lying in the shadow, and a hole as not seen through. Less is
allowed in a hole, where a finger has no room to spare."""
PROFILE_M = np.arange(0.001, 0.0405, 0.002)
"""Distances from a chord inward, metres, at which the surface's profile is read: one for each cell of 2 mm, as far as
half of an object 8 cm wide."""
LIMB_M = 0.012
"""Length of the profile, metres, over which the slope at the limb is measured: six cells, for one of them is noise."""
LOST_DEG = 15.0
"""A surface is last seen where it makes this angle with the ray, degrees: depth sensors return nothing at less."""
ALIKE = 0.5
"""Cosine of the angle within which neighbours look the same way: 60 degrees, more than a corner of the shadow has."""
ROUND_SHARE = 0.2
"""A surface ends at an edge if its mean slope near the limb is less than this share of that at the limb. On a can it is
more than half; on a flat top it is zero but for the outermost cell, which the edge makes lower."""
MOST_M = 0.03
"""Largest hidden extent that is believed, metres: that of a can 20 cm across, wider than hands open."""
TOP_M = np.array([0.001, 0.003, 0.005])
"""Distances from a chord inward, metres, at which a face is told from a top: two or three cells."""
THIN_M = 0.03
"""Contacts closer than this, metres, may be the two sides of one face: the silhouette of a face 10 cm high that leans
by 15° is so thin."""
FACE_M = 0.008
"""Cells whose mean lies this far below their highest point, metres, on average, show a face and not a top: half of the
height of an upright face of 16 mm."""
ACROSS = np.linspace(-0.4, 0.4, 9)
"""Places along a pad, in widths of it: the ends are left out, for the silhouette bends away there."""


def seen_sides(
    fingers: FingerCandidates, maps: HeightMaps, view: View, viewpoint: FloatArray, level_m: float
) -> FingerCandidates:
    """The candidates except those in holes that were not seen through, with what was seen of the sides they stand at.

    In the object's shadow, as cast from the sensor at `viewpoint` (3,), the silhouette is only where its top ends, and
    the object may go on behind that. Where only a face was seen and no top, its thickness is not known.
    """
    share = hidden_share(fingers, view, level_m)
    open_sides = (share <= HOLE_SHARE) | (fingers.loop == 0)
    fingers, shadowed = fingers.select(open_sides), share[open_sides] > SHADOW_SHARE
    hidden = hidden_extent(fingers, maps.surface, shadowed, viewpoint)
    seen = ~shadowed
    rows = np.flatnonzero(shadowed)
    seen[rows] = ~_front_only(fingers.select(rows), maps)
    return replace(fingers, hidden=hidden, seen=seen)


def of_known_thickness(fingers: FingerCandidates, grasps: GraspCandidates, funnel: Funnel) -> GraspCandidates:
    """The pairs except those that take the two sides of one seen face for the sides of a thin object."""
    face = ~(fingers.seen[grasps.i] & fingers.seen[grasps.j])
    missing = np.where(face, np.maximum(THIN_M - grasps.distance, 0.0), 0.0)
    kept = funnel.at_most(
        "seen", grasps, missing, 0.0, lambda _: "only a face of the object was seen, not how thick it is behind that"
    )
    return grasps.select(kept)


def _front_only(fingers: FingerCandidates, maps: HeightMaps) -> BoolArray:
    """Which candidates (m,) have an upright face before them instead of the object's top."""
    x, y = pad_places(fingers, TOP_M, ACROSS)
    mean = maps.average.over(x, y)
    known = np.isfinite(mean)
    spread = np.where(known, maps.highest.over(x, y) - np.where(known, mean, 0.0), 0.0)
    return np.asarray(spread.sum(axis=(0, 1)) > FACE_M * np.maximum(known.sum(axis=(0, 1)), 1))


def hidden_share(fingers: FingerCandidates, view: View, level_m: float) -> FloatArray:
    """Share (m,) of the space before each candidate, where a finger comes down, that the sensor did not see."""
    x, y = pad_places(fingers, -np.array(OUTWARD_M), ACROSS[::2])
    levels = level_m + np.array(HEIGHTS_M)
    points = np.empty((3, len(levels), *x.shape))
    points[0], points[1], points[2] = x, y, levels[:, None, None, None]
    hidden = view.hides(points.reshape(3, -1), BEHIND_M).reshape(-1, len(fingers))
    return np.asarray(np.count_nonzero(hidden, axis=0) / len(hidden))


def hidden_extent(
    fingers: FingerCandidates, surface: HeightMap, shadowed: BoolArray, viewpoint: FloatArray
) -> FloatArray:
    """How far (m,) the object probably goes on beyond the silhouette, metres; 0 where it was seen, or ends at an edge.

    The flank is taken for a quarter of an ellipse, as of an object that lies on its side: its top is the profile's
    highest point, at a height H, and it is upright at H/2. With b = H/2, height h and slope s at the limb,
    c = (h − b)/b and u = √(1 − c²), its half axis is a = b·u/(c·s), and it goes on for a·(1 − u). The slope follows
    from the direction of the sensor at `viewpoint` (3,), in the height map's frame: a measured one is too noisy.
    """
    extent = np.zeros(len(fingers))
    rows = np.flatnonzero(shadowed)
    if len(rows) == 0:
        return extent
    fingers = fingers.select(rows)
    profiles = surface.over(*pad_places(fingers, PROFILE_M, ACROSS[::2]))
    known = np.isfinite(profiles)
    total = np.where(known, profiles, 0.0).sum(axis=1)
    count = known.sum(axis=1)
    heights = np.where(count > 0, total / np.maximum(count, 1), np.nan).T  # (k, distances)
    near = PROFILE_M <= LIMB_M
    limb, measured = fitted_lines(PROFILE_M[near], heights[:, near])
    slope = _limb_slope(fingers, limb, viewpoint)
    half = 0.5 * np.nanmax(np.where(np.isfinite(heights), heights, 0.0), axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        c = (limb - half) / half
        u = np.sqrt(1 - c**2)
        beyond = half * u * (1 - u) / (c * slope)
    rounded = np.isfinite(beyond) & (measured > ROUND_SHARE * slope) & (slope > 0) & (c > 0)
    extent[rows] = _with_neighbours(fingers, np.where(rounded, np.clip(beyond, 0.0, MOST_M), 0.0))
    return extent


def _with_neighbours(fingers: FingerCandidates, extent: FloatArray) -> FloatArray:
    """The largest `extent` (m,) of the candidates that a finger there would stand before, too, and that look its way.

    At a corner of the shadow a profile runs off the object's side, and tells nothing.
    """
    near = np.linalg.norm(fingers.contact[:, None] - fingers.contact, axis=2) <= fingers.width[:, None]
    alike = fingers.direction @ fingers.direction.T > ALIKE
    return np.asarray(np.where(near & alike, extent, 0.0).max(axis=1, initial=0.0))


def _limb_slope(fingers: FingerCandidates, limb: FloatArray, viewpoint: FloatArray) -> FloatArray:
    """Slope (m,) of a surface last seen at each chord, at heights `limb` (m,); 0 on the sensor's side."""
    ray = fingers.contact - viewpoint[:2]
    away = -dot(ray, fingers.direction)
    fall = np.arctan2(viewpoint[2] - limb, np.maximum(away, 1e-9))
    return np.where(away > 0, np.tan(np.clip(fall - np.radians(LOST_DEG), 0.0, np.radians(85))), 0.0)
