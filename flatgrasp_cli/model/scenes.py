"""What a cloud shows: objects, and the plane that they stand on."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.model.clouds import CloudWarning


@dataclass(frozen=True, slots=True, eq=False)
class SupportPlane:
    """The plane that objects stand on: `normal` · p = `offset_m`, the unit normal (3,) on the sensor's side.

    `noise_m` is the standard deviation of the plane's own points about it.
    """

    normal: FloatArray
    offset_m: float
    noise_m: float

    def heights(self, points: FloatArray) -> FloatArray:
        """Heights (n,) of `points` (n, 3) above the plane."""
        return np.asarray(points @ self.normal - self.offset_m)


@dataclass(frozen=True, slots=True, eq=False)
class Floor:
    """What was seen of a support plane with nothing on it: cells of its own `frame`, whose z axis is the normal.

    `levels` holds the height over the plane around each such cell, −inf in all others. Cells serve all objects alike
    and are far fewer than the plane's points, which lie `spacing_m` apart.
    """

    frame: Frame
    levels: HeightMap
    spacing_m: float

    @property
    def points(self) -> FloatArray:
        """The middles (k, 3) of the cells, in the world."""
        return self.frame.to_world(self.levels.higher_than(UNSEEN))


@dataclass(frozen=True, slots=True, eq=False)
class ObjectCloud:
    """The points (n, 3) of one object; the hand comes from the side that `toward` (3,), of any length, points to.

    They were seen from `viewpoint` (3,), or, if that is None, from all sides. `support` is the plane it stands on, None
    when it was seen alone, and `floor` what was seen of that. Near it lie other points above the plane, `obstacles`
    (m, 3), for fingers and palm to keep clear of. Objects that touch have the same `group`; None touches no other.
    `in_container` says that it lies in a bin, `cut_off` that the picture's edge cuts it off, so that it goes on where
    nobody looked, and `at_edge` that it lies at the edge of what was seen of the support plane. `supports` are the
    numbers of the objects that lie on it.
    """

    id: int
    points: FloatArray
    toward: FloatArray
    viewpoint: FloatArray | None
    support: SupportPlane | None = None
    obstacles: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    floor: Floor | None = None
    group: int | None = None
    in_container: bool = False
    cut_off: bool = False
    at_edge: bool = False
    supports: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What a cloud shows: objects, and the plane that they stand on (None: one object, seen alone).

    `clutter` (k, 3) are points above the plane that belong to no object, and `container` (k, 3) those of a bin around
    them; `reason` says why there is no object. `wholes` are groups of objects that touch and are together no larger
    than one may be: what is known of them if none of the group can be grasped.
    """

    support: SupportPlane | None
    objects: tuple[ObjectCloud, ...]
    clutter: FloatArray
    reason: str | None = None
    warnings: tuple[CloudWarning, ...] = ()
    wholes: tuple[ObjectCloud, ...] = ()
    container: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
