"""The height maps that an object's surroundings are looked up in."""

from __future__ import annotations

from dataclasses import dataclass

from flatgrasp_cli.geometry.height_map import HeightMap


@dataclass(frozen=True, slots=True, eq=False)
class HeightMaps:
    """Heights of a slice, of what it stands on and of what stands around it, along the approach.

    `surface` is the mean height of the slice's own points, `average` that of all of the object's. `rest` is the highest
    point of everything else that fingers can meet: 0 where the plane is free, −inf where no ray came. `highest` is that
    of everything, for the parts of fingers that are away from the contact, and `coarse` the same in larger cells, for
    the palm.
    """

    surface: HeightMap
    average: HeightMap
    rest: HeightMap
    highest: HeightMap
    coarse: HeightMap
