"""What an object's surroundings are looked up in: height maps, and what the sensor saw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.surroundings.envelope import Envelope
from flatgrasp_cli.surroundings.view import View

MIN_CELL_M = 0.002
"""Least side of height maps' cells, metres, which is otherwise the points' spacing: a silhouette is known no better."""
NOISE_M = 0.001
"""Heights that differ by less, metres, are the same: a height map's noise."""


@dataclass(frozen=True, slots=True, eq=False)
class HeightMaps:
    """Heights of a slice, of what it stands on and of what stands around it, along the approach.

    `surface` is the mean height of the slice's own points. `rest` is the highest point of everything else that fingers
    can meet: 0 where the plane is free, −inf where no ray came. `highest` is that of everything, for the parts of
    fingers that are away from the contact, and `coarse` the same as far as anything was seen, for the palm. `others`
    is the `rest` without the object's own points: those beside the slice are in the way, too.
    """

    surface: HeightMap
    rest: HeightMap
    highest: HeightMap
    coarse: HeightMap
    others: HeightMap


@dataclass(frozen=True, slots=True, eq=False)
class Relief:
    """What a slice above `level_m` stands on and among, and what the sensor saw of that.

    Fingertips may end at `lowest_m`, or lower beside a part that is too low for that. What is no higher than `ground_m`
    is no obstacle. Heights, in metres, are those over the support plane, or over the deepest point that was seen of a
    standing object. `height_m` is how high the object stands, which is less than its extent along an aslant approach.
    """

    level_m: float
    lowest_m: float
    ground_m: float
    maps: HeightMaps
    view: View
    settings: PlannerSettings
    height_m: float = np.inf

    @property
    def down(self) -> FloatArray:
        """Which way things fall: a unit vector (3,)."""
        return np.array([0.0, 0.0, -1.0])

    @property
    def envelope(self) -> Envelope:
        """Between what was seen and what the rays allow."""
        return Envelope(self.maps.highest, self.view)
