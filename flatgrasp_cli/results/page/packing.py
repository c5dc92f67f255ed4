"""A cloud in as few bytes as it needs on a screen.

Coordinates are 16-bit steps of one length, colours bytes. Points are sorted so that neighbours follow each other, and
only differences are kept, byte by byte in planes of their own, which deflate at least halves. The page's script
undoes it.
"""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import ByteArray, FloatArray, IntArray
from flatgrasp_cli.geometry.sampling import spread_indices

STEPS = 65_535
MOST_POINTS = 300_000
LEAST_STEP_M = 1e-9
CELL_M = 0.01
"""Points are sorted by cubes of so many metres."""


@dataclass(frozen=True, slots=True)
class Packed:
    """A cloud's points: `low` plus `step` times the numbers in `data`, which is deflated and in base64."""

    count: int
    low: list[float]
    step: float
    colored: bool
    data: str


def packed(points: FloatArray, colors: ByteArray | None) -> Packed:
    """Pack points (n, 3), metres, and their RGB (n, 3): an even sample if there are more than a page should have."""
    rows = spread_indices(len(points), MOST_POINTS)
    rows = rows[_neighbours_together(points[rows])]
    points = points[rows]
    low = points.min(axis=0) if len(points) else np.zeros(3)
    step = max(float((points - low).max(initial=0.0)) / STEPS, LEAST_STEP_M)
    steps = np.round((points - low) / step).astype("<u2")
    moved = np.diff(steps, axis=0, prepend=np.zeros((1, 3), "<u2"))
    signed = moved.astype("<i2")
    zigzag = ((signed << 1) ^ (signed >> 15)).astype("<u2")  # small numbers of either sign have an empty high byte
    planes = [zigzag.T & 0xFF, zigzag.T >> 8]
    if colors is not None:
        planes.append(np.diff(colors[rows], axis=0, prepend=np.zeros((1, 3), np.uint8)).T)
    raw = b"".join(plane.astype(np.uint8).tobytes() for plane in planes)
    data = base64.b64encode(zlib.compress(raw, 6)).decode("ascii")
    return Packed(count=len(rows), low=low.tolist(), step=step, colored=colors is not None, data=data)


def _neighbours_together(points: FloatArray) -> IntArray:
    x, y, z = np.floor(points.T / CELL_M).astype(np.int64)
    return np.asarray(np.lexsort((points[:, 0], z, x, y)))
