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
    all sides. `others` are the rays without the object's own points. What is asked about is in the frame `asked`, in
    that of the image if it is None.
    """

    image: RangeImage | None
    frame: Frame
    floor: Floor | None
    others: RangeImage | None = None
    asked: Frame | None = None

    @property
    def viewpoint(self) -> FloatArray | None:
        """Where the sensor was (3,), in the frame of what is asked about."""
        if self.image is None or self.asked is None:
            return None if self.image is None else self.image.viewpoint
        return self.asked.to_local(self.frame.to_world(self.image.viewpoint))

    def hides(self, columns: FloatArray, margin_m: float | None = None) -> BoolArray:
        """Which points, columns (3, n), lie more than `margin_m` behind what their ray met, or on a ray with no end.

        By default that is two pixels: so far back goes a surface within a pixel that is seen at 63° to its normal.
        """
        if self.image is None:
            return np.zeros(columns.shape[1], dtype=np.bool_)
        columns = self._in_the_image(columns)
        nearest, ranges = self.image.nearest(columns)
        margin = 2 * self.image.pixels.cell_m * ranges if margin_m is None else margin_m
        hidden = np.asarray(nearest < ranges - margin)
        through = np.flatnonzero(np.isinf(nearest))
        hidden[through] = ~self._met_floor(columns.take(through, axis=1), self.image.viewpoint)
        return hidden

    def shadowed(self, columns: FloatArray) -> BoolArray:
        """Which points, columns (3, n), lie on rays that met the object itself."""
        if self.image is None or self.others is None:
            return np.zeros(columns.shape[1], dtype=np.bool_)
        columns = self._in_the_image(columns)
        return np.asarray(self.image.nearest(columns)[0] < self.others.nearest(columns)[0])

    def _in_the_image(self, columns: FloatArray) -> FloatArray:
        """Points, columns (3, n), in the image's frame."""
        if self.asked is None:
            return columns
        turn = self.frame.axes @ self.asked.axes.T
        return np.asarray(turn @ columns + self.frame.to_local(self.asked.origin)[:, None])

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
