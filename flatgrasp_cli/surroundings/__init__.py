"""Beyond the paper: what stands around an object along an approach direction, and what of it was seen.

`places` tells what the method runs on. The `Surroundings` of a place answer what the method asks: at which sides
fingers can stand, whether the object's thickness was seen, how far the hand can come, and what stops one that misses.
"""

from flatgrasp_cli.surroundings.alone import Alone
from flatgrasp_cli.surroundings.aslant import Aslant
from flatgrasp_cli.surroundings.directions import (
    Direction,
    asked_of,
    beside,
    between,
    directions,
    not_allowed,
    tilt_deg,
)
from flatgrasp_cli.surroundings.interface import Surroundings
from flatgrasp_cli.surroundings.on_support import OnSupport
from flatgrasp_cli.surroundings.places import Place, box_across, box_on, hanging_m, places
from flatgrasp_cli.surroundings.tilted import Tilted

__all__ = [
    "Alone",
    "Aslant",
    "Direction",
    "OnSupport",
    "Place",
    "Surroundings",
    "Tilted",
    "asked_of",
    "beside",
    "between",
    "box_across",
    "box_on",
    "directions",
    "hanging_m",
    "not_allowed",
    "places",
    "tilt_deg",
]
