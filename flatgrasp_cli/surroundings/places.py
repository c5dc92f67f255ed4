"""What the method runs on: an object's points, the plane that they are projected to, and what stands around them.

The paper projects the whole of an object that lies alone. Over a support plane the fingers reach down only so far, so
the method also runs on what stands out above each of several levels.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import extent_of, mean_of
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.principal_axes import main_axes, principal_axes
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.geometry.spacing import spacing
from flatgrasp_cli.model import ObjectCloud, OrientedBox, SupportPlane
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.surroundings.alone import Alone
from flatgrasp_cli.surroundings.interface import Surroundings
from flatgrasp_cli.surroundings.maps import MIN_CELL_M, HeightMaps
from flatgrasp_cli.surroundings.on_support import OnSupport
from flatgrasp_cli.surroundings.slices import Slice, lowest_tip, slices, top_of
from flatgrasp_cli.surroundings.view import View

PIXEL_CELLS = 1.5
"""Side of the range image's pixels, in cells of the height maps: a cell is as wide as the six neighbours of a point lie
around it, so of points that lie as they fall one pixel in 2,000 is empty; if it were one cell, one in 30."""
FINGERS_M = 0.12
"""How far around an object the height maps reach at least, metres: no finger of a hand that opens by 14 cm comes down
farther out."""
NEIGHBOURS_WITHIN = 2.0
"""Steps of a square grid within which a point at its edge has six neighbours; on a rod they lie farther along it."""
MOST_HANGING_M = 0.04
"""An object that is nowhere longer, metres, may hang in the air: ghosts beside the edges of a stereo camera's views are
small. A larger one may be held by something that was not seen."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Points (n, 3) of an object in the `frame` to whose x-y plane they are projected, and what stands around them.

    The hand comes along −z of the frame. `spacing_m` is how far apart the projected points lie, where that is known.
    """

    box: OrientedBox
    frame: Frame
    points: FloatArray
    surroundings: Surroundings
    spacing_m: float | None = None


def box_on(support: SupportPlane, points: FloatArray, method: Literal["pca", "min_area"]) -> OrientedBox | None:
    """The box of `points` (n, 3) that stands on a support plane, to which its main plane is parallel.

    What a sensor above sees of an object tells neither its minor axis nor its bottom. None if the points lie on a line
    seen along the normal.
    """
    return box_across(support.normal, points, method, support.offset_m)


def box_across(
    normal: FloatArray, points: FloatArray, method: Literal["pca", "min_area"], bottom_m: float | None = None
) -> OrientedBox | None:
    """The box of `points` (n, 3) whose main plane has the unit `normal` (3,), down to `bottom_m` along that.

    It goes down to the lowest point if that is None. There is none if the points lie on a line seen along the normal.
    """
    if len(points) < 3:
        return None
    mean = mean_of(points)
    centred = np.subtract(points.T, mean[:, None], order="C")
    axes = principal_axes(np.asarray(centred - np.outer(normal, normal @ centred)))
    if axes is None:
        return None
    bottom = None if bottom_m is None else float(bottom_m - normal @ mean)
    return OrientedBox.around(mean, centred, main_axes(centred, normal, axes[2], method), bottom)


def fingers_reach_m(gripper: Gripper, settings: PlannerSettings) -> float:
    """How far beside an object fingers come down, metres, also those that miss: so far height maps reach around it."""
    out = 0.5 * gripper.max_opening_m + gripper.finger_thickness_m  # both stand equally far from what is between them
    aside = 0.5 * gripper.finger_width_m + max(abs(offset) for jaw in gripper.jaws for offset in jaw)
    misses = 3 * settings.uncertainty.figures.position_m
    return max(FINGERS_M, float(np.hypot(out, aside)) + misses)


def places(cloud: ObjectCloud, box: OrientedBox, gripper: Gripper, settings: PlannerSettings) -> Iterator[Place]:
    """The whole of an object in the main plane of its `box` and, over a support plane, the slices that stand out.

    A slice is made as it is asked for, and most objects are had well without one.
    """
    if cloud.support is None:
        local = box.frame.to_local(cloud.points)
        spacing_m = spacing(np.ascontiguousarray(local[:, :2]))
        yield Place(box=box, frame=box.frame, points=local, surroundings=Alone(settings), spacing_m=spacing_m)
    else:
        yield from _slices(cloud, box, cloud.support, gripper, settings)


def _slices(
    cloud: ObjectCloud, box: OrientedBox, support: SupportPlane, gripper: Gripper, settings: PlannerSettings
) -> Iterator[Place]:
    """The whole first, in a frame whose origin is the foot of the box's centre on the support plane."""
    frame = replace(box.frame, origin=box.frame.origin - support.heights(box.frame.origin) * support.normal)
    local, obstacles = frame.to_local(cloud.points), frame.to_local(cloud.obstacles)
    spacing_m = spacing(local[:, :2])
    if cloud.floor is not None:
        spacing_m = min(spacing_m, NEIGHBOURS_WITHIN * cloud.floor.spacing_m)
    cell_m = max(MIN_CELL_M, spacing_m)
    others = HeightMap.around(local, cell_m, fingers_reach_m(gripper, settings)).raised(obstacles)
    if cloud.floor is not None:
        others = others.filled(cloud.floor.levels, frame, cloud.floor.frame)
    everything = np.concatenate([local, obstacles])
    highest, coarse = others.raised(local), HeightMap.of(everything, cell_m)
    lowest_m = float(lowest_tip(top_of(local[:, 2]), settings.depth))
    around = OnSupport(
        level_m=lowest_m,
        lowest_m=lowest_m,
        ground_m=settings.depth.min_clearance_m,
        maps=HeightMaps(surface=highest.averaged(local), rest=others, highest=highest, coarse=coarse, others=others),
        view=_view(cloud, frame, everything, cell_m),
        settings=settings,
    )
    whole = Place(box=box, frame=frame, points=local, surroundings=around, spacing_m=spacing_m)
    yield whole
    yield from (above(whole, around, piece) for piece in slices(local, cell_m, settings.depth))


def above(whole: Place, around: OnSupport, piece: Slice) -> Place:
    """A slice of an object, the `whole` of which has these surroundings: the rest of it may be in the way."""
    apart = np.ones(len(whole.points), dtype=np.bool_)
    apart[piece.rows] = False
    own, others = (whole.points.take(rows, axis=0) for rows in (piece.rows, np.flatnonzero(apart)))
    surface, rest = around.maps.highest.averaged(own), around.maps.rest.raised(others)
    maps = replace(around.maps, surface=surface, rest=rest)
    return Place(
        box=whole.box,
        frame=whole.frame,
        points=own,
        surroundings=replace(around, level_m=piece.level_m, maps=maps),
    )


def hanging_m(whole: Place) -> float:
    """How high in the air a small object hangs, metres, with nothing but free space seen below it; 0 if it does not.

    Stereo cameras see such ghosts beside real things. What is larger may be held by something that was not seen: the
    rim of a bowl overhangs, and a bottle may be clear below its label.
    """
    if not isinstance(whole.surroundings, OnSupport) or whole.surroundings.view.image is None:
        return 0.0
    low = float(whole.points[:, 2].min())
    if low < whole.surroundings.settings.scene.min_size_m or float(extent_of(whole.points).max()) > MOST_HANGING_M:
        return 0.0  # what lies no higher than a finger is thick may stand on something
    x, y, _ = whole.points.T
    below = np.stack([x, y, np.full(len(x), 0.5 * low)])  # halfway, farthest from the noise of either
    return low if np.mean(whole.surroundings.view.hides(below)) < 0.5 else 0.0


def _view(cloud: ObjectCloud, frame: Frame, points: FloatArray, cell_m: float) -> View:
    """What the sensor saw of the space around an object by `points` (n, 3) in `frame`: its own and its obstacles'."""
    if cloud.viewpoint is None:
        return View(None, frame, cloud.floor)
    image = RangeImage.of(points, frame.to_local(cloud.viewpoint), PIXEL_CELLS * cell_m)
    return View(image, frame, cloud.floor)
