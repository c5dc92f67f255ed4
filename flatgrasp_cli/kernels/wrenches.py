"""Force closure: the hull of a few wrenches, and how far its nearest facet is from the origin."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
FLAT = cython.declare(cython.double, 1e-12)
"""Three wrenches whose plane's normal is shorter lie on a line."""
IN_PLANE = cython.declare(cython.double, 1e-12)
"""Wrenches nearer to a plane than this lie in it: rounding moves them by less."""


def nearest_facets(wrenches: cython.double[:, :, ::1]) -> NDArray[np.float64]:
    """How far (k,) the nearest facet of the hull of each set of `wrenches` (k, w, 3) is from the origin; 0 if outside.

    Facets are found among all triples: the planes that have all wrenches on one side.
    """
    row: cython.Py_ssize_t
    a: cython.Py_ssize_t
    b: cython.Py_ssize_t
    c: cython.Py_ssize_t
    found = np.empty(wrenches.shape[0])
    answer: cython.double[::1] = found
    for row in range(wrenches.shape[0]):
        nearest: cython.double = INFINITY
        for a in range(wrenches.shape[1]):
            for b in range(a + 1, wrenches.shape[1]):
                for c in range(b + 1, wrenches.shape[1]):
                    nearest = min(nearest, _inward(wrenches, row, a, b, c))
        answer[row] = max(nearest, 0.0) if nearest < INFINITY else 0.0
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _inward(
    wrenches: cython.double[:, :, ::1],
    row: cython.Py_ssize_t,
    a: cython.Py_ssize_t,
    b: cython.Py_ssize_t,
    c: cython.Py_ssize_t,
) -> cython.double:
    """How far the origin is within the plane of three wrenches, by the side that all lie on; infinite if on both.

    It is 0 if all wrenches lie in one plane: their hull has no inside.
    """
    index: cython.Py_ssize_t
    ux: cython.double = wrenches[row, b, 0] - wrenches[row, a, 0]
    uy: cython.double = wrenches[row, b, 1] - wrenches[row, a, 1]
    uz: cython.double = wrenches[row, b, 2] - wrenches[row, a, 2]
    vx: cython.double = wrenches[row, c, 0] - wrenches[row, a, 0]
    vy: cython.double = wrenches[row, c, 1] - wrenches[row, a, 1]
    vz: cython.double = wrenches[row, c, 2] - wrenches[row, a, 2]
    nx: cython.double = uy * vz - uz * vy
    ny: cython.double = uz * vx - ux * vz
    nz: cython.double = ux * vy - uy * vx
    length: cython.double = sqrt(nx * nx + ny * ny + nz * nz)
    if length <= FLAT:
        return INFINITY
    nx, ny, nz = nx / length, ny / length, nz / length
    offset: cython.double = nx * wrenches[row, a, 0] + ny * wrenches[row, a, 1] + nz * wrenches[row, a, 2]
    below: cython.bint = True
    above: cython.bint = True
    for index in range(wrenches.shape[1]):
        height: cython.double = nx * wrenches[row, index, 0] + ny * wrenches[row, index, 1] - offset
        height += nz * wrenches[row, index, 2]
        below = below and height <= IN_PLANE
        above = above and height >= -IN_PLANE
    if below and above:
        return 0.0
    return offset if below else -offset if above else INFINITY
