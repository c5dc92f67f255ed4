"""§III.B.1 and B.2: force and torque balance of any two finger candidates."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import acos, cos, sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
DEGREES = cython.declare(cython.double, 180.0 / math.pi)
ROUNDING = cython.declare(cython.double, 1e-9)
"""Cosines that differ from a limit by no more than this are looked at closely."""


def balanced(
    contact: cython.double[:, ::1],
    direction: cython.double[:, ::1],
    jaw: cython.Py_ssize_t[::1],
    facing: cython.bint,
    limit_deg: cython.double,
    counts: cython.Py_ssize_t[::1],
) -> NDArray[np.intp]:
    """The pairs (2, k) of m finger candidates whose force balance γ is at most `limit_deg`, in the order of their i, j.

    A candidate has a `contact` and an inward `direction` (m, 2), and is for a `jaw` (m,) 0 or 1, or −1 for either. If
    `facing`, a pair counts only if its candidates press toward each other. If no γ is small enough, the pairs with the
    smallest one are named. Writes into `counts` (2,) how many pairs there are, and how many of them face each other.
    """
    found: cython.Py_ssize_t
    largest: cython.double[::1] = np.array([-2.0])
    # never written to where there are no pairs: memory that is not touched costs nothing
    pairs = np.empty((2, contact.shape[0] * contact.shape[0]), dtype=np.intp)
    found = _collect(contact, direction, jaw, facing, limit_deg, counts, largest, pairs)
    if found == 0:
        limit_deg = _gamma_deg(largest[0])
        found = _collect(contact, direction, jaw, facing, limit_deg, counts, largest, pairs)
    kept: NDArray[np.intp] = pairs[:, :found].copy()
    return kept


@cython.cfunc
def _collect(
    contact: cython.double[:, ::1],
    direction: cython.double[:, ::1],
    jaw: cython.Py_ssize_t[::1],
    facing: cython.bint,
    limit_deg: cython.double,
    counts: cython.Py_ssize_t[::1],
    largest: cython.double[::1],
    pairs: cython.Py_ssize_t[:, ::1],
) -> cython.Py_ssize_t:
    """Write the pairs within the limit, and the `largest` cosine of any; returns how many there are."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    count: cython.Py_ssize_t = 0
    face: cython.Py_ssize_t = 0
    near: cython.double = cos(limit_deg / DEGREES) - ROUNDING
    sure: cython.double = near + 2 * ROUNDING
    for i in range(contact.shape[0]):
        if jaw[i] == 1:
            continue
        # of two equal jaws each pair counts once
        for j in range(i + 1 if jaw[i] < 0 else 0, contact.shape[0]):
            if jaw[j] == 0:
                continue
            count += 1
            ex: cython.double = contact[j, 0] - contact[i, 0]
            ey: cython.double = contact[j, 1] - contact[i, 1]
            if facing and not (
                direction[i, 0] * ex + direction[i, 1] * ey > 0 and direction[j, 0] * ex + direction[j, 1] * ey < 0
            ):
                continue
            face += 1
            cosine: cython.double = -(direction[i, 0] * direction[j, 0] + direction[i, 1] * direction[j, 1])
            largest[0] = max(largest[0], cosine)
            if cosine > sure or (cosine >= near and _gamma_deg(cosine) <= limit_deg):
                pairs[0, found] = i
                pairs[1, found] = j
                found += 1
    counts[0] = count
    counts[1] = face
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _gamma_deg(cosine: cython.double) -> cython.double:
    return DEGREES * acos(min(max(cosine, -1.0), 1.0))


def weighed(
    contact: cython.double[:, ::1], direction: cython.double[:, ::1], pairs: cython.Py_ssize_t[:, ::1]
) -> NDArray[np.float64]:
    """What is known of each of k `pairs` (2, k), of candidates as in `balanced`: rows (8, k).

    The middle between the contacts x, y; the axis from the first to the second x, y; their distance; γ in degrees; the
    torque arm (d/2)·|sin a_i + sin a_j|, that of two unit forces about the middle; and the required friction
    tan(max(|a_i|, |a_j|)), infinite where a finger would have to pull.
    """
    index: cython.Py_ssize_t
    found = np.empty((8, pairs.shape[1]))
    row: cython.double[:, ::1] = found
    for index in range(pairs.shape[1]):
        i: cython.Py_ssize_t = pairs[0, index]
        j: cython.Py_ssize_t = pairs[1, index]
        ex: cython.double = contact[j, 0] - contact[i, 0]
        ey: cython.double = contact[j, 1] - contact[i, 1]
        distance: cython.double = sqrt(ex * ex + ey * ey)
        if distance > 0:
            ex /= distance
            ey /= distance
        sin_i: cython.double = ex * direction[i, 1] - ey * direction[i, 0]
        sin_j: cython.double = ey * direction[j, 0] - ex * direction[j, 1]
        cos_i: cython.double = ex * direction[i, 0] + ey * direction[i, 1]
        cos_j: cython.double = -(ex * direction[j, 0] + ey * direction[j, 1])
        row[0, index] = 0.5 * (contact[i, 0] + contact[j, 0])
        row[1, index] = 0.5 * (contact[i, 1] + contact[j, 1])
        row[2, index] = ex
        row[3, index] = ey
        row[4, index] = distance
        row[5, index] = _gamma_deg(-(direction[i, 0] * direction[j, 0] + direction[i, 1] * direction[j, 1]))
        row[6, index] = 0.5 * distance * abs(sin_i + sin_j)
        row[7, index] = max(_tangent(sin_i, cos_i), _tangent(sin_j, cos_j))
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _tangent(sine: cython.double, cosine: cython.double) -> cython.double:
    return abs(sine) / cosine if cosine > 0 else INFINITY
