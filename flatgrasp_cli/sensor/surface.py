"""What the shape of a cloud tells of where its sensor was.

A sensor sees the near side of things. So what stands on a plane stands on the sensor's side of it; and the surface of a
thing seen alone faces the sensor everywhere, and mostly bulges toward it.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.extents import bounds_of, extent_of, mean_of
from flatgrasp_cli.geometry.frames import frame_on_plane
from flatgrasp_cli.geometry.hull import convex_hull, depths
from flatgrasp_cli.geometry.planes import consensus_plane
from flatgrasp_cli.geometry.polygon import signed_area
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.geometry.sampling import even_sample
from flatgrasp_cli.geometry.scatter import median
from flatgrasp_cli.kernels.points import distances

Verdict = Literal["seen", "flat", "hollow", "impossible"]
"""Whether a cloud can have been seen from a place.

- `seen`: all of it faces the place, and it bulges toward it or stands on a plane on that side.
- `flat`: all of it faces the place, and just as well the place opposite.
- `hollow`: all of it faces the place, but it bulges away, as the inside of a bowl does.
- `impossible`: parts of it face away or are hidden by others, or it stands on the other side of its plane.
"""

PLANE_SAMPLE, STANDING_SAMPLE, SURFACE_SAMPLE = 1000, 5000, 250
PLANE_TOLERANCE_M = 0.008
"""Scatter of a plane about itself that depth cameras show at a metre."""
LEAST_PLANE_SHARE = 0.15
STANDING_SIGMAS, STANDING_M = 4.0, (0.004, 0.5)
"""Heights over a plane, beyond its scatter and below furniture, at which points stand on it."""
EDGE_SHARE = 0.1
"""What lies within this share of a plane's width from its edge may belong to the flank of a box whose top it is."""
MOST_SCATTER = 0.45
"""Standard deviation of the plane's points over the tolerance: evenly spread ones have 0.58, real tables up to 0.41."""
TABLE_M = 0.3
"""A plane as wide as this is hardly a part of one object: a little tells that it is a table."""
LEAST_STANDING, LEAST_STANDING_SHARE, MOST_STANDING, ONE_SIDED = (20, 8), 0.0015, 0.6, 0.8
"""Points that stand on a plane: how many at least (fewer on one as wide as a table), of all points at least, over the
plane's own at most, and on one side of it at least."""
FILL_POINTS, LEAST_FILLED = 4, 0.6
"""Points in a cell of a plane, on average, and the share of its convex hull that cells with points fill: tables keep
more than this, shadows and all."""
SECTORS, LEAST_SECTORS, AROUND, AROUND_M = 16, 13, 1.5, 0.03
"""Directions around what stands on a plane, and in how many of them the plane must be seen: farther from its middle
than this many times the distance that half of it has, and than a finger is wide. On a hammer nothing is there."""
LEAST_DISTANCE_M = 0.1
"""A place closer to the plane than this is no sensor's: clouds in a table's own frame leave it at the origin."""
NEIGHBOURS = 9
KD_TREE = 4
"""FLANN's name for an exact search in one tree."""
MOST_THICK = 0.3
"""Thickness of a neighbourhood over its width, at most, for its points to lie on a surface: single objects that a depth
camera saw have 0.12 to 0.27, points that fill a slab 0.65."""
LEAST_FACING = 0.9
LEAST_BULGE, LEAST_TURN = 0.2, 0.03
"""How surely a surface bulges, and how much its normals turn outward from one neighbour to the next, in radians, for
that to tell a side: things alone have 0.35 and 0.05 at least, sheets with a few small things on them 0.1 and 0.02."""
PIXEL_POINTS, BEHIND_PIXELS, MOST_HIDDEN = 4, 4, 0.25
"""Points in a pixel of the range image, on average; how many pixels' width behind another point one is hidden, so that
a surface seen as flatly as at 15° does not hide itself; and the share that may be: real frames have up to 5 %."""
LARGEST_OBJECT_M = 0.7
"""The surface of what is larger is no single object's, and its normals tell nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """The shape of a cloud, to hold places against.

    `standing` is the unit normal (3,) and offset of a plane that things stand on, on the normal's side; None if there
    is none. Else `points` (k, 3) are a sample of the surface with unit `normals` (k, 3) on the side to which it bulges,
    and `bulge` says how much, from 0 for a flat sheet to 1. `all_points` are another, larger sample.
    """

    all_points: FloatArray
    standing: tuple[FloatArray, float] | None
    points: FloatArray
    normals: FloatArray
    bulge: float

    @classmethod
    def of(cls, points: FloatArray, rng: np.random.Generator) -> Surface:
        """The shape of `points` (n, 3)."""
        everything = even_sample(points, STANDING_SAMPLE)
        standing = _standing_plane(everything, rng)
        sample, nothing = even_sample(points, SURFACE_SAMPLE), np.empty((0, 3))
        large = len(sample) <= NEIGHBOURS or float(extent_of(sample).max()) > LARGEST_OBJECT_M
        surface = None if standing is not None or large else _bulging_normals(sample)
        if surface is None:
            return cls(everything, standing, nothing, nothing, 0.0)
        return cls(everything, None, sample, *surface)

    def seen_from(self, place: FloatArray) -> Verdict:
        """Whether the cloud can have been seen from `place` (3,)."""
        if _hidden_share(self.all_points, place) > MOST_HIDDEN:
            return "impossible"
        if self.standing is not None:
            normal, offset = self.standing
            return "seen" if normal @ place - offset >= LEAST_DISTANCE_M else "impossible"
        if len(self.points) == 0:
            return "flat"
        facing = float(np.mean(np.einsum("ij,ij->i", self.normals, place - self.points) > 0))
        if max(facing, 1 - facing) < LEAST_FACING:
            return "impossible"
        if self.bulge < LEAST_BULGE:
            return "flat"
        return "seen" if facing > 0.5 else "hollow"


def _standing_plane(points: FloatArray, rng: np.random.Generator) -> tuple[FloatArray, float] | None:
    """Normal and offset of the biggest plane of `points` (n, 3) if things stand on it, all on the normal's side."""
    sample = even_sample(points, PLANE_SAMPLE)
    plane = consensus_plane(sample, PLANE_TOLERANCE_M, rng) if len(points) >= LEAST_STANDING[0] else None
    if plane is None:
        return None
    normal, offset = plane
    heights = points @ normal - offset
    flat = np.abs(heights) < PLANE_TOLERANCE_M
    if flat.mean() < LEAST_PLANE_SHARE or heights[flat].std() > MOST_SCATTER * PLANE_TOLERANCE_M:
        return None  # no plane, or a slice of a rounded body
    least = max(STANDING_SIGMAS * float(heights[flat].std()), STANDING_M[0])
    off = np.flatnonzero((np.abs(heights) > least) & (np.abs(heights) < STANDING_M[1]))
    frame = frame_on_plane(normal, offset)
    sheet = frame.to_local(points[flat])[:, :2]
    hull = convex_hull(sheet)
    area = signed_area(hull)
    off = off[_well_within(frame.to_local(points[off])[:, :2], hull)]
    above = int(np.count_nonzero(heights[off] > 0))
    most = max(above, len(off) - above)
    large = bool(2 * np.sqrt(area / np.pi) >= TABLE_M)
    least = max(LEAST_STANDING[large], LEAST_STANDING_SHARE * len(points))
    if not least <= most <= MOST_STANDING * np.count_nonzero(flat) or most < ONE_SIDED * len(off):
        return None
    if not (large and _filled(sheet, area)) and not _surrounded(sheet, frame.to_local(points[off])[:, :2]):
        return None
    return (normal, offset) if 2 * above > len(off) else (-normal, -offset)


def _filled(sheet: FloatArray, area: float) -> bool:
    """Whether places (n, 2) of a plane's own points fill their convex hull, of that area, as a table's do."""
    cell = np.sqrt(FILL_POINTS * area / len(sheet))
    row, column = ((sheet - bounds_of(sheet)[0]) / cell).astype(np.intp).T
    filled = np.count_nonzero(np.bincount(row * (int(column.max()) + 1) + column))
    return bool(filled * cell**2 >= LEAST_FILLED * area)


def _surrounded(sheet: FloatArray, standing: FloatArray) -> bool:
    """Whether places (n, 2) of a plane's own points lie around those `standing` (k, 2) on it, on nearly all sides."""
    middle = mean_of(standing)
    away, apart = (np.hypot(*(places - middle).T) for places in (sheet, standing))
    x, y = (sheet[away > max(AROUND * float(np.median(apart)), AROUND_M)] - middle).T
    return len(np.unique(np.floor(np.arctan2(y, x) * SECTORS / (2 * np.pi)) % SECTORS)) >= LEAST_SECTORS


def _well_within(places: FloatArray, hull: FloatArray) -> BoolArray:
    """Which `places` (n, 2) lie over a plane, away from the edge of its points' convex hull (c, 2)."""
    margin = EDGE_SHARE * 2 * np.sqrt(signed_area(hull) / np.pi)
    return np.asarray(depths(hull, places) > margin)


def _bulging_normals(points: FloatArray) -> tuple[FloatArray, float] | None:
    """Unit normals (n, 3) of the surface through `points` (n, 3), on the side to which it bulges, and how much it does.

    Where (n_i − n_j)·(x_i − x_j) > 0 for neighbours, the surface between them is convex. The bulge is the sum of that
    over all neighbours, over the sum of its absolute values; pieces that are apart each bulge to a side of their own.
    None where the points fill a space and lie on no surface.
    """
    tree = cv2.flann.Index(points.astype(np.float32), {"algorithm": KD_TREE, "leaf_max_size": 16})
    neighbours, squares = tree.knnSearch(points.astype(np.float32), NEIGHBOURS, params={})
    local = points[neighbours] - points[neighbours].mean(axis=1, keepdims=True)
    spread, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", local, local))
    flatness = np.sqrt(np.maximum(spread[:, 0], 0.0) / np.maximum(spread[:, 1], 1e-30))
    if np.median(flatness) > MOST_THICK:
        return None
    normals = axes[:, :, 0]
    here, there = np.repeat(np.arange(len(points)), NEIGHBOURS - 1), neighbours[:, 1:].ravel().astype(np.intp)
    signs, piece = _consistent_signs(points, normals, here, there)
    normals *= signs[:, None]
    distance = np.sqrt(squares[:, 1:]).ravel()
    bends = np.einsum("ij,ij->i", normals[here] - normals[there], points[here] - points[there])
    bends *= distance < 3 * np.median(distance)
    bulges = np.bincount(piece[here], weights=bends)
    normals[bulges[piece] < 0] *= -1
    outward = float(np.abs(bulges).sum())
    turn = outward / max(float(distance[bends != 0.0].sum()), 1e-30)
    return normals, outward / max(float(np.abs(bends).sum()), 1e-30) if turn >= LEAST_TURN else 0.0


def _consistent_signs(
    points: FloatArray, normals: FloatArray, here: IntArray, there: IntArray
) -> tuple[FloatArray, IntArray]:
    """A sign (n,) for each normal such that they lie on one side of the surface, and the piece of it (n,) it is on.

    `here` and `there` (m,) are neighbours. Two normals lie on one side if the one agrees with the other mirrored in the
    plane halfway between their points (König & Gumhold, VMV 2009): across a sharp edge, too. Where they agree best the
    sign is handed on first, along a minimum spanning tree (Hoppe et al., SIGGRAPH 1992).
    """
    along = points[there] - points[here]
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-12)[:, None]
    mirrored = normals[there] - 2 * np.einsum("ij,ij->i", along, normals[there])[:, None] * along
    agreement = np.einsum("ij,ij->i", normals[here], mirrored)
    edges: list[list[tuple[float, int, bool]]] = [[] for _ in points]
    for one, other, doubt, turned in zip(
        here.tolist(), there.tolist(), (1 - np.abs(agreement)).tolist(), (agreement < 0).tolist(), strict=True
    ):
        edges[one].append((doubt, other, turned))
        edges[other].append((doubt, one, turned))
    signs, piece = [0.0] * len(points), [0] * len(points)
    for start in range(len(points)):
        waiting = [] if signs[start] else [(0.0, start, 1.0)]
        while waiting:
            _, place, sign = heapq.heappop(waiting)
            if signs[place]:
                continue
            signs[place], piece[place] = sign, start
            for doubt, other, turned in edges[place]:
                if not signs[other]:
                    heapq.heappush(waiting, (doubt, other, -sign if turned else sign))
    return np.array(signs), np.array(piece, dtype=np.intp)


def _hidden_share(points: FloatArray, place: FloatArray) -> float:
    """Share of `points` (n, 3) that lie behind others, seen from `place` (3,)."""
    apart = distances(points, place)
    sides = np.sort(extent_of(points))
    spacing_m = max(float(np.sqrt(PIXEL_POINTS * sides[1] * sides[2] / len(points))), 1e-6)
    if median(apart) < spacing_m:
        return 1.0
    nearest, ranges = RangeImage.of(points, place, spacing_m).nearest(points.T)
    return float(np.mean(nearest < ranges - BEHIND_PIXELS * spacing_m))
