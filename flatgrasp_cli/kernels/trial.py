"""How probable it is that grasps hold: they are carried out in samples of what is not known, step by step."""

from __future__ import annotations

import cython
import numpy as np
from cython.cimports.libc.math import sqrt
from numpy.typing import NDArray

NARROW = cython.declare(cython.double, 1e-9)
"""Stands for a spread of 0, where what is needed is there or not."""


@cython.cfunc
@cython.inline
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
def _lean(leans: cython.double[::1], missing: cython.double) -> cython.double:
    """Of leans (h,) at equal steps of what is missing of the grip, that at one share of it; the last for all beyond."""
    steps: cython.Py_ssize_t = leans.shape[0]
    higher: cython.double = steps * min(max(missing, 0.0), 1.0)
    step: cython.Py_ssize_t = min(cython.cast(cython.Py_ssize_t, higher), steps - 1)
    return leans[step] + (higher - step) * (leans[min(step + 1, steps - 1)] - leans[step])


@cython.cfunc
def _tried(
    met: cython.double[:],
    grasp: cython.double[::1],
    leans: cython.double[::1],
    sample: cython.double[::1],
    inside: cython.bint,
    usual: cython.double[::1],
    left: cython.double[::1],
) -> cython.void:
    """Add to what is `left` (6,) how probably one grasp has not failed yet in one sample; arguments as in `chances`."""
    held: cython.double = max(grasp[0] - max(met[6], met[4]), 0.0)
    lands: cython.bint = met[0] == 0 or met[1] < sample[0] * grasp[2]
    beside: cython.double = usual[2] if lands else 1.0
    down: cython.double = beside * (1 - usual[4] * met[5]) if held >= usual[5] else 0.0
    around: cython.double = down if met[2] != 0 or inside or lands else 0.0
    lean: cython.double = 0.0
    if grasp[3] != 0:
        lean = _lean(leans, 1 - held / max(grasp[1], usual[5]))
        lean = max(lean + sample[1] / max(0.5 * held, usual[5]), 0.0)
    wedge: cython.double = 0.0 if inside else met[3]
    need: cython.double = sqrt(wedge * wedge + lean * lean)
    left[0] += beside
    left[1] += down
    left[2] += around
    left[3] += around * _suffices(need, usual[0], usual[1])
    need = max(need, sample[2])
    lifted: cython.double = around * _suffices(need, usual[0], usual[1])
    still: cython.double = around * _suffices(max(need, met[7]), usual[0], usual[1])
    left[4] += lifted
    left[5] += still + usual[3] * (lifted - still)


def chances(
    met: cython.double[:, :, ::1],
    grasps: cython.double[:, ::1],
    leans: cython.double[:, ::1],
    samples: cython.double[:, ::1],
    inside: cython.uchar[:, ::1],
    usual: cython.double[::1],
) -> NDArray[np.float64]:
    """How probably k grasps have not failed yet (k, 6): mean over s samples, after each of what they fail by.

    What the hands have `met` (8, k, s): whether the open fingers are free (1, else 0), the room between pad and object,
    whether the object is between them, the tangent of the wedge that its sides make, the height at which something
    stops the fingertips, the share of them that is dark, the height at which they would end, and the friction that
    turning needs. Of `grasps` (k, 4) are known the height that their pads reach up to, how much of that they cover, how
    far the object goes on out of sight, and whether there is a height at all (1, else 0). The walls' `leans` (k, h) are
    tangents for fingertips that end where they should, and higher by equal shares of the grip. Of `samples` (s, 3) are
    known how much of what is hidden is there, the walls' error, and the friction that the weight needs. Where a hand is
    `inside` (k, s) a basin, closing ends in the grasp.

    What is `usual` (6,): friction, the share that it is known to, how often an object is held that a fingertip comes
    down on and one that turns, how often something is in the dark, and the noise of heights.
    """
    grasp: cython.Py_ssize_t
    sample: cython.Py_ssize_t
    step: cython.Py_ssize_t
    found = np.zeros((grasps.shape[0], 6))
    left: cython.double[:, ::1] = found
    for grasp in range(grasps.shape[0]):
        for sample in range(samples.shape[0]):
            sure: cython.bint = inside[grasp, sample] != 0
            what: cython.double[:] = met[:, grasp, sample]
            _tried(what, grasps[grasp], leans[grasp], samples[sample], sure, usual, left[grasp])
        for step in range(6):
            left[grasp, step] /= samples.shape[0]
    return found
