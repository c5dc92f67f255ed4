"""Clouds of things on a table, and what is taken for their sensor."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from flatgrasp_cli import Cloud, load_gripper, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Sensor
from flatgrasp_cli.sensor import located
from tests.conftest import MM, Box, Camera, Solid, Tube

BLOCK = Box((0.02, 0.01, 0.02), (0.10, 0.04, 0.04), 20)
CAN = Tube((0.1, -0.05, 0.05), 0.033, 0.1)
LYING = Tube((0.0, 0.0, 0.02), 0.02, 0.12, (1.0, 0.3, 0.0))
SLANTED = Camera(tilt_deg=35)
NOWHERE = np.zeros(3)


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def image(camera: Camera, *solids: Solid, noise_m: float = 0.5 * MM) -> FloatArray:
    """An organised cloud (rows, columns, 3) in the world's frame; NaN where a ray meets nothing."""
    columns, rows = camera.pixels
    u, v = np.meshgrid(np.arange(columns) - 0.5 * (columns - 1), np.arange(rows) - 0.5 * (rows - 1))
    rays = np.column_stack([u.ravel(), v.ravel(), np.full(u.size, camera.focal)]) / camera.focal @ camera.frame.axes
    depth = np.min([solid.hit(camera.frame.origin, rays) for solid in solids], axis=0)
    depth[~np.isfinite(depth)] = np.nan
    depth += rng().normal(0, noise_m, len(depth))
    points: FloatArray = camera.frame.origin + depth[:, None] * rays
    return np.asarray(points.reshape(rows, columns, 3))


def moved(cloud: Cloud, *shift: float) -> Cloud:
    return replace(cloud, points=cloud.points + np.array(shift))


def seen(camera: Camera, *solids: Solid, **changes: Any) -> Cloud:
    """What a camera sees, in the world's frame, with nothing said of the camera unless `changes` do."""
    return replace(camera.sees(*solids), **{"viewpoint": None, **changes})


def sensor_of(cloud: Cloud, up: tuple[float, float, float] | None = None) -> Sensor:
    sensor = located(cloud, up, 0).sensor
    assert sensor is not None
    return sensor


def codes(cloud: Cloud, up: tuple[float, float, float] | None = None) -> list[str]:
    return [warning.code for warning in located(cloud, up, 0).warnings]


def approach(cloud: Cloud, *, up: str | None = None) -> FloatArray:
    """The way the hand comes to the best grasp."""
    from flatgrasp_cli import load_settings

    best = plan(cloud, load_gripper("pr2"), load_settings("default", (f"scene.up={up}",) if up else ())).best
    assert best is not None
    axes: FloatArray = axes_from_quaternion(best.orientation)
    return np.asarray(axes[2])
