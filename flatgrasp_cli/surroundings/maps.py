"""The height maps that an object's surroundings are looked up in."""

from __future__ import annotations

from dataclasses import dataclass

from flatgrasp_cli.geometry.height_map import HeightMap


@dataclass(frozen=True, slots=True, eq=False)
class HeightMaps:
    """Heights of a slice and of what it stands on and amid, along the approach.

    `surface` is the mean height of the slice's own points, `average` that of all of the object's. `rest` is the highest
    of all others that fingers can meet, the free plane being 0 and what no ray reached −inf; `highest` that of
    everything, for the parts of fingers that are away from the contact, and `coarse` the same in larger cells, for the
    palm.
    """

    surface: HeightMap
    average: HeightMap
    rest: HeightMap
    highest: HeightMap
    coarse: HeightMap
