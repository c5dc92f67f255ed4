"""Straight moves of fingers beside an outline: the edges that they meet.

Edge k of the outline leads from `starts[k]` by `edges[k]` (n, 2) to the start of the edge `follow[k]` (n,). A line
meets an edge when exactly one end lies strictly left of it, so that a vertex on it counts once.
"""

from __future__ import annotations

import math

import cython
import numpy as np
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
PARALLEL = cython.declare(cython.double, 1e-200)
"""Lines that slant by less never meet, in a number that a double holds."""


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _crossings(
    starts: cython.double[:, ::1],
    edges: cython.double[:, ::1],
    follow: cython.Py_ssize_t[::1],
    lines: cython.double[:, ::1],
    line: cython.Py_ssize_t,
    ahead: cython.double[::1],
) -> cython.void:
    """Write where along a line, of `lines` (m, 4) origin and unit direction, it meets each edge; NaN where not."""
    edge: cython.Py_ssize_t
    ox: cython.double = lines[line, 0]
    oy: cython.double = lines[line, 1]
    ux: cython.double = lines[line, 2]
    uy: cython.double = lines[line, 3]
    level: cython.double = ux * oy - uy * ox
    for edge in range(starts.shape[0]):
        after: cython.Py_ssize_t = follow[edge]
        left: cython.bint = ux * starts[edge, 1] - uy * starts[edge, 0] > level
        end_left: cython.bint = ux * starts[after, 1] - uy * starts[after, 0] > level
        if left == end_left:
            ahead[edge] = math.nan
            continue
        slant: cython.double = ux * edges[edge, 1] - uy * edges[edge, 0]
        if abs(slant) < PARALLEL:
            slant = 1.0
        ahead[edge] = ((starts[edge, 0] - ox) * edges[edge, 1] - (starts[edge, 1] - oy) * edges[edge, 0]) / slant


def first_hits(
    starts: cython.double[:, ::1],
    edges: cython.double[:, ::1],
    follow: cython.Py_ssize_t[::1],
    lines: cython.double[:, ::1],
    skip: cython.Py_ssize_t[:, ::1],
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """How far (m,) movers along `lines` (m, 4) get until an edge, and that edge (m,); infinity where there is none.

    The edges `skip` (m, s) do not count.
    """
    mover: cython.Py_ssize_t
    edge: cython.Py_ssize_t
    place: cython.Py_ssize_t
    distances = np.full(lines.shape[0], math.inf)
    hits = np.zeros(lines.shape[0], dtype=np.intp)
    distance: cython.double[::1] = distances
    hit: cython.Py_ssize_t[::1] = hits
    ahead: cython.double[::1] = np.empty(starts.shape[0])
    for mover in range(lines.shape[0]):
        _crossings(starts, edges, follow, lines, mover, ahead)
        for place in range(skip.shape[1]):
            ahead[skip[mover, place]] = math.nan
        for edge in range(starts.shape[0]):
            if 0 < ahead[edge] < distance[mover]:
                distance[mover], hit[mover] = ahead[edge], edge
    return distances, hits


def met(
    starts: cython.double[:, ::1],
    edges: cython.double[:, ::1],
    follow: cython.Py_ssize_t[::1],
    lines: cython.double[:, ::1],
    begin: cython.double[::1],
    way: cython.double,
    facing: cython.double,
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Edge (m,), −1 for none, and place and depth (2, m), at which movers along `lines` (m, 4) meet the outline.

    They go from `begin` (m,) on forward, or back if the `way` is −1, and meet edges that they would go in through if
    `facing` is −1, out through if it is 1. A mover that begins inside has met what lies behind it, so deep.
    """
    mover: cython.Py_ssize_t
    edge: cython.Py_ssize_t
    hits = np.full(lines.shape[0], -1, dtype=np.intp)
    figures = np.zeros((2, lines.shape[0]))
    hit: cython.Py_ssize_t[::1] = hits
    answer: cython.double[:, ::1] = figures
    ahead: cython.double[::1] = np.empty(starts.shape[0])
    for mover in range(lines.shape[0]):
        _crossings(starts, edges, follow, lines, mover, ahead)
        inside: cython.bint = False
        for edge in range(starts.shape[0]):
            ahead[edge] = way * (ahead[edge] - begin[mover])
            if ahead[edge] > 0:
                inside = not inside
        least: cython.double = INFINITY
        for edge in range(starts.shape[0]):
            rise: cython.double = (
                lines[mover, 2] * edges[edge, 1] - lines[mover, 3] * edges[edge, 0]
            )  # out of it if > 0
            distance: cython.double = -ahead[edge] if inside else ahead[edge]
            if rise * facing > 0 and (distance > 0 or (inside and distance == 0)) and distance < least:
                least, hit[mover] = distance, edge
        answer[0, mover] = begin[mover] + way * (-least if inside else least)
        answer[1, mover] = least if inside and least < INFINITY else 0.0
    return hits, figures
