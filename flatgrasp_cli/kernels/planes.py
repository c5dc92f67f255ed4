"""Planes through points: the one that most agree with, and what lies near one."""

from __future__ import annotations

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

IN_LINE_M2 = cython.declare(cython.double, 1e-12)
"""Twice the area of a triangle, square metres, below which its corners lie on a line."""


def near_plane(
    points: cython.const[cython.double][:, :],  # type: ignore[valid-type]
    normal: cython.const[cython.double][:],  # type: ignore[valid-type]
    offset: cython.double,
    distance: cython.double,
) -> NDArray[np.float64]:
    """Those of `points` (n, 3) that are nearer than a `distance` to a plane with a unit `normal` (3,) and an offset."""
    row: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    kept = np.empty((points.shape[0], 3))
    point: cython.double[:, ::1] = kept
    nx, ny, nz = normal[0], normal[1], normal[2]
    for row in range(points.shape[0]):
        if abs(nx * points[row, 0] + ny * points[row, 1] + nz * points[row, 2] - offset) < distance:
            point[found, 0], point[found, 1], point[found, 2] = points[row, 0], points[row, 1], points[row, 2]
            found += 1
    return kept[:found]


def consensus(
    points: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    corners: cython.const[cython.Py_ssize_t][:, ::1],  # type: ignore[valid-type]
    tolerance: cython.const[cython.double][::1],  # type: ignore[valid-type]
) -> NDArray[np.intp]:
    """Rows of the `points` (n, 3) that agree with the plane which most agree with; none if no three make one.

    Each row of `corners` (h, 3) are three points through which a plane goes. A point agrees if it lies within its
    `tolerance` (n,) of that. A plane is given up as soon as so many do not that it cannot have more than the best one.
    """
    trial: cython.Py_ssize_t
    row: cython.Py_ssize_t
    count: cython.Py_ssize_t = points.shape[0]
    most: cython.Py_ssize_t = 0
    plane: cython.double[::1] = np.empty(4)
    best: cython.double[::1] = np.zeros(4)
    for trial in range(corners.shape[0]):
        if not _through(points, corners, trial, plane):
            continue
        agreed: cython.Py_ssize_t = _agreed(points, plane, tolerance, most)
        if agreed > most:
            most = agreed
            best[:] = plane
    agree: cython.Py_ssize_t[::1] = np.empty(most, dtype=np.intp)
    found: cython.Py_ssize_t = 0
    if most > 0:
        for row in range(count):
            if _lies_in(points, row, best, tolerance):
                agree[found] = row
                found += 1
    return np.asarray(agree)


@cython.cfunc
def _through(
    points: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    corners: cython.const[cython.Py_ssize_t][:, ::1],  # type: ignore[valid-type]
    trial: cython.Py_ssize_t,
    plane: cython.double[::1],
) -> cython.bint:
    """Write the unit normal and the offset of the `plane` (4,) through three points; whether they are not in line."""
    a: cython.Py_ssize_t = corners[trial, 0]
    b: cython.Py_ssize_t = corners[trial, 1]
    c: cython.Py_ssize_t = corners[trial, 2]
    ux: cython.double = points[b, 0] - points[a, 0]
    uy: cython.double = points[b, 1] - points[a, 1]
    uz: cython.double = points[b, 2] - points[a, 2]
    vx: cython.double = points[c, 0] - points[a, 0]
    vy: cython.double = points[c, 1] - points[a, 1]
    vz: cython.double = points[c, 2] - points[a, 2]
    x: cython.double = uy * vz - uz * vy
    y: cython.double = uz * vx - ux * vz
    z: cython.double = ux * vy - uy * vx
    length: cython.double = sqrt(x * x + y * y + z * z)
    if not length > IN_LINE_M2:
        return False
    plane[0], plane[1], plane[2] = x / length, y / length, z / length
    plane[3] = plane[0] * points[a, 0] + plane[1] * points[a, 1] + plane[2] * points[a, 2]
    return True


@cython.cfunc
def _agreed(
    points: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    plane: cython.double[::1],
    tolerance: cython.const[cython.double][::1],  # type: ignore[valid-type]
    most: cython.Py_ssize_t,
) -> cython.Py_ssize_t:
    """How many points agree with a plane, or 0 if no more than `most` can."""
    row: cython.Py_ssize_t
    spare: cython.Py_ssize_t = points.shape[0] - most
    for row in range(points.shape[0]):
        if not _lies_in(points, row, plane, tolerance):
            spare -= 1
            if spare == 0:
                return 0
    return most + spare


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _lies_in(
    points: cython.const[cython.double][:, ::1],  # type: ignore[valid-type]
    row: cython.Py_ssize_t,
    plane: cython.double[::1],
    tolerance: cython.const[cython.double][::1],  # type: ignore[valid-type]
) -> cython.bint:
    """Whether a point lies within its tolerance of a plane."""
    height: cython.double = plane[0] * points[row, 0] + plane[1] * points[row, 1] + plane[2] * points[row, 2] - plane[3]
    return abs(height) < tolerance[row]
