"""Where the pieces of a surface meet in the sensor's image."""

from __future__ import annotations

import cython
import numpy as np
from numpy.typing import NDArray


def borders(
    names: cython.const[cython.Py_ssize_t][:, ::1],  # type: ignore[valid-type]
    height: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    depth: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    jump: cython.double,
    count: cython.Py_ssize_t,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """What the steps are like from cells of `count` pieces to the four beside each, if that is none of the piece's.

    `names` (rows, columns) are less than the count, and 0 where there is no piece, as all around the image. The first
    answer (3, k) has the number of such steps out of each piece, that of those with a jump to something nearer, and
    the sum of the heights that they start from; the second (2, 2, k, k) those down or up and those to the side, from a
    piece to each other one: all of them, and those with no jump in `depth`. The third (k, k) is the sum of the heights
    at which the latter end.
    """
    row: cython.Py_ssize_t
    column: cython.Py_ssize_t
    side: cython.Py_ssize_t
    of_piece = np.zeros((3, count))
    of_pair = np.zeros((2, 2, count, count))
    beyond = np.zeros((count, count))
    out: cython.double[:, ::1] = of_piece
    met: cython.double[:, :, :, ::1] = of_pair
    ends: cython.double[:, ::1] = beyond
    for side in range(4):
        axis: cython.Py_ssize_t = (side + 1) // 2 % 2
        step: cython.Py_ssize_t = -1 if side < 2 else 1
        for row in range(1, names.shape[0] - 1):
            for column in range(1, names.shape[1] - 1):
                name: cython.Py_ssize_t = names[row, column]
                down: cython.Py_ssize_t = row + step * (1 - axis)
                right: cython.Py_ssize_t = column + step * axis
                there: cython.Py_ssize_t = names[down, right]
                if not name or name == there:
                    continue
                out[0, name] += 1.0
                out[2, name] += height[row, column]
                if there == 0:
                    continue
                met[0, axis, name, there] += 1.0
                if abs(depth[down, right] - depth[row, column]) < jump:
                    met[1, axis, name, there] += 1.0
                    ends[name, there] += height[down, right]
                elif depth[down, right] < depth[row, column]:
                    out[1, name] += 1.0
    return of_piece, of_pair, beyond
