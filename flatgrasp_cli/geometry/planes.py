"""Planes through points in space: random sample consensus, and least squares."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.kernels.planes import consensus
from flatgrasp_cli.kernels.points import apart

HYPOTHESES = 250


def consensus_plane(
    points: FloatArray, tolerance_m: FloatArray | float, rng: np.random.Generator
) -> tuple[FloatArray, float] | None:
    """Unit normal (3,) and offset of the plane that most of `points` (n, 3) agree with; None if all are in line.

    A point agrees if it lies within its `tolerance_m` (n,) of a plane through three random ones (Fischler & Bolles,
    Communications of the ACM 24(6), 1981); least squares fit those that agree.
    """
    corners = rng.integers(len(points), size=(HYPOTHESES, 3), dtype=np.intp)
    agree = consensus(points, corners, np.broadcast_to(tolerance_m, len(points)).astype(np.float64))
    return least_squares_plane(points.take(agree, axis=0)) if len(agree) else None


def least_squares_plane(points: FloatArray) -> tuple[FloatArray, float]:
    """Unit normal (3,), of either sign, and offset of the plane with the least squared distances to `points` (n, 3)."""
    mean = mean_of(points)
    centred = apart(points, mean)
    normal = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return normal, float(normal @ mean)
