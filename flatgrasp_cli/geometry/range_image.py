"""How far each ray from a viewpoint got: what tells free space from space that nobody looked into."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray

MAX_PIXELS = 4_000_000


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
        distance = float(np.linalg.norm(middle))
        sight = middle / distance
        x = np.cross(np.eye(3)[int(np.argmin(np.abs(sight)))], sight)
        x /= np.linalg.norm(x)
        axes = np.stack([x, np.cross(sight, x), sight])
        image = cls(viewpoint, axes, np.zeros(2), spacing_m / distance, np.empty((0, 0)))
        plane, _ = image._projected(points)
        low, high = plane.min(axis=0), plane.max(axis=0)
        pitch = max(image.pitch, float(np.sqrt(np.prod(high - low) / MAX_PIXELS)))
        rows, columns = (((high - low) / pitch).astype(np.intp) + 3).tolist()
        image = cls(viewpoint, axes, low - pitch, pitch, np.full((rows, columns), np.inf))
        pixels, ranges = image._pixels(points)
        np.minimum.at(image.ranges.reshape(-1), pixels, ranges)
        return image

    def hides(self, points: FloatArray, margin_m: float) -> BoolArray:
        """Which `points` (…, 3) lie more than `margin_m` behind what was seen on their ray, or where nothing was."""
        pixels, ranges = self._pixels(points)
        nearest = self.ranges.ravel()[pixels]
        return np.asarray(~np.isfinite(nearest) | (nearest < ranges - margin_m))

    def _projected(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        local = (points - self.viewpoint) @ self.axes.T
        return local[..., :2] / np.maximum(local[..., 2:], 1e-9), np.linalg.norm(local, axis=-1)

    def _pixels(self, points: FloatArray) -> tuple[IntArray, FloatArray]:
        """Flat pixel index and range (…) of points (…, 3); those outside fall on the empty rim."""
        plane, ranges = self._projected(points)
        rows, columns = self.ranges.shape
        index = np.clip((plane - self.corner) / self.pitch, 0, [rows - 1, columns - 1]).astype(np.intp)
        return index[..., 0] * columns + index[..., 1], ranges
