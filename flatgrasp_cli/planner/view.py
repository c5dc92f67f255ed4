"""Beyond the paper: what the sensor saw around an object, and what was hidden from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.model import Floor


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """How far the sensor's rays got: `image` holds those that met something above the support plane, in `frame`.

    All others met the plane where it was seen, on `floor`, or nothing.
    """

    image: RangeImage
    frame: Frame
    floor: Floor | None

    @property
    def viewpoint(self) -> FloatArray:
        """Where the sensor was (3,), in `frame`."""
        return self.image.viewpoint

    def hides(self, points: FloatArray, margin_m: float) -> BoolArray:
        """Which `points` (n, 3) lie more than `margin_m` behind what was seen on their ray, or where nothing was."""
        nearest, ranges = self.image.nearest(points)
        hidden = np.asarray(nearest < ranges - margin_m)
        through = np.flatnonzero(np.isinf(nearest))
        hidden[through] = ~self._met_floor(points[through])
        return hidden

    def _met_floor(self, points: FloatArray) -> BoolArray:
        """Whether the rays through `points` (n, 3) go on to where the support plane was seen."""
        if self.floor is None or len(points) == 0:
            return np.zeros(len(points), dtype=np.bool_)
        local = self.floor.frame.to_local(self.frame.to_world(points))
        sensor = self.floor.frame.to_local(self.frame.to_world(self.viewpoint))
        fall = sensor[2] - local[:, 2]
        share = sensor[2] / np.where(fall > 0, fall, 1.0)
        x, y = (sensor[:2] + share[:, None] * (local[:, :2] - sensor[:2])).T
        return np.asarray(np.isfinite(self.floor.levels.over(x, y)) & (fall > 0))
