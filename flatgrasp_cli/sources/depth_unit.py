"""Whether depth in the unit that was assumed can be that of a scene in front of an arm."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import CloudWarning

NEAREST_M = 0.05
"""No depth camera sees what is nearer; those for the shortest range begin at 7 cm."""
FARTHEST_M = 2.0
"""No arm that carries or stands beside its camera picks up what is farther away from it."""
MOST = 0.95
"""Of the pixels: the others may be cables, other arms, or wrong."""


def unit_warning(depth_m: FloatArray, unit_m: float) -> CloudWarning | None:
    """What to say if hardly any of the depth (n,), in a unit that nobody stated, is where things can be picked up."""
    outside = np.count_nonzero(depth_m > FARTHEST_M) + np.count_nonzero(depth_m < NEAREST_M)
    if outside <= MOST * len(depth_m):
        return None
    unit = "metres" if unit_m == 1.0 else "millimetres"
    return CloudWarning(
        "depth_unit_assumed",
        f"depth was taken to be in {unit}, but then hardly anything lies between {NEAREST_M:g} and {FARTHEST_M:g} m; "
        "--depth-unit states the metres in one count, e.g. 0.0001 for a RealSense D405",
    )
