"""§III.B.4: how far the boundary strays from the chords that are laid on it."""

from __future__ import annotations

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray


def strays(arcs: cython.double[:, :, ::1]) -> NDArray[np.float64]:
    """How far each of the `arcs` (m, k, 2) strays from its chord, rows mean, root mean square and maximum (3, m).

    Mean and mean square are those of the middles of its k − 1 pieces, which are equally long.
    """
    chord: cython.Py_ssize_t
    point: cython.Py_ssize_t
    last: cython.Py_ssize_t = arcs.shape[1] - 1
    found = np.zeros((3, arcs.shape[0]))
    answer: cython.double[:, ::1] = found
    for chord in range(arcs.shape[0]):
        x: cython.double = arcs[chord, last, 0] - arcs[chord, 0, 0]
        y: cython.double = arcs[chord, last, 1] - arcs[chord, 0, 1]
        length: cython.double = sqrt(x * x + y * y)
        before: cython.double = 0.0
        for point in range(1, last + 1):
            dx: cython.double = arcs[chord, point, 0] - arcs[chord, 0, 0]
            dy: cython.double = arcs[chord, point, 1] - arcs[chord, 0, 1]
            offset: cython.double = (dy * x - dx * y) / length
            middle: cython.double = 0.5 * abs(before + offset)
            answer[0, chord] += middle / last
            answer[1, chord] += middle * middle / last
            answer[2, chord] = max(answer[2, chord], abs(offset))
            before = offset
        answer[1, chord] = sqrt(answer[1, chord])
    return found
