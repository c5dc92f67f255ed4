"""How far each ray from a viewpoint got: what tells free space from space that nobody looked into."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray

MAX_PIXELS = 4_000_000
MOST_ASIDE = 10.0
"""Tangent of the widest angle to the line of sight: at a viewpoint amid the points, most lie beside or behind it."""


@dataclass(frozen=True, slots=True, eq=False)
class RangeImage:
    """Nearest range (rows, columns) in square pixels of a central projection; +inf where no ray returned.

    `axes` (3, 3) has the image's x, y and its line of sight as rows; a pixel is `pitch` wide at distance 1.
    """

    viewpoint: FloatArray
    axes: FloatArray
    corner: FloatArray
    pitch: float
    ranges: FloatArray

    @classmethod
    def of(cls, points: FloatArray, viewpoint: FloatArray, spacing_m: float) -> RangeImage:
        """The image of `points` (n, 3), n > 0, that lie `spacing_m` apart, from `viewpoint` (3,)."""
        middle = points.mean(axis=0) - viewpoint
        distance = max(float(np.linalg.norm(middle)), spacing_m)
        sight = middle / np.linalg.norm(middle) if middle.any() else np.array([0.0, 0.0, -1.0])
        x = np.cross(np.eye(3)[int(np.argmin(np.abs(sight)))], sight)
        x /= np.linalg.norm(x)
        axes = np.stack([x, np.cross(sight, x), sight])
        image = cls(viewpoint, axes, np.zeros(2), spacing_m / distance, np.full((1, 1), np.inf))
        x, y, ranges = image._projected(points.T)
        ahead = np.maximum(np.abs(x), np.abs(y)) < MOST_ASIDE
        if not ahead.all():
            x, y, ranges = x[ahead], y[ahead], ranges[ahead]
        if len(x) == 0:
            return image
        low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
        pitch = max(image.pitch, float(np.sqrt(np.prod(high - low) / MAX_PIXELS)))
        rows, columns = (((high - low) / pitch).astype(np.intp) + 3).tolist()
        image = cls(viewpoint, axes, low - pitch, pitch, np.full((rows, columns), np.inf))
        np.minimum.at(image.ranges.reshape(-1), image._pixels(x, y), ranges)
        return image

    def nearest(self, columns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How far the rays through points, columns (3, n), got, and how far those lie, (n,); +inf for no return."""
        x, y, ranges = self._projected(columns)
        return self.ranges.take(self._pixels(x, y)), ranges

    def _projected(self, columns: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Image coordinates x and y, and ranges (n,), of points, columns (3, n); behind the viewpoint x is +inf."""
        x, y, z = self.axes @ (columns - self.viewpoint[:, None])
        depth = np.maximum(z, 1e-9)
        return np.where(z > 0, x / depth, np.inf), y / depth, np.sqrt(x * x + y * y + z * z)

    def _pixels(self, x: FloatArray, y: FloatArray) -> IntArray:
        """Flat pixel indices (…); those outside fall on the empty rim."""
        rows, columns = self.ranges.shape
        row = ((x - self.corner[0]) / self.pitch).clip(0, rows - 1).astype(np.intp)
        column = ((y - self.corner[1]) / self.pitch).clip(0, columns - 1).astype(np.intp)
        return np.asarray(row * columns + column)
