"""How far an object goes on out of sight: an ellipse, or a level top, through what was seen of its side."""

from __future__ import annotations

import cython
import numpy as np
from cython.cimports.libc.math import isnan, sqrt
from numpy.typing import NDArray


def going_on(
    inward: cython.double[::1],
    heights: cython.double[:, ::1],
    slope: cython.double[::1],
    limb: cython.double,
    uneven: cython.double,
) -> NDArray[np.float64]:
    """How far (m,) flanks go on outward, by the `heights` (d, m), NaN where unknown, `inward` (d,) of their edges.

    A model is an ellipse that falls with the `slope` (m,) at the edge and has its top at one of the places inward;
    from `limb` inward on it may also be level behind its top. The answer is 0 unless one agrees better with the heights
    than a straight line does, and that misses them by more than `uneven`, its mean square; the edge itself blurs.
    """
    flank: cython.Py_ssize_t
    ahead: cython.Py_ssize_t
    way: cython.Py_ssize_t
    extent = np.zeros(heights.shape[1])
    answer: cython.double[::1] = extent
    line: cython.double[::1] = np.empty(2)
    for flank in range(heights.shape[1]):
        if slope[flank] <= 0:
            continue
        count: cython.double = _line(inward, heights, flank, line)
        least: cython.double = _strays_from_line(inward, heights, flank, line)
        if least <= uneven * count:
            continue
        half: cython.double = _half_height(heights, flank)
        for ahead in range(inward.shape[0]):
            ratio: cython.double = slope[flank] * inward[ahead] / half
            u: cython.double = sqrt(0.5 * ratio * (sqrt(ratio * ratio + 4) - ratio))
            axis: cython.double = inward[ahead] / max(u, 1e-9)
            for way in range(2 if inward[ahead] >= limb else 1):
                strays: cython.double = _strays_from_ellipse(inward, heights, flank, inward[ahead], axis, half, way)
                if strays < least:
                    least, answer[flank] = strays, axis * (1 - u)
    return extent


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _half_height(heights: cython.double[:, ::1], flank: cython.Py_ssize_t) -> cython.double:
    """Half of the highest that a flank was seen, or, where something of it was not seen, at least of the ground."""
    place: cython.Py_ssize_t
    top: cython.double = 0.0 if isnan(heights[0, flank]) else heights[0, flank]
    for place in range(1, heights.shape[0]):
        top = max(top, 0.0 if isnan(heights[place, flank]) else heights[place, flank])
    return 0.5 * max(top, 1e-9)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _line(
    inward: cython.double[::1], heights: cython.double[:, ::1], flank: cython.Py_ssize_t, line: cython.double[::1]
) -> cython.double:
    """Write the `line`, its height at the edge and its rise, through the heights behind the first.

    Returns how many heights are known, the first among them.
    """
    place: cython.Py_ssize_t
    count: cython.double = 0.0
    mean_x: cython.double = 0.0
    mean: cython.double = 0.0
    for place in range(1, inward.shape[0]):
        if not isnan(heights[place, flank]):
            count += 1.0
            mean_x += inward[place]
            mean += heights[place, flank]
    mean_x, mean = mean_x / max(count, 1.0), mean / max(count, 1.0)
    spread: cython.double = 0.0
    product: cython.double = 0.0
    for place in range(1, inward.shape[0]):
        if not isnan(heights[place, flank]):
            spread += (inward[place] - mean_x) ** 2
            product += (inward[place] - mean_x) * heights[place, flank]
    line[1] = product / spread if spread > 0 else product
    line[0] = mean - line[1] * mean_x
    return count + (0.0 if isnan(heights[0, flank]) else 1.0)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _strays_from_line(
    inward: cython.double[::1], heights: cython.double[:, ::1], flank: cython.Py_ssize_t, line: cython.double[::1]
) -> cython.double:
    """Sum of the squares by which the heights behind the first differ from the line."""
    place: cython.Py_ssize_t
    total: cython.double = 0.0
    for place in range(1, inward.shape[0]):
        if not isnan(heights[place, flank]):
            total += (heights[place, flank] - (line[0] + line[1] * inward[place])) ** 2
    return total


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _strays_from_ellipse(
    inward: cython.double[::1],
    heights: cython.double[:, ::1],
    flank: cython.Py_ssize_t,
    top: cython.double,
    axis: cython.double,
    half: cython.double,
    level: cython.bint,
) -> cython.double:
    """The same for an ellipse with its `top` so far inward, and `level` behind that or not."""
    place: cython.Py_ssize_t
    total: cython.double = 0.0
    for place in range(1, inward.shape[0]):
        if not isnan(heights[place, flank]):
            way: cython.double = (top - inward[place]) / axis
            way = max(way, 0.0) if level else way
            total += (heights[place, flank] - half * (1 + sqrt(max(1 - way * way, 0.0)))) ** 2
    return total


def most_nearby(
    extent: cython.double[::1],
    contact: cython.double[:, ::1],
    direction: cython.double[:, ::1],
    width: cython.double[::1],
) -> NDArray[np.float64]:
    """The largest `extent` (m,) of those whose contact lies within each one's `width` and that look its way."""
    one: cython.Py_ssize_t
    other: cython.Py_ssize_t
    found = np.zeros(extent.shape[0])
    most: cython.double[::1] = found
    for one in range(extent.shape[0]):
        for other in range(extent.shape[0]):
            alike: cython.double = direction[one, 0] * direction[other, 0] + direction[one, 1] * direction[other, 1]
            if extent[other] > most[one] and alike > 0:
                dx: cython.double = contact[one, 0] - contact[other, 0]
                dy: cython.double = contact[one, 1] - contact[other, 1]
                if dx * dx + dy * dy <= width[one] * width[one]:
                    most[one] = extent[other]
    return found
