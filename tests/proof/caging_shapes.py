"""Outlines whose cages are known by hand or can be made at random, and a brute-force search for a way out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from scipy.ndimage import label
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray


def i_beam(neck: float = 1.0, depth: float = 1.0, flange: float = 0.5, mouth: float = 1.5) -> FloatArray:
    x1, x2, y1, y2 = mouth / 2, mouth / 2 + flange, neck / 2, neck / 2 + depth
    right = [(x1, -y1), (x1, -y2), (x2, -y2), (x2, y2), (x1, y2), (x1, y1)]
    return np.array(right + [(-x, -y) for x, y in right])


def bowtie(neck: float = 1.0, rise: float = 1.0, half: float = 2.0) -> FloatArray:
    y1, y2 = neck / 2, neck / 2 + rise
    return np.array([(-half, -y2), (0, -y1), (half, -y2), (half, y2), (0, y1), (-half, y2)])


def plus_sign(arm: float = 1.0, span: float = 3.0) -> FloatArray:
    a, b = arm / 2, span / 2
    quarter = np.array([(a, -b), (a, -a), (b, -a)])
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    return np.concatenate([quarter @ np.linalg.matrix_power(turn, k) for k in range(4)])


def two_notch_bar(half: float) -> FloatArray:
    lower = [(-half, -1), (-1, -0.5), (0, -1), (1, -0.5), (half, -1)]
    return np.array(lower + [(-x, -y) for x, y in lower])


_ARCH_OUTSIDE = [(0, 0), (6.5, 0), (7, 0.3), (7.5, 0), (10, 0), (10, 1), (1, 1), (1, 5), (5, 5), (5, 2), (9, 2), (9, 3)]
ARCH = np.array([*_ARCH_OUTSIDE, (7.5, 3), (7, 2.7), (6.5, 3), (6, 3), (6, 6), (0, 6)])
"""A hook around a bar: to leave the grasp at (7, 0.3) and (7, 2.7), a finger must move off the boundary."""

_SLOT_INSIDE = [(0.5, 0.3), (0.5, 0), (1, 0), (1, -1), (-1, -1), (-1, 0), (-0.5, 0), (-0.5, 0.3)]
SLOT = np.array([(-3, -2), (3, -2), (3, 0.3), *_SLOT_INSIDE, (-3, 0.3)])
"""A block with a T-slot, 2 wide and 1 deep, its mouth 1 wide."""


def regular(corners: int) -> FloatArray:
    angles = 2 * np.pi * np.arange(corners) / corners
    return np.column_stack([np.cos(angles), np.sin(angles)])


def star(seed: int, corners: int = 9) -> FloatArray:
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) / corners
    return np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(0.4, 1.5, (corners, 1))


def hollow(seed: int, grid: float) -> FloatArray | None:
    """A block, a few long, with a corridor or a cavity cut into it; nothing in it is thinner than three of `grid`."""
    rng = np.random.default_rng(seed)
    width, height = rng.uniform(3.0, 4.5), rng.uniform(2.0, 3.5)
    block = shapely.box(0, 0, width, height)
    mouth, x = rng.uniform(0.3, 1.2), rng.uniform(0.8, width - 0.8)
    if seed % 2:
        inside = rng.uniform([0.6, 0.6], [width - 0.6, height - 0.6], (rng.integers(2, 5), 2))
        cut = shapely.LineString([(x, height + 1), (x, inside[0, 1]), *inside]).buffer(mouth / 3, join_style="mitre")
    else:
        cavity = shapely.MultiPoint(rng.uniform([0.4, 0.4], [width - 0.4, height - 0.5], (6, 2))).convex_hull
        cut = cavity | shapely.box(x - mouth / 2, height / 2, x + mouth / 2, height + 1)
    return _without_thin_parts(block.difference(cut), grid)


def _without_thin_parts(shape: shapely.Geometry, grid: float) -> FloatArray | None:
    r = 1.5 * grid
    for offset in (-r, 2 * r, -r):
        with np.errstate(all="ignore"):  # GEOS divides by zero on the way
            shape = shapely.buffer(shape, offset, join_style="mitre")
    shape = shapely.simplify(shape, grid / 10)
    if shape.geom_type != "Polygon" or shape.is_empty or shape.interiors or not shape.is_valid:
        return None
    return np.asarray(shapely.get_coordinates(shapely.orient_polygons(shape))[:-1])


def ways_out(loop: FloatArray, apart: float, grid: float) -> Callable[[FloatArray], BoolArray | None]:
    """Flood fill of all places of two points `apart`, on a grid of x, y and angle.

    The answer tells of a placement (2, 2) whether it is joined to the outside, None where it is not free.
    """
    low, high = loop.min(axis=0) - apart - 4 * grid, loop.max(axis=0) + apart + 4 * grid
    x, y = np.meshgrid(np.arange(low[0], high[0], grid), np.arange(low[1], high[1], grid), indexing="ij")
    free = ~shapely.contains_xy(shapely.Polygon(loop), x, y)
    angles = 2 * np.pi * np.arange(n := int(np.ceil(2 * np.pi * apart / grid))) / n
    reach = int(np.ceil(apart / grid)) + 1
    padded = np.pad(free, reach, constant_values=True)
    volume = np.empty((n, *free.shape), dtype=np.bool_)
    for layer, angle in zip(volume, angles, strict=True):
        i, j = (reach + round(apart / grid * each) for each in (np.cos(angle), np.sin(angle)))
        layer[:] = free & padded[i : i + free.shape[0], j : j + free.shape[1]]
    parts, count = label(volume)
    first, last = parts[0], parts[-1]
    seam = (first > 0) & (last > 0)  # the last angle is next to the first
    joined = coo_matrix((np.ones(seam.sum()), (first[seam], last[seam])), shape=(count + 1, count + 1))
    component = connected_components(joined, directed=False)[1]

    def escapes(points: FloatArray) -> BoolArray | None:
        p, q = points
        i, j = np.rint((p - low) / grid).astype(int)
        turned = np.arctan2(q[1] - p[1], q[0] - p[0]) / (2 * np.pi) * n
        part = parts[round(turned) % n, i, j]
        return None if part == 0 else component[part] == component[parts[0, 0, 0]]

    return escapes
