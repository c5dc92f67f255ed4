"""Whether what is gripped comes up: how its weight turns it in the hand, and the friction that it takes to bear it."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import asinh, atan2, hypot
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
LEAST_M = cython.declare(cython.double, 2.0**-52)
"""Pads that hold nothing cover no height: it is taken for so little, metres."""


def needs(
    hands: cython.double[:, :, ::1],
    grips: cython.double[:, ::1],
    size: cython.double[::1],
    middle: cython.double[::1],
    pulls: cython.double[:, ::1],
    weight: cython.double[::1],
    down: cython.double[::1],
    lift: cython.double,
) -> NDArray[np.float64]:
    """What k grips need to lift an object in s samples: rows friction against turning, slide and tilt (3, k, s).

    They are what `ranking.lifting.Needs` says. Of `hands` (k, s, 5), where they really stand, are known the centre and
    the closing axis, and of `grips` (k, 7), where they should, besides those the height of the fingertips, and width
    and height of what the pads cover. The object's box of this `size` (3,) has its centre at the plane's origin, and
    its centre of gravity is about `middle` (2,). Its weight pulls at `pulls` (s, 2), along `down` (3,), and takes the
    friction `weight` (s,). It is lifted by so much.
    """
    grasp: cython.Py_ssize_t
    sample: cython.Py_ssize_t
    found = np.empty((3, hands.shape[0], hands.shape[1]))
    need: cython.double[:, :, ::1] = found
    for grasp in range(hands.shape[0]):
        radius: cython.double = _mean_radius(grips[grasp, 5], grips[grasp, 6])
        over: cython.double = 0.5 * size[2] - grips[grasp, 4] - 0.5 * grips[grasp, 6]
        # how far the object goes on from the line of the contacts, on the side of its middle
        aslant: cython.double = hypot(down[0], down[1]) * (abs(over) + 0.5 * size[2])
        beyond: cython.double = hypot(_goes_on(grips, grasp, size, middle), aslant)
        highest: cython.double = 0.5 * max(beyond, lift)
        for sample in range(hands.shape[1]):
            ux: cython.double = hands[grasp, sample, 2]
            uy: cython.double = hands[grasp, sample, 3]
            dx: cython.double = pulls[sample, 0] - hands[grasp, sample, 0]
            dy: cython.double = pulls[sample, 1] - hands[grasp, sample, 1]
            beside: cython.double = ux * dy - uy * dx
            between: cython.double = ux * dx + uy * dy
            aside: cython.double = down[0] * uy - down[1] * ux
            along: cython.double = down[0] * ux + down[1] * uy
            # about the line through the pads; it would turn until its weight pulls straight away from them
            arm: cython.double = abs(down[2] * beside + over * aside)
            turn: cython.double = atan2(arm, down[2] * over - aside * beside)
            need[0, grasp, sample] = weight[sample] * arm / radius
            need[1, grasp, sample] = INFINITY if arm > highest else radius * turn
            # about the pads' other axis, along the plane
            need[2, grasp, sample] = 2 * weight[sample] * (over * along - down[2] * between)
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _goes_on(
    grips: cython.double[:, ::1], grasp: cython.Py_ssize_t, size: cython.double[::1], middle: cython.double[::1]
) -> cython.double:
    """How far a box goes on in the plane from the line through a grip's pads, on its middle's side."""
    x: cython.double = -grips[grasp, 3]  # to the left of the closing axis
    y: cython.double = grips[grasp, 2]
    pads: cython.double = grips[grasp, 0] * x + grips[grasp, 1] * y
    half: cython.double = 0.5 * (abs(x) * size[0] + abs(y) * size[1])
    return half + pads if middle[0] * x + middle[1] * y < pads else half - pads


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _mean_radius(wide: cython.double, high: cython.double) -> cython.double:
    """The mean distance of a rectangle's points from its middle, by its sides."""
    wide, high = max(wide, LEAST_M), max(high, LEAST_M)
    along: cython.double = wide * wide / high * asinh(high / wide)
    return (2 * hypot(wide, high) + along + high * high / wide * asinh(wide / high)) / 12
