"""Outlines made ready for caging: few vertices, and one so much smaller that the true one surely covers it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import distance_to_segment
from flatgrasp_cli.profiles.settings import CagingSettings
from flatgrasp_cli.proof.caging.boundary import Boundary

COARSER = 1.5
MITRE = 2.0
"""Longest corner of an offset, in offsets: an arc's vertices for nothing but a rounder corner are not worth it."""
FINEST_SHARE = 1e-5
"""Of the outline's length: the first step where no tolerance is set, whatever unit the outline has."""
CONVEX_SHARE = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """What caging is computed on.

    `region`, a shapely polygon with the `boundary`, is the `whole` outline simplified.
    """

    whole: Any
    region: Any
    boundary: Boundary
    convex: bool

    @property
    def tolerance_m(self) -> float:
        """How far the region strays from the whole outline at most."""
        return max(map(_stray, _rings(self.whole), _rings(self.region)))

    def eroded(self, noise_m: float) -> Boundary | None:
        """What lies within every outline that differs from the given one by no more than the noise; None if nothing.

        What holds that holds them all.
        """
        import shapely

        with np.errstate(all="ignore"):  # GEOS divides by zero on the way, and numpy would warn of it
            small = self.region.buffer(-(noise_m + self.tolerance_m), join_style="mitre", mitre_limit=MITRE)
        part = max(shapely.get_parts(small), key=lambda each: each.area, default=None)  # of a rigid body, one is enough
        return None if part is None or part.is_empty else boundary_of(part)


def prepare(loops: Sequence[FloatArray], settings: CagingSettings) -> Outline | None:
    """The outline of `loops` (n_l, 2), the outer one first; None if it crosses itself and so has no inside."""
    import shapely

    region = shapely.Polygon(loops[0], loops[1:])
    if not region.is_valid or region.area == 0:
        return None
    plain = _simplified(region, settings)
    hull = plain.convex_hull.area
    return Outline(region, plain, boundary_of(plain), hull - plain.area <= CONVEX_SHARE * hull)


def _simplified(region: Any, settings: CagingSettings) -> Any:
    """The region simplified within the tolerance, or coarser, to leave few enough vertices."""
    import shapely

    tolerance = settings.tolerance_m
    plain = shapely.simplify(region, tolerance)
    finest = FINEST_SHARE * region.length
    most = max(settings.max_vertices, 8 * (1 + len(plain.interiors))) + 1 + len(plain.interiors)  # rings close
    while shapely.get_num_coordinates(plain) > most:
        tolerance = max(COARSER * tolerance, finest)
        plain = shapely.simplify(region, tolerance)
    return plain


def _rings(region: Any) -> tuple[Any, ...]:
    """The rings of a shapely polygon, the outer one first."""
    return (region.exterior, *region.interiors)


def _stray(ring: Any, plain: Any) -> float:
    """How far the vertices of a ring lie from the edges that simplifying put in their place.

    Not the tolerance itself, for it does not bind where a ring begins. No point of the region farther than that from
    the simplified boundary has changed sides.
    """
    import shapely

    whole, few = (shapely.get_coordinates(each)[:-1] for each in (ring, plain))
    place = {vertex: k for k, vertex in enumerate(map(tuple, whole.tolist()))}
    kept = np.sort([place[vertex] for vertex in map(tuple, few.tolist())])
    edge = np.searchsorted(kept, np.arange(len(whole)), side="right") - 1  # −1 is the last one, which wraps around
    return float(distance_to_segment(whole, whole[kept[edge]], whole[np.roll(kept, -1)[edge]]).max())


def boundary_of(region: Any) -> Boundary:
    """The boundary of a shapely polygon, the region to its left."""
    import shapely

    region = shapely.orient_polygons(region)
    rings = [shapely.get_coordinates(ring)[:-1] for ring in _rings(region)]
    return Boundary.of([ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)] for ring in rings])
