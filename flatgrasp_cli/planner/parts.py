"""Beyond the paper: what the method runs on when an object stands on a support plane, and the terrain around it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.model import ObjectCloud, OrientedBox, SupportPlane
from flatgrasp_cli.planner.depth import PALM_CELL_M, Terrain
from flatgrasp_cli.planner.main_plane import oriented_box
from flatgrasp_cli.planner.shadow import BEHIND_M
from flatgrasp_cli.planner.silhouette import spacing
from flatgrasp_cli.planner.slices import lowest_tip, slices, top_of
from flatgrasp_cli.planner.view import View
from flatgrasp_cli.profiles.settings import PlannerSettings

PIXEL_CELLS = 1.5
"""Pixels of the range image, in cells: hardly one is empty where there is something."""
FINGERS_M = 0.12
"""How far beyond an object fingers may come down beside it."""
FLOOR_M = 0.3
"""The support plane farther than this from a standing object's middle cannot meet the hand."""
NEIGHBOURS_WITHIN = 2.0
"""Six neighbours of a point at the edge of a square grid lie within so many steps; on a rod they lie far along it."""
MIN_CELL_M = 0.002
"""Cells of height maps: the points' spacing, but no smaller than what matters to a finger."""
HANGING_M, MOST_HANGING_M = 0.02, 0.04
"""What begins higher than this and is nowhere larger than that does not stand on what was not seen of it."""
BELOW, FREE_SHARE, BELOW_SAMPLES = (0.25, 0.5), 0.5, 200
"""Where it is looked for free space below an object, in shares of its height, and how much of it makes it hang."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Points (n, 3) of an object, the frame to project them to, and the terrain they stand in (None: seen alone).

    `spacing_m` is how far apart they then lie, where that is known.
    """

    box: OrientedBox
    frame: Frame
    points: FloatArray
    terrain: Terrain | None = None
    spacing_m: float | None = None


def sliced(cloud: ObjectCloud, box: OrientedBox, support: SupportPlane, settings: PlannerSettings) -> list[Part]:
    """The object's slices, in a frame whose origin is the box's centre brought down to the support plane."""
    frame = replace(box.frame, origin=box.frame.origin - support.heights(box.frame.origin) * support.normal)
    local, obstacles = frame.to_local(cloud.points), frame.to_local(cloud.obstacles)
    spacing_m = spacing(local[:, :2])
    if cloud.floor is not None:
        spacing_m = min(spacing_m, NEIGHBOURS_WITHIN * cloud.floor.spacing_m)
    cell_m = max(MIN_CELL_M, spacing_m)
    others = HeightMap.around(local, cell_m, FINGERS_M).raised(obstacles)
    if cloud.floor is not None:
        others = others.filled(cloud.floor.levels, frame, cloud.floor.frame)
    fine = others.raised(local)
    whole = HeightMap.of(np.concatenate([local, obstacles]), max(PALM_CELL_M, cell_m))
    lowest = float(lowest_tip(top_of(local[:, 2]), settings.depth))
    view = _view(cloud, frame, cell_m)
    average, ground = fine.averaged(local), settings.depth.min_clearance_m
    parts = []
    for piece in slices(local, cell_m, settings.depth):
        if len(piece.rows) == len(local):
            terrain = Terrain(piece.level_m, lowest, ground, average, average, others, fine, whole, view)
            parts.append(Part(box, frame, cloud.points, terrain, spacing_m))
            continue
        apart = np.ones(len(local), dtype=np.bool_)
        apart[piece.rows] = False
        surface, rest = fine.averaged(local[piece.rows]), others.raised(local[apart])
        terrain = Terrain(piece.level_m, lowest, ground, surface, average, rest, fine, whole, view)
        parts.append(Part(box, frame, cloud.points[piece.rows], terrain))
    return parts


def hanging_m(whole: Part) -> float:
    """How high in the air a small object hangs, with nothing but free space seen below it; 0 if it does not.

    Stereo cameras see such things beside real ones. Larger ones may be held by what was not seen: the rim of a bowl
    hangs over, and a bottle may be clear below its label.
    """
    if whole.terrain is None or whole.terrain.view.image is None:
        return 0.0
    local = whole.frame.to_local(whole.points)
    low = float(local[:, 2].min())
    if low < HANGING_M or float(np.ptp(local, axis=0).max()) > MOST_HANGING_M:
        return 0.0
    x, y, _ = np.tile(local[spread_indices(len(local), BELOW_SAMPLES)], (len(BELOW), 1)).T
    heights = np.repeat(np.multiply(BELOW, low), len(x) // len(BELOW))
    hidden = whole.terrain.view.hides(np.stack([x, y, heights]), BEHIND_M)
    return low if 1 - hidden.mean() >= FREE_SHARE else 0.0


def _view(cloud: ObjectCloud, frame: Frame, cell_m: float) -> View:
    if cloud.viewpoint is None:
        return View(None, frame, cloud.floor)
    points = frame.to_local(np.concatenate([cloud.points, cloud.obstacles]))
    image = RangeImage.of(points, frame.to_local(cloud.viewpoint), PIXEL_CELLS * cell_m)
    return View(image, frame, cloud.floor)


def standing(cloud: ObjectCloud, box: OrientedBox, settings: PlannerSettings) -> Part | None:
    """The whole of a standing object in the main plane of its own bounding box, to be grasped from the sensor's side.

    None when the object is too low for it. Heights are over the deepest that was seen of it, where it is widest; the
    fingertips end a little behind that, and the support plane is an obstacle like all others.
    """
    if box.size[2] < settings.depth.standing_ratio * box.size[:2].max():
        return None
    own = oriented_box(cloud.points, cloud.toward, settings.main_plane.method)
    if own is None:
        return None
    frame = replace(own.frame, origin=own.frame.origin - 0.5 * own.size[2] * own.frame.axes[2])
    floor = cloud.floor.points if cloud.floor is not None else np.empty((0, 3))
    floor = floor[np.abs(floor - own.frame.origin).max(axis=1) < FLOOR_M]
    local, others = frame.to_local(cloud.points), frame.to_local(np.concatenate([cloud.obstacles, floor]))
    cell_m = max(MIN_CELL_M, spacing(local[:, :2]))
    fine = HeightMap.of(np.concatenate([local, others]), cell_m)
    whole = HeightMap.of(np.concatenate([local, others]), max(PALM_CELL_M, cell_m))
    rest, average = HeightMap.of(others, cell_m), fine.averaged(local)
    end = -settings.depth.min_grip_m
    ground = end - settings.depth.obstacle_clearance_m
    terrain = Terrain(end, end, ground, average, average, rest, fine, whole, _view(cloud, frame, cell_m))
    return Part(own, frame, cloud.points, terrain)
