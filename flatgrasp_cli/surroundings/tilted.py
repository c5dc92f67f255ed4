"""Where hands that come aslant to an object are planned for: one place for each direction.

What the sensor saw of the object's top and of its front is all that there is of it. Seen from aslant, that is a shell:
so what was hidden of it (`unseen`) is taken to belong to it, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.geometry.spacing import spacing
from flatgrasp_cli.model import Floor, ObjectCloud
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.surroundings.aslant import Aslant, surely_behind_m
from flatgrasp_cli.surroundings.maps import MIN_CELL_M, HeightMaps
from flatgrasp_cli.surroundings.places import (
    NEIGHBOURS_WITHIN,
    PIXEL_CELLS,
    Place,
    above,
    box_across,
    fingers_reach_m,
)
from flatgrasp_cli.surroundings.slices import lowest_tip, slices, top_of
from flatgrasp_cli.surroundings.unseen import hidden_of
from flatgrasp_cli.surroundings.view import View

SPARSER = 2
"""How many times as far apart as from straight above slices are: what is wide from there is deep from aslant."""


@dataclass(frozen=True, eq=False)
class Tilted:
    """An object that stands on a support plane of which the `floor` was seen, for hands from any direction."""

    cloud: ObjectCloud
    floor: Floor
    settings: PlannerSettings

    @cached_property
    def _on_floor(self) -> FloatArray:
        """The object's points (n, 3) in the frame of the floor."""
        return self.floor.frame.to_local(self.cloud.points)

    @cached_property
    def _cell_m(self) -> float:
        """How far apart the object's points lie, seen from above, metres."""
        return max(MIN_CELL_M, min(spacing(self._on_floor[:, :2]), NEIGHBOURS_WITHIN * self.floor.spacing_m))

    @cached_property
    def _height_m(self) -> float:
        """How high the object stands on the plane, metres."""
        return top_of(self._on_floor[:, 2])

    @cached_property
    def _clearance_m(self) -> float:
        """How far hands keep clear of the plane, metres."""
        return float(lowest_tip(self._height_m, self.settings.depth))

    @cached_property
    def _view(self) -> View:
        """What the sensor saw, in the frame of the floor."""
        frame, viewpoint = self.floor.frame, self.cloud.viewpoint
        if viewpoint is None:
            return View(None, frame, self.floor)
        own, others = self._on_floor, frame.to_local(self.cloud.obstacles)
        image = RangeImage.of(np.concatenate([own, others]), frame.to_local(viewpoint), PIXEL_CELLS * self._cell_m)
        return View(image, frame, self.floor, others=image.of_only(others))

    @cached_property
    def _body(self) -> FloatArray:
        """Points (k, 3) of the object that were hidden."""
        body = hidden_of(self._on_floor, self._view, self._cell_m, surely_behind_m(self.settings))
        return self.floor.frame.to_world(body)

    def places(self, toward: FloatArray, gripper: Gripper) -> Iterator[Place]:
        """The object for a hand that comes against `toward` (3,), a unit vector: the whole, then what stands out.

        Heights are over the deepest point of the object, and the support plane is an obstacle like any other. There is
        none if the points lie on a line, or if there is no room for a palm over them.
        """
        whole = self.whole(toward, gripper)
        if whole is None:
            return
        yield whole
        around = whole.surroundings
        if isinstance(around, Aslant):
            depth = self.settings.depth.model_copy(update={"slice_step_m": SPARSER * self.settings.depth.slice_step_m})
            for piece in slices(whole.points, around.maps.rest.cell_m, depth):
                if piece.rows[0] < len(self.cloud.points):  # else it is all body, and fingers close on what was seen
                    yield above(whole, around, piece)

    def whole(self, toward: FloatArray, gripper: Gripper) -> Place | None:
        """The whole of the object for a hand that comes against `toward` (3,); None where `places` has none."""
        box = box_across(toward, np.concatenate([self.cloud.points, self._body]), self.settings.main_plane.method)
        if box is None:
            return None
        frame = replace(box.frame, origin=box.frame.origin - 0.5 * box.size[2] * toward)
        local, obstacles = frame.to_local(self.cloud.points), frame.to_local(self.cloud.obstacles)
        spacing_m = min(spacing(local[:, :2]), NEIGHBOURS_WITHIN * self.floor.spacing_m)
        cell_m = max(MIN_CELL_M, spacing_m)

        others = self._standing(local, frame, cell_m, fingers_reach_m(gripper, self.settings)).raised(obstacles)
        if not self._has_room(others.raised(local), local, gripper):
            return None
        body, own = frame.to_local(self._body), others.averaged(local)
        x, y, z = body.T
        hidden = own.over(x, y) < z - surely_behind_m(self.settings)  # what was seen is what is there
        local = np.concatenate([local, body[hidden]])
        highest = others.raised(local)
        lowest_m = float(lowest_tip(top_of(local[:, 2]), self.settings.depth))
        around = Aslant(
            level_m=lowest_m,
            lowest_m=lowest_m,
            ground_m=-np.inf,
            maps=HeightMaps(
                surface=highest.averaged(local),
                rest=others,
                highest=highest,
                coarse=highest,
                others=others,
            ),
            view=replace(self._view, asked=frame),
            settings=self.settings,
            height_m=self._height_m,
            own=own,
        )
        return Place(box=box, frame=frame, points=local, surroundings=around, spacing_m=spacing_m)

    def _standing(self, local: FloatArray, frame: Frame, cell_m: float, reach_m: float) -> HeightMap:
        """The floor `reach_m` around points `local` (n, 3), seen along z of the `frame`."""
        normal = self.floor.frame.axes[2]
        # beside a hand that comes along the support plane, that is as high as can be
        fall = max(float(frame.axes[2] @ normal), float(np.finfo(np.float64).eps))
        beside_m = max(0.0, self._clearance_m - fall * self.settings.depth.obstacle_clearance_m)
        chart = HeightMap.around(local, cell_m, reach_m)
        rows, columns = chart.raster.shape
        x = chart.raster.origin[0] + cell_m * (0.5 + np.arange(rows))
        y = chart.raster.origin[1] + cell_m * (0.5 + np.arange(columns))
        origin = float(normal @ (frame.origin - self.floor.frame.origin))
        over = origin + (normal @ frame.axes[0]) * x[:, None] + (normal @ frame.axes[1]) * y
        return replace(chart, heights=chart.raster.rimmed((beside_m - over) / fall, UNSEEN))

    def _has_room(self, coarse: HeightMap, local: FloatArray, gripper: Gripper) -> bool:
        """Whether, over points `local` (n, 3), anything as wide as the palm is free where the palm is at the highest.

        That is a bound that costs little: a hand holds an object no higher than at its top.
        """
        highest = float(local[:, 2].max()) + gripper.finger_length_m - self.settings.depth.palm_clearance_m
        free = (coarse.heights <= highest).view(np.uint8)
        room = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * coarse.cell_m
        (left, low), (right, high) = (
            np.divmod(int(coarse.raster.cells(x, y)), coarse.raster.shape[1])
            for x, y in (local[:, :2].min(axis=0), local[:, :2].max(axis=0))
        )
        over = room[left : right + 1, low : high + 1]
        return bool(over.max() >= 0.5 * min(gripper.hand_width_m, gripper.palm_m))
