"""Tables of finger candidates and of grasp candidates, a row each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray

T = TypeVar("T", "FingerCandidates", "GraspCandidates")


def _select(table: T, keep: BoolArray | IntArray) -> T:
    """The rows of a table of equally long arrays that a mask or an index array names."""
    rows = np.flatnonzero(keep) if keep.dtype == np.bool_ else keep
    return type(table)(*(getattr(table, name).take(rows, axis=0) for name in table.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class FingerCandidates:
    """m places for a finger: chords of length `width` (m,) of the boundary.

    `start`, `end`, `contact` (their midpoint) and the inward unit `direction` are (m, 2); `arcs` (m, k, 2) sample the
    boundary from start to end; `variance` (m,) measures how far the boundary strays from the chord; `arc_ratio` (m,) is
    its length over the chord's; `jaw` (m,) is 0 or 1 for the jaw that the candidate is for, −1 for either; `hidden`
    (m,) is how far the object probably goes on beyond the boundary, out of the sensor's sight, and `seen` (m,) whether
    it was seen that the object ends there.
    """

    loop: IntArray
    start: FloatArray
    end: FloatArray
    contact: FloatArray
    direction: FloatArray
    width: FloatArray
    jaw: IntArray
    arcs: FloatArray
    variance: FloatArray
    arc_ratio: FloatArray
    hidden: FloatArray
    seen: BoolArray

    def __len__(self) -> int:
        """Number of candidates."""
        return len(self.jaw)

    def select(self, keep: BoolArray | IntArray) -> FingerCandidates:
        """The candidates that `keep`, a mask or an index array, names."""
        return _select(self, keep)


@dataclass(frozen=True, slots=True, eq=False)
class GraspCandidates:
    """p pairs of finger candidates with what is known of each; every field has p rows.

    `i` and `j` index the finger candidates; the closing axis `axis` (p, 2) points from i's side to j's.
    `required_friction` is the smallest coefficient at which the pair is force closed.
    """

    i: IntArray
    j: IntArray
    axis: FloatArray
    distance: FloatArray
    force_balance_deg: FloatArray
    torque_arm_m: FloatArray
    required_friction: FloatArray

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.i)

    def select(self, keep: BoolArray | IntArray) -> GraspCandidates:
        """The pairs that `keep`, a mask or an index array, names."""
        return _select(self, keep)
