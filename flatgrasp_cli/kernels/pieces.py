"""Points of an object that stand out above a level, sorted into the pieces that they are in."""

from __future__ import annotations

import cython
import numpy as np
from numpy.typing import NDArray


def standing_out(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    cells: cython.Py_ssize_t[::1],
    labels: cython.int[::1],
    level: cython.double,
    count: cython.Py_ssize_t,
) -> tuple[NDArray[np.int32], NDArray[np.intp]]:
    """The piece of each of the `points` (n, 3), 0 of those that are no higher than a `level`, and how many each has.

    Each point's cell is in `cells` (n,), and each cell's piece in `labels` (c,); there are `count` pieces, 0 with them.
    """
    point: cython.Py_ssize_t
    pieces, counts = np.zeros(points.shape[0], dtype=np.int32), np.zeros(count, dtype=np.intp)
    piece: cython.int[::1] = pieces
    counted: cython.Py_ssize_t[::1] = counts
    for point in range(points.shape[0]):
        if points[point, 2] > level:
            piece[point] = labels[cells[point]]
        counted[piece[point]] += 1
    return pieces, counts
