"""Clusters → objects: what touches is told apart, and what is too long for one object is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model import SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.clusters import MIN_POINTS, Clusters
from flatgrasp_cli.scene.parting import pieces


def apart(
    points: FloatArray, clusters: Clusters, plane: SupportPlane, viewpoint: FloatArray, settings: SceneSettings
) -> Clusters:
    """The clusters with an object for each piece of them, largest first, as seen from `viewpoint` (3,).

    Pieces that are too small or too long to be objects are clutter.
    """
    objects, clutter = [], [clusters.clutter]
    for rows in clusters.members:
        names = pieces(
            points[rows],
            viewpoint,
            clusters.floor.spacing_m,
            plane.noise_m,
            seam_deg=settings.seam_deg,
            least_m=settings.least_part_m,
        )
        for piece in _split(rows, names):
            long = _length_m(points[piece]) > settings.max_size_m
            (clutter if long or len(piece) < MIN_POINTS else objects).append(piece)
    largest_first = sorted(objects, key=lambda piece: -len(piece))
    return replace(clusters, members=tuple(largest_first), clutter=np.concatenate(clutter))


def _split(rows: IntArray, names: IntArray) -> list[IntArray]:
    """`rows` (n,) sorted by their `names` (n,); those without any are a piece of their own."""
    order = np.argsort(names, kind="stable")
    ends = np.flatnonzero(np.diff(names[order])) + 1
    return np.split(rows[order], ends)


def _length_m(points: FloatArray) -> float:
    """Diagonal of the box around `points` (n, 3)."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))
