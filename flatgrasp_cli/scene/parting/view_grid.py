"""Points sorted into the cells of the image in which they were seen: neighbours there are neighbours on a surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.geometry.frames import axes_about
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.geometry.scatter import median
from flatgrasp_cli.kernels import view as kernels
from flatgrasp_cli.kernels.projection import image
from flatgrasp_cli.scene.support_plane import NEAREST_M, SIGMAS
from flatgrasp_cli.surroundings.sight import LOST_DEG

REACH_CELLS = 2
"""How far on both sides of a cell a bend is measured: the normals there see three cells each, and not the seam. Shifted
images wrap around, so that more cells than that are empty around all points."""

Step = tuple[int, int]
DOWN: Step = (1, 0)
RIGHT: Step = (0, 1)
T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True, slots=True, eq=False)
class ViewGrid:
    """Square cells of a central projection, each with the mean of the nearest points that it holds.

    `x`, `y` (rows, columns) are the image's coordinates of that mean, at distance 1 before the viewpoint, `depth` is
    how far it lies along the line of sight, and `height` how high over the support plane; `known` says where there is
    one. `cell` (n,) is the flat index of each
    point's cell and `point_depth` (n,) its own depth. A cell is `cell_m` wide where the points are, and `jump_m` is the
    most that the depth of a seen surface changes from one cell to the next.
    """

    x: FloatArray
    y: FloatArray
    depth: FloatArray
    height: FloatArray
    known: BoolArray
    cell: IntArray
    point_depth: FloatArray
    cell_m: float
    jump_m: float

    @classmethod
    def of(
        cls, points: FloatArray, heights: FloatArray, viewpoint: FloatArray, cell_m: float, noise_m: float
    ) -> ViewGrid:
        """The image of `points` (n, 3) at `heights` (n,) from `viewpoint` (3,).

        Their noise along the line of sight is `noise_m`.
        """
        x, y, point_depth = image_of(points, viewpoint)
        distance = median(point_depth)
        pitch = cell_m / distance
        rim = (REACH_CELLS + 1) * pitch
        low, high = np.array([x.min(), y.min()]) - rim, np.array([x.max(), y.max()]) + rim
        raster = Raster.over(low, high, pitch)
        cell_m = raster.cell_m * distance
        cell = raster.cells(x, y)
        # a surface seen more flatly returns nothing, so one that was seen is no steeper
        jump_m = cell_m / np.tan(np.radians(LOST_DEG)) + SIGMAS * noise_m
        values = np.stack([point_depth, x, y, heights])
        depth, x, y, height = kernels.nearest_means(values, cell, raster.size, jump_m).reshape(4, *raster.shape)
        return cls(
            x=x,
            y=y,
            depth=depth,
            height=height,
            known=np.isfinite(depth),
            cell=cell,
            point_depth=point_depth,
            cell_m=cell_m,
            jump_m=float(jump_m),
        )

    def smooth_to(self, step: Step) -> BoolArray:
        """Whether (rows, columns) the surface goes on, without a jump, from a cell to the one so many further."""
        return kernels.smooth_to(self.depth, *step, self.jump_m)

    def of_points(self, values: IntArray) -> IntArray:
        """`values` (rows, columns) for each of the points (n,): of its cell, or of that beside it which is as deep.

        A cell at an edge holds points of what is before and of what is behind.
        """
        found = values.ravel()[self.cell]
        off = np.abs(self.point_depth - self.depth.ravel()[self.cell])
        odd = np.flatnonzero(off > self.cell_m)
        around = self.cell[odd, None] + [down * values.shape[1] + right for down, right in neighbours()]
        apart = np.abs(self.depth.ravel()[around] - self.point_depth[odd, None])
        best = apart.argmin(axis=1)
        better = apart[np.arange(len(odd)), best] < off[odd]
        found[odd[better]] = values.ravel()[around[better, best[better]]]
        return found

    def places(self) -> FloatArray:
        """The means (3, rows, columns) in space; 0 where nothing is known."""
        depth = np.where(self.known, self.depth, 0.0)
        x, y = np.where(self.known, self.x, 0.0), np.where(self.known, self.y, 0.0)
        return np.stack([x * depth, y * depth, depth])


def shifted(values: NDArray[T], step: Step) -> NDArray[T]:
    """`values` (…, rows, columns) of the cells that lie so many rows and columns further."""
    return np.roll(values, (-step[0], -step[1]), axis=(-2, -1))


def neighbours() -> Iterator[Step]:
    """The steps to the eight cells around one."""
    return ((down, right) for down in (-1, 0, 1) for right in (-1, 0, 1) if (down, right) != (0, 0))


def sides() -> Iterator[Step]:
    """The steps to the four cells beside one."""
    return (step for step in neighbours() if 0 in step)


def image_of(points: FloatArray, viewpoint: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Image coordinates x and y at distance 1, and depths (n,), of `points` (n, 3) seen from `viewpoint` (3,).

    The line of sight goes to the middle of the points.
    """
    sight = mean_of(points) - viewpoint
    sight /= max(float(np.linalg.norm(sight)), 1e-9)
    x, y, depth = image(points, viewpoint, axes_about(sight), NEAREST_M)
    return x, y, depth
