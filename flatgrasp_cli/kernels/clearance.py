"""How far an outline stays off the boxes that fingers sweep, seen in the frames of many hands."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray


def clearance(
    x: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    y: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    joined: cython.const[cython.uchar][::1],  # type: ignore[valid-type]
    across: cython.double[::1],
    along: cython.double[:, ::1],
) -> NDArray[np.float64]:
    """Distance (k,) of a chain of loops to a box in each of k frames; 0 where they overlap.

    The chain's vertices are `x` and `y` (n, k); `joined` (n - 1,) tells which rows an edge leads on from. A box reaches
    `across` x, from and to (2,), and `along` y (2, k).
    """
    frame: cython.Py_ssize_t
    row: cython.Py_ssize_t
    found = np.zeros(x.shape[1])
    answer: cython.double[::1] = found
    for frame in range(x.shape[1]):
        low, high, near, far = across[0], across[1], along[0, frame], along[1, frame]
        inside: cython.bint = False
        least: cython.double = math.inf
        for row in range(x.shape[0]):
            aside: cython.double = max(max(low - x[row, frame], x[row, frame] - high), 0.0)
            ahead: cython.double = max(max(near - y[row, frame], y[row, frame] - far), 0.0)
            least = min(least, aside * aside + ahead * ahead)
        for row in range(x.shape[0] - 1):
            if not joined[row]:
                continue
            ax, ay = x[row, frame], y[row, frame]
            run, rise = x[row + 1, frame] - ax, y[row + 1, frame] - ay
            if _meets(ax, ay, run, rise, low, high, near, far):
                least = 0.0
                break
            inside = inside != _passes_above(ax, ay, run, rise, 0.5 * (low + high), 0.5 * (near + far))
            least = min(least, _squared(low - ax, near - ay, run, rise))
            least = min(least, _squared(low - ax, far - ay, run, rise))
            least = min(least, _squared(high - ax, near - ay, run, rise))
            least = min(least, _squared(high - ax, far - ay, run, rise))
        answer[frame] = 0.0 if inside else sqrt(least)
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _meets(
    x: cython.double,
    y: cython.double,
    run: cython.double,
    rise: cython.double,
    low: cython.double,
    high: cython.double,
    near: cython.double,
    far: cython.double,
) -> cython.bint:
    """Whether an edge from a place on comes into a box: by its lowest and highest y within the box's strip."""
    if max(x, x + run) <= low or min(x, x + run) >= high:
        return False
    slope: cython.double = rise / (run if run != 0 else 1.0)
    begin: cython.double = y + slope * (min(max(x, low), high) - x)
    end: cython.double = y + rise + slope * (min(max(x + run, low), high) - (x + run))
    return min(begin, end) <= far and max(begin, end) >= near


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _passes_above(
    x: cython.double,
    y: cython.double,
    run: cython.double,
    rise: cython.double,
    at_x: cython.double,
    at_y: cython.double,
) -> cython.bint:
    """Whether an edge from a place on crosses the ray from another one upward."""
    if (x > at_x) == (x + run > at_x):
        return False
    return y + (at_x - x) * (rise / run) > at_y


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _squared(x: cython.double, y: cython.double, run: cython.double, rise: cython.double) -> cython.double:
    """The square of the distance of a place to an edge from the origin on."""
    length: cython.double = run * run + rise * rise
    where: cython.double = min(max((x * run + y * rise) / (length if length > 0 else 1.0), 0.0), 1.0)
    x, y = x - where * run, y - where * rise
    return x * x + y * y
