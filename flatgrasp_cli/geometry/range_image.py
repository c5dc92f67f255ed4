"""How far each ray from a viewpoint got: what tells free space from space that nobody looked into."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.geometry.frames import axes_about
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.kernels.projection import projected

MOST_ASIDE = 10.0
"""Tangent of the widest angle to the line of sight: at a viewpoint amid the points, most lie beside or behind it."""


@dataclass(frozen=True, slots=True, eq=False)
class RangeImage:
    """Nearest range (rows, columns) in square pixels of a central projection; +inf where no ray returned.

    `axes` (3, 3) has the image's x, y and its line of sight as rows; `pixels` are the cells of the plane at distance 1.
    """

    viewpoint: FloatArray
    axes: FloatArray
    pixels: Raster
    ranges: FloatArray

    @classmethod
    def of(cls, points: FloatArray, viewpoint: FloatArray, spacing_m: float) -> RangeImage:
        """The image of `points` (n, 3), n > 0, that lie `spacing_m` apart, from `viewpoint` (3,)."""
        middle = mean_of(points) - viewpoint
        distance = max(float(np.linalg.norm(middle)), spacing_m)
        sight = middle / np.linalg.norm(middle) if middle.any() else np.array([0.0, 0.0, -1.0])
        axes = axes_about(sight)
        pitch = spacing_m / distance
        nothing = cls(viewpoint, axes, Raster(np.zeros(2), pitch, (1, 1)), np.full((1, 1), np.inf))
        x, y, ranges = nothing._projected(points.T)
        ahead = np.maximum(np.abs(x), np.abs(y)) < MOST_ASIDE
        if not ahead.all():
            x, y, ranges = x[ahead], y[ahead], ranges[ahead]
        if len(x) == 0:
            return nothing
        low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
        pixels = Raster.over(low, high, pitch)
        image = cls(viewpoint, axes, pixels, np.full(pixels.shape, np.inf))
        pixels.lower_to(image.ranges, x, y, ranges)
        return image

    def of_only(self, points: FloatArray) -> RangeImage:
        """The same pixels as they would be if there were only these `points` (n, 3)."""
        image = replace(self, ranges=np.full(self.pixels.shape, np.inf))
        x, y, ranges = self._projected(points.T)
        self.pixels.lower_to(image.ranges, x, y, ranges)
        self.pixels.rimmed(image.ranges, np.inf)
        return image

    def nearest(self, columns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How far the rays through points, columns (3, n), got, and how far those lie, (n,); +inf for no return."""
        x, y, ranges = self._projected(columns)
        return self.pixels.looked_up(self.ranges, x, y), ranges

    def _projected(self, columns: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Image coordinates x and y, and ranges (n,), of points, columns (3, n); behind the viewpoint x is +inf."""
        x, y, ranges = projected(columns, self.viewpoint, self.axes)
        return x, y, ranges
