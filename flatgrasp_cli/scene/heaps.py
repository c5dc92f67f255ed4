"""Clusters → objects: what touches is told apart, what is too long for one object is none, and neither is a bin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypedDict

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray, IntArray
from flatgrasp_cli.geometry.extents import extent_of
from flatgrasp_cli.model import SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene.clusters import Clusters
from flatgrasp_cli.scene.container import Container, find_container
from flatgrasp_cli.scene.parting import Limits, Surface, pieces
from flatgrasp_cli.scene.stacking import least_drop_m
from flatgrasp_cli.scene.support_plane import flatness_m
from flatgrasp_cli.surroundings.slices import MIN_POINTS

NECK_SIDES = 2
"""Of a neck or a handle so many sides are seen at once, at most, each as wide as the least part: pieces that may be one
object and meet along a line no longer than that are one."""

Piece = tuple[IntArray, int | None]
"""The indices of an object's points, and the cluster that it was parted from."""


class _Found(TypedDict):
    members: tuple[IntArray, ...]
    groups: tuple[int | None, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Heap:
    """Points (n, 3) on a support plane, as seen from `viewpoint` (3,), and the `clusters` that they make."""

    points: FloatArray
    clusters: Clusters
    plane: SupportPlane
    viewpoint: FloatArray
    settings: SceneSettings
    colors: ByteArray | None = None

    def container(self) -> Container | None:
        """The bin around what stands on the plane, if there is one; one with nothing in it is an object."""
        stated = self.settings.mode == "bin"
        found = find_container(self._at(self._standing), self.clusters.floor, self.settings)
        return found if stated or (found is not None and self._in_container(found).members) else None

    def apart(self, container: Container | None) -> Clusters:
        """The clusters with an object for each piece of them, largest first.

        Pieces that are too small or too long to be objects are clutter. In a container everything that stands is looked
        at, and what is neither its floor nor its walls is an object.
        """
        if container is not None or self.settings.mode == "bin":
            return self._in_container(container)
        clusters = self.clusters
        objects = self._objects_of(clusters.members)
        return replace(clusters, **self._largest_first(objects), clutter=self._rest(*(rows for rows, _ in objects)))

    def _in_container(self, container: Container | None) -> Clusters:
        """The things in a container and beside it, and the container; None is one of which only the inside is seen.

        What touches no wall is told apart as on a table. The rest is looked at with the floor: curved, it rises above
        the support plane, too, and into the walls.
        """
        free = [rows for rows in self.clusters.members if container is None or _is_free(self._at(rows), container)]
        objects = self._objects_of(free)
        stands, rest = np.zeros((2, len(self.points)), dtype=np.bool_)
        stands[self._standing] = True
        rest[:] = self.plane.heights(self.points) > -flatness_m(self.plane, self.settings)
        if container is not None:
            rest &= container.covers(self.points)
        for rows in free:
            rest[rows] = False
        walls = [np.empty(0, dtype=np.intp)]
        for piece in self._pieces(np.flatnonzero(rest)):
            own = piece[stands[piece]]
            if container is not None:
                in_walls = container.has_in_walls(self._at(own))
                walls.append(own[in_walls])
                own = own[~in_walls]
            if self._lies_in(piece, container) and self._is_object(own):
                objects.append((own, None))
                continue
            for low in self._standing_out(own):  # without the floor, into which low things pass without a seam
                inside = container is not None and _most(container.holds(self._at(low)))
                if inside and not self._is_small(low) and self._is_object(low):
                    objects.append((low, None))
                else:
                    walls.append(low)
        wall = np.concatenate(walls)
        return replace(
            self.clusters,
            **self._largest_first(objects),
            clutter=self._rest(wall, *(rows for rows, _ in objects)),
            container=wall,
            solid=np.empty((0, 3)) if container is None else container.solid(self._at(wall)),
        )

    def _objects_of(self, members: Sequence[IntArray]) -> list[Piece]:
        """The objects that clusters are made of."""
        found = []
        for group, rows in enumerate(members):
            parts = self._pieces(rows)
            if len(parts) > 1 or _length_m(self._at(rows)) > self.settings.max_size_m:
                parts = [part for part in parts if self._is_object(part)]
            found += [(part, group if len(parts) > 1 else None) for part in parts]
        return found

    def _largest_first(self, objects: list[Piece]) -> _Found:
        """The objects by the number of cells of the floor's raster that they stand over."""
        floor = self.clusters.floor

        def footprint(piece: Piece) -> int:
            x, y, _ = floor.frame.to_local(self._at(piece[0])).T
            raster = floor.levels.raster
            return int(np.count_nonzero(raster.count(raster.cells(x, y))))

        if len(objects) > 1:
            objects = sorted(objects, key=footprint, reverse=True)
        return {"members": tuple(rows for rows, _ in objects), "groups": tuple(group for _, group in objects)}

    def _rest(self, *taken: IntArray) -> IntArray:
        """The points above the plane that are not `taken`."""
        free = np.ones(len(self.points), dtype=np.bool_)
        for rows in taken:
            free[rows] = False
        standing = self._standing
        return np.asarray(standing[free[standing]])

    def _at(self, rows: IntArray) -> FloatArray:
        """The points (k, 3) in these `rows`: an index takes several times as long."""
        return self.points.take(rows, axis=0)

    @property
    def _standing(self) -> IntArray:
        """The points above the plane."""
        return np.concatenate([*self.clusters.members, self.clusters.clutter])

    def _lies_in(self, piece: IntArray, container: Container | None) -> bool:
        """Whether a piece is neither floor, from which walls rise, nor wall, which is outside but for its foot."""
        if _most(self.plane.heights(self._at(piece)) < flatness_m(self.plane, self.settings)):
            return False
        return container is None or _most(container.holds(self._at(piece)))

    def _pieces(self, rows: IntArray) -> list[IntArray]:
        """The `rows` (n,) of points piece by piece."""
        if self._is_small(rows, 2):
            return [rows] if len(rows) else []
        least_m = self.settings.least_part_m
        may_be_one = self._width_m(rows) <= longest_whole_m(self.settings)
        limits = Limits(
            seam_deg=self.settings.seam_deg,
            least_m=least_m,
            drop_m=least_drop_m(self.settings),
            neck_m=NECK_SIDES * least_m if may_be_one else 0.0,
            seam_color=self.settings.seam_color,
        )
        points = self._at(rows)
        surface = Surface(
            points=points,
            heights=self.plane.heights(points),
            viewpoint=self.viewpoint,
            spacing_m=self.clusters.floor.spacing_m,
            noise_m=self.plane.noise_m,
            colors=None if self.colors is None else self.colors[rows],
        )
        names = pieces(surface, limits)
        order = np.argsort(names, kind="stable")
        return np.split(rows[order], np.flatnonzero(np.diff(names[order])) + 1)

    def _width_m(self, rows: IntArray) -> float:
        """Diameter of the circle around points as seen from above."""
        _, radius = cv2.minEnclosingCircle(self.clusters.floor.frame.to_local(self._at(rows))[:, :2].astype(np.float32))
        return 2 * radius

    def _standing_out(self, rows: IntArray) -> list[IntArray]:
        """The pieces of a floor's or a wall's own points above the plane, without the ripple scattered around them."""
        raster = self.clusters.floor.levels.raster
        found = []
        for piece in self._pieces(rows):
            x, y, _ = self.clusters.floor.frame.to_local(self._at(piece)).T
            cell = raster.cells(x, y)
            standing = (raster.count(cell) > 0).view(np.uint8)
            name = cv2.connectedComponents(standing, connectivity=8)[1].ravel()[cell]
            order = np.argsort(name, kind="stable")
            found += np.split(piece[order], np.flatnonzero(np.diff(name[order])) + 1)
        return found

    def _is_small(self, rows: IntArray, parts: int = 1) -> bool:
        """Whether points cover less than so many of the smallest parts of objects."""
        return bool(len(rows) * self.clusters.floor.spacing_m**2 < parts * self.settings.least_part_m**2)

    def _is_object(self, rows: IntArray) -> bool:
        """Whether points are enough for an object, and not too far apart."""
        return len(rows) >= MIN_POINTS and _length_m(self._at(rows)) <= self.settings.max_size_m


def longest_whole_m(settings: SceneSettings) -> float:
    """How long pieces that touch are together, metres, at most, if they may be one object, as a drill's two ends are.

    Half as long as the longest object: hardly a tool that a hand carries is longer.
    """
    return 0.5 * settings.max_size_m


def _most(which: BoolArray) -> bool:
    """Whether more than half of what a mask (n,) tells of are marked."""
    return 2 * int(np.count_nonzero(which)) > len(which)


def _length_m(points: FloatArray) -> float:
    """Diagonal of the box around `points` (n, 3)."""
    return float(np.linalg.norm(extent_of(points)))


def _is_free(points: FloatArray, container: Container) -> bool:
    """Whether `points` (n, 3) stand apart from the walls of a container: in it, or beside it."""
    return bool(container.holds(points).all() or not container.covers(points).any())
