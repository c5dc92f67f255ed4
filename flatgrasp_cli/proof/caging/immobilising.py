"""All grasps of an outline that two point fingers close into, each with its cage: a method of its own.

Allen, Burdick & Rimon, "Two-fingered caging of polygons via contact-space graph search" (ICRA 2012): an object is held
where the distance of two fingers on its outline is least; such a grasp cages it up to the opening that leads out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.profiles.settings import CagingSettings
from flatgrasp_cli.proof.caging.certificate import caging_of
from flatgrasp_cli.proof.caging.contact_space import SAME, Caging
from flatgrasp_cli.proof.caging.outline import prepare


@dataclass(frozen=True, slots=True, eq=False)
class Immobilisation:
    """Two contacts (2, 2) in plane coordinates whose distance `width_m` is the least, or for fingers that open most.

    Beyond `escape_m` the object can get away, beyond `basin_m` (no farther) into another grasp; None: without limit.
    Where parallel edges leave the fingers room to slide, the contacts are the middle of it.
    """

    contacts: FloatArray
    width_m: float
    escape_m: float | None
    basin_m: float | None

    @property
    def depth_m(self) -> float:
        """How far the fingers may open, or close, before the grasp is another one."""
        return np.inf if self.basin_m is None else abs(self.basin_m - self.width_m)


def immobilising_grasps(loops: Sequence[FloatArray], settings: CagingSettings) -> tuple[Immobilisation, ...]:
    """All grasps of the region `loops` (n_l, 2) that are told apart, the one that forgives most first.

    They are those of the outline simplified as the settings say; there are none of one that crosses itself.
    """
    outline = prepare(loops, settings)
    if outline is None:
        return ()
    caging = caging_of(outline.boundary, settings)
    grasps = _grasps(caging, settings.told_apart_m)
    found = map(partial(_immobilisation, caging), grasps.tolist(), _at_bottom(caging, grasps))
    return tuple(sorted(found, key=lambda each: (-each.depth_m, each.width_m)))


def _grasps(caging: Caging, told_apart: float) -> IntArray:
    """The basins that are grasps of their own: no dents in another one's floor, and deep enough."""
    levels, lowest = caging.levels, caging.basins.lowest
    same = SAME * caging.boundary.size
    own = levels.deepest == np.arange(len(lowest))
    apart = np.abs(lowest) > same  # where the outline touches itself, fingers on both sides of it meet
    return np.flatnonzero(own & apart & (levels.merge - lowest > max(told_apart, same)))


def _at_bottom(caging: Caging, grasps: IntArray) -> Iterator[FloatArray]:
    """All placements (m, 2, 2) at the bottom of each of the basins `grasps` (k,), which ascend."""
    minima = caging.minima
    basin = caging.basins.of_node[minima.vertex, minima.edge]
    order = np.argsort(basin, kind="stable")  # once for all: there may be a hundred thousand of them
    points = minima.points(caging.boundary)[order]
    first, last = (np.searchsorted(basin[order], grasps, side=side).tolist() for side in ("left", "right"))
    return (points[a:b] for a, b in zip(first, last, strict=True))


def _immobilisation(caging: Caging, basin: int, points: FloatArray) -> Immobilisation:
    sign = -1.0 if caging.stretching else 1.0
    escape, merge = (float(each[basin]) for each in (caging.levels.escape, caging.levels.merge))
    return Immobilisation(
        contacts=_middle(points),
        width_m=sign * float(caging.basins.lowest[basin]),
        escape_m=sign * escape if np.isfinite(escape) else None,
        basin_m=sign * merge if np.isfinite(merge) else None,
    )


def _middle(points: FloatArray) -> FloatArray:
    """The contacts (2, 2) halfway between the ends of where they can slide, of placements (m, 2, 2) there."""
    swapped = points[:, ::-1]  # the fingers are alike
    apart, apart_swapped = (np.abs(each - points[0]).sum(axis=(1, 2)) for each in (points, swapped))
    points = np.where((apart <= apart_swapped)[:, None, None], points, swapped)
    one_end = points[np.abs(points - points[0]).sum(axis=(1, 2)).argmax()]
    other_end = points[np.abs(points - one_end).sum(axis=(1, 2)).argmax()]
    return np.asarray(0.5 * (one_end + other_end))
