"""Beyond the paper: what the sensor saw around an object, and what was hidden."""

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

    Any other ray met the plane, where that was seen (`floor`), or nothing. Without an image everything was seen, from
    all sides.
    """

    image: RangeImage | None
    frame: Frame
    floor: Floor | None

    def hides(self, columns: FloatArray, margin_m: float) -> BoolArray:
        """Which points, columns (3, n), lie more than `margin_m` behind what their ray met, or on a ray with no end."""
        if self.image is None:
            return np.zeros(columns.shape[1], dtype=np.bool_)
        nearest, ranges = self.image.nearest(columns)
        hidden = np.asarray(nearest < ranges - margin_m)
        through = np.flatnonzero(np.isinf(nearest))
        hidden[through] = ~self._met_floor(columns.take(through, axis=1), self.image.viewpoint)
        return hidden

    def _met_floor(self, columns: FloatArray, viewpoint: FloatArray) -> BoolArray:
        """Whether the rays from `viewpoint` (3,) through points, columns (3, n), end where the plane was seen."""
        if self.floor is None or columns.shape[1] == 0:
            return np.zeros(columns.shape[1], dtype=np.bool_)
        turn = self.floor.frame.axes @ self.frame.axes.T
        origin = self.floor.frame.to_local(self.frame.origin)
        x, y, z = turn @ columns + origin[:, None]
        sensor_x, sensor_y, sensor_z = turn @ viewpoint + origin
        fall = sensor_z - z
        share = sensor_z / np.where(fall > 0, fall, 1.0)
        levels = self.floor.levels.over(sensor_x + share * (x - sensor_x), sensor_y + share * (y - sensor_y))
        return np.asarray(np.isfinite(levels) & (fall > 0))
