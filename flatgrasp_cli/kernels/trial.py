"""How probable it is that grasps hold: they are carried out in samples of what is not known, step by step."""

from __future__ import annotations

import math

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

INFINITY = cython.declare(cython.double, math.inf)
NARROW = cython.declare(cython.double, 1e-9)
"""Stands for a spread of 0, where what is needed is there or not."""


def moved(grasps: cython.double[:, ::1], misses: cython.double[:, ::1]) -> NDArray[np.float64]:
    """Where k hands come to stand (k, s, 5) in s samples: centre, closing axis, half the opening.

    That is what `grasps` (k, 5) ask for. A hand misses, by `misses` (s, 4), so much across its closing axis and along
    it, and is turned by an angle with that cosine and sine.
    """
    grasp: cython.Py_ssize_t
    sample: cython.Py_ssize_t
    found = np.empty((grasps.shape[0], misses.shape[0], 5))
    hands: cython.double[:, :, ::1] = found
    for grasp in range(grasps.shape[0]):
        ux: cython.double = grasps[grasp, 2]
        uy: cython.double = grasps[grasp, 3]
        for sample in range(misses.shape[0]):
            across: cython.double = misses[sample, 0]
            along: cython.double = misses[sample, 1]
            hands[grasp, sample, 0] = grasps[grasp, 0] - across * uy + along * ux
            hands[grasp, sample, 1] = grasps[grasp, 1] + across * ux + along * uy
            hands[grasp, sample, 2] = misses[sample, 2] * ux - misses[sample, 3] * uy
            hands[grasp, sample, 3] = misses[sample, 2] * uy + misses[sample, 3] * ux
            hands[grasp, sample, 4] = grasps[grasp, 4]
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _suffices(need: cython.double, friction: cython.double, spread: cython.double) -> cython.double:
    """How probable it is that pads have the friction that is needed, by the share that it is known to."""
    return min(max(((1 + spread) - need / friction) / max(2 * spread, NARROW), 0.0), 1.0)


def suffices(need: cython.double[::1], friction: cython.double, spread: cython.double) -> NDArray[np.float64]:
    """How probable it is (n,) that pads have the friction that grasps `need` (n,), if about `friction` is counted on.

    It is within a `spread`, a share of it; a spread of 0 says that it is there or not.
    """
    index: cython.Py_ssize_t
    found = np.empty(need.shape[0])
    answer: cython.double[::1] = found
    for index in range(need.shape[0]):
        answer[index] = _suffices(need[index], friction, spread)
    return found


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _lean(leans: cython.double[:, ::1], grasp: cython.Py_ssize_t, missing: cython.double) -> cython.double:
    """Of a grasp's leans at equal steps of what is missing of the grip, that at one share of it; or the last."""
    steps: cython.Py_ssize_t = leans.shape[1]
    higher: cython.double = steps * min(max(missing, 0.0), 1.0)
    step: cython.Py_ssize_t = min(cython.cast(cython.Py_ssize_t, higher), steps - 1)
    return leans[grasp, step] + (higher - step) * (leans[grasp, min(step + 1, steps - 1)] - leans[grasp, step])


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _needed(
    wedge: cython.double,
    lean: cython.double,
    grasps: cython.double[:, ::1],
    grasp: cython.Py_ssize_t,
    load: cython.double,
) -> cython.double:
    """The friction that a grasp needs whose sides squeeze the object out by a wedge and a lean, under a load.

    The load pulls the same ways as they: along the approach with the lean, across the closing axis with the wedge.
    """
    across: cython.double = wedge + grasps[grasp, 5] * load
    along: cython.double = lean + grasps[grasp, 4] * load
    return sqrt(across * across + along * along)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _foot(
    grasps: cython.double[:, ::1], grasp: cython.Py_ssize_t, side: cython.Py_ssize_t, luck: cython.double
) -> cython.double:
    """The height at which a grasp's wall on a side, 0 or 1, ends below: the lower, the more is there of what may be."""
    low, high = grasps[grasp, 7 + 2 * side], grasps[grasp, 8 + 2 * side]
    return high - luck * (high - low)


@cython.cfunc
@cython.inline
@cython.exceptval(check=False)
def _tried(
    met: cython.double[:, :, ::1],
    grasps: cython.double[:, ::1],
    grasp: cython.Py_ssize_t,
    leans: cython.double[:, ::1],
    samples: cython.double[:, ::1],
    sample: cython.Py_ssize_t,
    inside: cython.bint,
    usual: cython.double[::1],
    left: cython.double[:, ::1],
) -> cython.void:
    """Add to what is `left` (k, 6) how probably a grasp has not failed yet in one sample; arguments as in `chances`."""
    held: cython.double = max(grasps[grasp, 0] - max(met[6, grasp, sample], met[4, grasp, sample]), 0.0)
    lands: cython.bint = met[0, grasp, sample] == 0 or met[1, grasp, sample] < samples[sample, 0] * grasps[grasp, 2]
    beside: cython.double = usual[2] if lands else 1.0
    down: cython.double = beside * (1 - usual[3] * met[5, grasp, sample]) if held >= usual[4] else 0.0
    around: cython.double = down if met[2, grasp, sample] != 0 or inside or lands else 0.0
    width: cython.double = max(grasps[grasp, 6], usual[4])
    lean: cython.double = 0.0
    high: cython.double = held
    if grasps[grasp, 3] != 0:
        lean = _lean(leans, grasp, 1 - held / max(grasps[grasp, 1], usual[4]))
        lean = max(lean + samples[sample, 1] / max(0.5 * held, usual[4]), 0.0)
        one: cython.double = _foot(grasps, grasp, 0, samples[sample, 0])
        other: cython.double = _foot(grasps, grasp, 1, samples[sample, 0])
        # Pads that meet no part of both walls at one height push along a line that is as far from level.
        lean += max(max(one, other) - grasps[grasp, 0], 0.0) / width
        # Against tilting they push high up at the end that goes down, and low down at the other one.
        high = min(high, grasps[grasp, 0] - (one if met[9, grasp, sample] > 0 else other))
    wedge: cython.double = 0.0 if inside else met[3, grasp, sample]
    weight: cython.double = samples[sample, 2]
    # What turns slides meanwhile, too: to stay between the pads, what it slides must be less than what they hold.
    slide: cython.double = met[8, grasp, sample] / max(held, usual[4])
    need: cython.double = _needed(wedge, lean, grasps, grasp, weight)
    turned: cython.double = INFINITY
    if slide < INFINITY:
        turned = _needed(wedge, lean, grasps, grasp, weight * sqrt(1 + slide * slide))
    tilts: cython.double = (abs(met[9, grasp, sample]) - high) / width
    comes: cython.double = max(min(max(need, met[7, grasp, sample]), turned), tilts)
    left[grasp, 0] += beside
    left[grasp, 1] += down
    left[grasp, 2] += around
    left[grasp, 3] += around * _suffices(_needed(wedge, lean, grasps, grasp, 0.0), usual[0], usual[1])
    left[grasp, 4] += around * _suffices(need, usual[0], usual[1])
    left[grasp, 5] += around * _suffices(comes, usual[0], usual[1])


def chances(
    met: cython.double[:, :, ::1],
    grasps: cython.double[:, ::1],
    leans: cython.double[:, ::1],
    samples: cython.double[:, ::1],
    inside: cython.uchar[:, ::1],
    usual: cython.double[::1],
) -> NDArray[np.float64]:
    """How probably k grasps have not failed yet (k, 6): mean over s samples, after each of what they fail by.

    What the hands have `met` (10, k, s): whether the open fingers are free (1, else 0), the room between pad and
    object, whether the object is between them, the tangent of the wedge that its sides make, the height at which
    something stops the fingertips, the share of them that is dark, the height at which they would end, the friction
    that it takes not to turn, how far what turns slides, infinite where it must not, and how high pads must be that do
    not let it tilt, with the sign of the tilt. Of `grasps` (k, 11) are known the height that their pads reach up to,
    how much of that they cover, how far the object goes on out of sight, whether there is a height at all (1, else 0),
    the shares of its weight that pull along the approach and across the closing axis, how far apart the pads are, and
    between which heights the walls end below, first that at which the closing axis begins. The walls' `leans` (k, h)
    are tangents for fingertips that end where they should, and higher by equal shares of the grip. Of `samples` (s, 3)
    are known how much of what is hidden is there, the walls' error, and the friction that the weight needs. Where a
    hand is `inside` (k, s) a basin, closing ends in the grasp.

    What is `usual` (5,): friction, the share that it is known to, how often an object is held that a fingertip comes
    down on, how often something is in the dark, and the noise of heights.
    """
    grasp: cython.Py_ssize_t
    sample: cython.Py_ssize_t
    step: cython.Py_ssize_t
    found = np.zeros((grasps.shape[0], 6))
    left: cython.double[:, ::1] = found
    for grasp in range(grasps.shape[0]):
        for sample in range(samples.shape[0]):
            sure: cython.bint = inside[grasp, sample] != 0
            _tried(met, grasps, grasp, leans, samples, sample, sure, usual, left)
        for step in range(6):
            left[grasp, step] /= samples.shape[0]
    return found
