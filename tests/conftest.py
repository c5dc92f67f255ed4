"""Clouds with known answers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import settings

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, Source
from flatgrasp_cli.profiles import Gripper, PlannerSettings, load_gripper, load_settings

settings.register_profile("no-clock", deadline=None, derandomize=True)  # machines are noisy: no test may fail for being slow
settings.load_profile("no-clock")

SAMPLES = Path(__file__).resolve().parent.parent / "sample_data"
THICKNESS_M = 0.02
MM = 1e-3


def rectangle(width: float, height: float) -> shapely.Polygon:
    """A rectangle about the origin, in millimetres."""
    return shapely.box(-width / 2, -height / 2, width / 2, height / 2)


def disc(radius: float) -> shapely.Polygon:
    """A disc about the origin, in millimetres."""
    return shapely.Point(0, 0).buffer(radius, quad_segs=90)


I_BEAM = shapely.union_all(
    [shapely.box(-15, -20, 15, 20), shapely.box(-60, -50, 60, -20), shapely.box(-60, 20, 60, 50)]
)
L_SHAPE = shapely.union_all([shapely.box(0, 0, 30, 120), shapely.box(0, 0, 100, 30)])


def sampled(shape: shapely.Polygon, pitch_mm: float = 1.0, seed: int = 0) -> FloatArray:
    """Points (n, 3) in metres of a plate: a jittered grid inside `shape` (mm), and its boundary, at random heights."""
    rng = np.random.default_rng(seed)
    x0, y0, x1, y1 = shape.bounds
    x, y = np.meshgrid(np.arange(x0, x1, pitch_mm), np.arange(y0, y1, pitch_mm))
    grid = np.column_stack([x.ravel(), y.ravel()]) + rng.uniform(-0.3, 0.3, (x.size, 2)) * pitch_mm
    inside = grid[shapely.contains_xy(shape, grid)]
    edge = shapely.segmentize(shape.boundary, pitch_mm)
    flat = MM * np.vstack([inside, shapely.get_coordinates(edge)])
    return np.column_stack([flat, rng.uniform(-THICKNESS_M / 2, THICKNESS_M / 2, len(flat))])


def cloud_of(points: FloatArray, viewpoint: Sequence[float] = (0.0, 0.0, 1.0)) -> Cloud:
    """A cloud seen from above."""
    return Cloud(points, np.array(viewpoint), Source("test"))


@pytest.fixture(scope="session")
def pr2() -> Gripper:
    """The PR2's gripper: one finger a side, 90 mm."""
    return load_gripper("pr2")


@pytest.fixture(scope="session")
def lacquey() -> Gripper:
    """The paper's gripper: a thumb against a pair, 110 mm."""
    return load_gripper("lacquey")


@pytest.fixture(scope="session")
def defaults() -> PlannerSettings:
    """The default settings, unresolved."""
    return load_settings()
