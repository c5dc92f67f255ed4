"""§III.A.3 and B.4: the boundary under a chord, and how far it strays from that."""

from __future__ import annotations

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray


def arcs(
    loop: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    arc: cython.double[::1],
    begins: cython.double[::1],
    ends: cython.double[::1],
    along: cython.double[::1],
) -> NDArray[np.float64]:
    """Points (m, k, 2) of the boundary from arc lengths `begins` to `ends` (m,), at rising shares `along` (k,) of that.

    The `loop` (n, 2) has its vertices at `arc` (n + 1,), the last entry being the perimeter. Arcs begin on it, and end
    no more than once around from there.
    """
    chord: cython.Py_ssize_t
    point: cython.Py_ssize_t
    first: cython.Py_ssize_t = 0
    count: cython.Py_ssize_t = loop.shape[0]
    found = np.empty((begins.shape[0], along.shape[0], 2))
    place: cython.double[:, :, ::1] = found
    for chord in range(begins.shape[0]):
        if begins[chord] < arc[first]:
            first = 0
        while first + 1 < count and arc[first + 1] <= begins[chord]:  # as a rule chords are in order
            first += 1
        edge: cython.Py_ssize_t = first
        for point in range(along.shape[0]):
            at: cython.double = begins[chord] + along[point] * (ends[chord] - begins[chord])
            if at >= arc[count]:
                at -= arc[count]
                edge = 0 if at < arc[edge] else edge
            while edge + 1 < count and arc[edge + 1] <= at:
                edge += 1
            after: cython.Py_ssize_t = edge + 1 if edge + 1 < count else 0
            length: cython.double = arc[edge + 1] - arc[edge]
            place[chord, point, 0] = (loop[after, 0] - loop[edge, 0]) / length * (at - arc[edge]) + loop[edge, 0]
            place[chord, point, 1] = (loop[after, 1] - loop[edge, 1]) / length * (at - arc[edge]) + loop[edge, 1]
    return found


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
