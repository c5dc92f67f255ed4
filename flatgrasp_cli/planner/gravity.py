"""§III.C: gravity, and the choice of the final grasp."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.polygon import area_centroid, cross
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, Silhouette


def gravity_center(silhouette: Silhouette, method: str) -> FloatArray:
    """Centre of gravity (2,) in the main plane.

    `area`: the centroid of the outline's area, as of a plate; `points`: the mean of the visible points, which follows
    their density.
    """
    return area_centroid(silhouette.loops) if method == "area" else silhouette.points.mean(axis=0)


def gravity_distance(fingers: FingerCandidates, pairs: GraspCandidates, center: FloatArray) -> FloatArray:
    """Distance (p,) of the centre of gravity to each grasping line, the one through both contacts, in metres."""
    contact = fingers.contact[pairs.i]
    along = (fingers.contact[pairs.j] - contact) / pairs.distance[:, None]
    return np.abs(cross(along, center - contact))


def best_first(pairs: GraspCandidates, distance: FloatArray, tie_m: float) -> IntArray:
    """Order (p,) of the pairs by gravity distance; within steps of `tie_m` by required friction, then by index."""
    rounded = np.floor(distance / tie_m) if tie_m > 0 else distance
    return np.lexsort((pairs.j, pairs.i, pairs.required_friction, rounded))
