"""Of grasps in their order, those that differ: non-maximum suppression."""

from __future__ import annotations

import cython
import numpy as np
from numpy.typing import NDArray


def differing(
    center: cython.double[:, ::1],
    axis: cython.double[:, ::1],
    order: cython.Py_ssize_t[::1],
    apart_m: cython.double,
    apart_sine: cython.double,
    most: cython.Py_ssize_t,
) -> NDArray[np.intp]:
    """The first `most` rows of `order` (k,) that are like none before them.

    Hands with a `center` and a closing `axis` (p, 2) are alike if they are nearer than `apart_m` and the sine of the
    angle between their axes is smaller than `apart_sine`.
    """
    index: cython.Py_ssize_t
    place: cython.Py_ssize_t
    other: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    rows = np.empty(min(most, order.shape[0]), dtype=np.intp)
    kept: cython.Py_ssize_t[::1] = rows
    for index in range(order.shape[0]):
        if found == kept.shape[0]:
            break
        one: cython.Py_ssize_t = order[index]
        like: cython.bint = False
        for place in range(found):
            other = kept[place]
            sine: cython.double = axis[one, 0] * axis[other, 1] - axis[one, 1] * axis[other, 0]
            x: cython.double = center[one, 0] - center[other, 0]
            y: cython.double = center[one, 1] - center[other, 1]
            if x * x + y * y < apart_m * apart_m and abs(sine) < apart_sine:
                like = True
                break
        if not like:
            kept[found] = one
            found += 1
    found_rows: NDArray[np.intp] = rows[:found]
    return found_rows
