"""Which way up a drawing is: as whoever looks sees it, and square to the axes of the answer's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.planning import Plan

SLANT = float(np.sin(np.radians(25)))
"""Who looks at a plane more steeply than this off its normal sees far things further up; else it is looked down on."""
SAME_AXIS = float(np.cos(np.radians(2.5)))
"""Directions closer than this are called by the axis's own name: a drawing does not show the difference."""
SAME_SIDE = float(np.cos(np.radians(45)))
NAMES = "xyz"
MM = 1e3


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A drawing seen along a plane's normal; drawings are in millimetres.

    The x axis of `frame` goes to the right, y up, and z to whoever looks. Its origin is that of the answer's frame, so
    that along an axis that lies in the drawing coordinates are the answer's own.
    """

    frame: Frame

    def of_world(self, points: FloatArray) -> FloatArray:
        """Where points (n, 3) are drawn, (n, 2)."""
        return np.asarray(MM * self.frame.to_local(points)[:, :2])

    def of_plane(self, plane: Frame, points: FloatArray) -> FloatArray:
        """Where points (n, 2) of a parallel plane's own coordinates are drawn, (n, 2)."""
        return self.of_world(plane.to_world(points))

    def of_direction(self, direction: FloatArray) -> FloatArray:
        """A direction (3,) in the drawing (2,), shorter the less it lies in it."""
        return np.asarray(self.frame.axes[:2] @ direction)

    def label(self, axis: int) -> tuple[str, float]:
        """What the drawing's axis is called, and the sign that turns its numbers into the answer's coordinates."""
        direction = self.frame.axes[axis]
        k = int(np.argmax(np.abs(direction)))
        sign = float(np.sign(direction[k]))
        if abs(direction[k]) > SAME_AXIS:
            return f"{NAMES[k]} (mm)", sign
        return f"in the plane, toward {'−' if sign < 0 else '+'}{NAMES[k]} (mm)", 1.0

    def upright(self, *, on_plane: bool) -> Frame:
        """The frame to draw solids in: x to the right, y away from whoever looks, z up.

        Up is off the drawing where things stand on its plane, or where that is the z axis of the answer's frame; else
        what is drawn upright stands so.
        """
        x, y, z = self.frame.axes
        return self.frame if on_plane or z[2] > SAME_SIDE else Frame(self.frame.origin, np.stack([x, -z, y]))


def view_of(plan: Plan, normal: FloatArray) -> View:
    """The view along a plane's unit `normal` (3,), of all objects of a plan.

    The axis of the frame that lies best in the plane is drawn level or upright, so that no picture has an angle of its
    own. Of the four ways to do so it is the one in which what is far from the robot's base, or else from the sensor, is
    further up; where they look straight down, the frame's own image is upright.
    """
    upward = _upward(plan, middle_of(plan), normal)
    axis = np.eye(3)[int(np.argmin(np.abs(normal)))]
    level = axis - (axis @ normal) * normal
    level /= np.linalg.norm(level)
    aside = np.cross(normal, level)
    y = max((level, -level, aside, -aside), key=lambda way: float(way @ upward))
    return View(Frame(np.zeros(3), np.stack([np.cross(y, normal), y, normal])))


def normal_of(plan: Plan) -> FloatArray:
    """The unit normal (3,) of the plane that grasps are planned in, toward where the hand comes from."""
    if plan.scene.support is not None:
        return plan.scene.support.normal
    silhouette = plan.objects[0].silhouette if plan.objects else None
    return np.array([0.0, 0.0, -1.0]) if silhouette is None else silhouette.frame.axes[2]


def middle_of(plan: Plan) -> FloatArray:
    """The middle (3,) of what is looked at: the objects, or the whole cloud."""
    points = np.concatenate([item.object.points for item in plan.objects] or [plan.cloud.points])
    return points.mean(axis=0) if len(points) else np.zeros(3)


def _upward(plan: Plan, middle: FloatArray, normal: FloatArray) -> FloatArray:
    """The direction (3,) that should be drawn upward, of a scene whose `middle` (3,) is seen along `normal`."""
    sensor = plan.cloud.sensor
    away = middle if plan.robot is not None else np.zeros(3) if sensor is None else -sensor.toward(middle)
    level = away - (away @ normal) * normal  # a robot's base is its frame's origin
    if np.linalg.norm(level) > SLANT * np.linalg.norm(away):
        return np.asarray(level)
    if abs(normal[2]) < np.abs(normal[:2]).max():
        return np.array([0.0, 0.0, 1.0])
    return np.array([0.0, np.sign(normal[2]), 0.0])  # seen along +z, as by a camera, y is down
