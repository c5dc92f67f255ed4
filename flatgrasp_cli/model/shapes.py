"""An object's oriented bounding box and its silhouette in the main plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame


@dataclass(frozen=True, slots=True, eq=False)
class OrientedBox:
    """The oriented bounding box: `frame` at its centre (x major, y middle, z minor axis, to the sensor), `size` (3,).

    The x-y plane of `frame` is the main plane. `aabb` (2, 3) are the corners of the axis-aligned box, for comparison.
    """

    frame: Frame
    size: FloatArray
    aabb: FloatArray

    @classmethod
    def around(
        cls, mean: FloatArray, centred: FloatArray, axes: FloatArray, bottom: float | None = None
    ) -> OrientedBox:
        """The box with `axes` (3, 3), its rows, around points (3, n) about their `mean` (3,).

        It goes down to `bottom`, a height along its z axis over the mean, where that is given.
        """
        local = axes @ centred
        low, high = local.min(axis=1), local.max(axis=1)
        if bottom is not None:
            low[2] = bottom
        frame = Frame(mean + 0.5 * (low + high) @ axes, axes)
        return cls(frame, high - low, mean + np.stack([centred.min(axis=1), centred.max(axis=1)]))


@dataclass(frozen=True, slots=True, eq=False)
class Silhouette:
    """The object's concave hull in the main plane.

    `loops` hold vertices (n, 2) in serial order: the outer loop counter-clockwise, then the holes clockwise, so that
    the object lies to the left of the walk. `points` (k, 2) are all projected points, `heights` (k,) their heights
    above the main plane; `coverage` is the share of the concave hull's area in `loops`, the rest being fragments.
    """

    frame: Frame
    loops: tuple[FloatArray, ...]
    points: FloatArray
    heights: FloatArray
    alpha_m: float
    coverage: float


@dataclass(frozen=True, slots=True, eq=False)
class GravityCenter:
    """Where an object's centre of gravity may be in the plane: the centroid of its `area`, the mean of its `points`.

    Both are (2,); `used` names the one that grasps are judged by.
    """

    area: FloatArray
    points: FloatArray
    used: Literal["area", "points"]

    @property
    def place(self) -> FloatArray:
        """The one that is used (2,)."""
        return self.area if self.used == "area" else self.points


@dataclass(frozen=True, slots=True, eq=False)
class PlaneShape:
    """An object as the method sees it in the plane: its bounding box, its silhouette and its centre of gravity.

    Above a slice's level `silhouette` is that of the slice; box, centre of gravity and `volume_m3`, what lies under the
    surface that was seen, are still the whole object's.
    """

    box: OrientedBox
    silhouette: Silhouette
    gravity_center: GravityCenter
    volume_m3: float


@dataclass(frozen=True, slots=True, eq=False)
class StepPoints:
    """Step points of one loop: arc lengths `positions` (s,) and `points` (s, 2), `step_m` apart (the paper's r)."""

    loop: int
    positions: FloatArray
    points: FloatArray
    step_m: float
