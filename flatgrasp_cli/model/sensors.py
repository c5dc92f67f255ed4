"""Where the sensor was, and how that is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame

UNIT = 1e-3
"""By how much the length of a unit vector may differ from 1, as that of a camera pose's quaternion may."""

KnownFrom = Literal[
    "option",
    "projection",
    "viewpoint",
    "inverse_viewpoint",
    "frame",
    "transforms",
    "visibility",
    "up",
    "assumed",
    "all_sides",
]
"""How it is known where the sensor was.

- `option`: somebody said so.
- `projection`: the centre of projection of an organised cloud.
- `viewpoint`, `inverse_viewpoint`: the pose in the file's header, or its inverse; the cloud can be seen from there.
- `frame`: the cloud's own frame is the sensor's, by its name or because it is a depth image's.
- `transforms`: the recording's transforms lead to the sensor's frame.
- `visibility`: of several places the only one from which the cloud can have been seen.
- `up`: only the way up is known, and the sensor is taken to have looked down.
- `assumed`: nothing is known, and the sensor is taken to have been at the origin.
- `all_sides`: a mesh, or clouds merged from several views; nothing was hidden.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Sensor:
    """Where the sensor was that saw a cloud, in the cloud's frame, and how that is known.

    `position` (3,) is None where it is not known; `direction` (3,), a unit vector, then points from the cloud toward
    the sensor, if at least that is known. What was seen from all sides has neither hidden flanks nor shadows.

    Raises
    ------
    ValueError
        If it is known from nothing of the list, a place or a way is not three finite numbers, or no unit vector.
    """

    known_from: KnownFrom
    position: FloatArray | None = None
    direction: FloatArray | None = None

    def __post_init__(self) -> None:
        """Check what was given."""
        if self.known_from not in get_args(KnownFrom):
            raise ValueError(
                f"a sensor's place is known from one of {', '.join(get_args(KnownFrom))}, not {self.known_from!r}"
            )
        for name in ("position", "direction"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, place(getattr(self, name), f"the {name} of a sensor"))
        if self.direction is not None and abs(np.linalg.norm(self.direction) - 1.0) > UNIT:
            raise ValueError(f"the direction of a sensor is a unit vector, not {self.direction!r}")

    @property
    def sees_all_sides(self) -> bool:
        """Whether nothing was hidden: a mesh, or clouds merged from several views."""
        return self.known_from == "all_sides"

    def toward(self, place: FloatArray) -> FloatArray:
        """The way (3,), of any length, from a place (3,) to the sensor."""
        if self.position is not None:
            return self.position - place
        return np.zeros(3) if self.direction is None else self.direction

    def in_frame(self, frame: Frame) -> Sensor:
        """The same sensor in the frame in which the cloud's own frame has the pose `frame`."""
        position = None if self.position is None else frame.to_world(self.position)
        direction = None if self.direction is None else self.direction @ frame.axes
        return Sensor(self.known_from, position, direction)


def place(values: FloatArray, what: str) -> FloatArray:
    """Three finite numbers as an array (3,); raises `ValueError`, which begins with `what`, if they are none."""
    found = np.asarray(values, dtype=np.float64)
    if found.shape != (3,) or not np.isfinite(found).all():
        raise ValueError(f"{what} is three finite numbers, not {values!r}")
    return found
