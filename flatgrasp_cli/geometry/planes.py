"""Planes through points in space: random sample consensus, and least squares."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import mean_of

HYPOTHESES = 250


def consensus_plane(
    points: FloatArray, tolerance_m: FloatArray | float, rng: np.random.Generator
) -> tuple[FloatArray, float] | None:
    """Unit normal (3,) and offset of the plane that most of `points` (n, 3) agree with; None if all are in line.

    A point agrees if it lies within its `tolerance_m` (n,) of a plane through three random ones. All hypotheses are
    scored at once (Fischler & Bolles, Communications of the ACM 24(6), 1981); least squares fit those that agree.
    """
    middle = mean_of(points)  # single precision is about it, wherever the cloud lies
    corners = points[rng.integers(len(points), size=(HYPOTHESES, 3))]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    real = lengths > 1e-12
    if not real.any():
        return None
    normals = normals[real] / lengths[real, None]
    offsets = np.einsum("ij,ij->i", normals, corners[real, 0] - middle)
    # single precision tells millimetres on a scene's scale, and a matrix of it takes half the time
    distance = normals.astype(np.float32) @ (points - middle).T.astype(np.float32)
    distance -= offsets.astype(np.float32)[:, None]
    agree = np.abs(distance, out=distance) < np.asarray(tolerance_m, dtype=np.float32)
    return least_squares_plane(points[agree[np.argmax(np.count_nonzero(agree, axis=1))]])


def least_squares_plane(points: FloatArray) -> tuple[FloatArray, float]:
    """Unit normal (3,), of either sign, and offset of the plane with the least squared distances to `points` (n, 3)."""
    mean = mean_of(points)
    centred = points - mean
    normal = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return normal, float(normal @ mean)
