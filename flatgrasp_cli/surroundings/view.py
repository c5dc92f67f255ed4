"""Beyond the paper: what the sensor saw around an object, and what was hidden."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.kernels import sight as kernels
from flatgrasp_cli.model import Floor

NOTHING = HeightMap.of(np.empty((0, 3)), 1.0)
"""A map of nothing that was seen."""


@dataclass(frozen=True, eq=False)
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
        if self.rays is None:
            return np.zeros(columns.shape[1], dtype=np.bool_)
        behind = self.behind if margin_m is None else np.array([margin_m, 0.0])
        found: BoolArray = kernels.hidden(columns, *self.rays, behind)
        return found

    @property
    def behind(self) -> FloatArray:
        """How far behind what a ray met a place is hidden (2,): metres, and a share of the distance, two pixels."""
        return np.array([0.0, 0.0 if self.image is None else 2 * self.image.pixels.cell_m])

    @cached_property
    def rays(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray] | None:
        """Eye, pixels and ranges of the image, and place, cells and levels of the floor, in the frame of what is asked.

        Where no floor was seen there is a single cell of it, with nothing in it; None without an image.
        """
        if self.image is None:
            return None
        eye = np.vstack([self.image.viewpoint, self.image.axes])
        floor = self.floor or Floor(self.frame, NOTHING, 1.0)
        turn = floor.frame.axes @ self.frame.axes.T
        ground = np.vstack([self.frame.to_local(floor.frame.origin), turn])
        if self.asked is not None:
            eye, ground = (self._asked(rows) for rows in (eye, ground))
        return eye, self.image.pixels.grid, self.image.ranges, ground, floor.levels.grid, floor.levels.heights

    def _asked(self, rows: FloatArray) -> FloatArray:
        """A place and axes, rows (4, 3), in the frame that is asked about."""
        assert self.asked is not None  # noqa: S101
        place = self.asked.to_local(self.frame.to_world(rows[0]))
        return np.vstack([place, rows[1:] @ (self.frame.axes @ self.asked.axes.T)])

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
