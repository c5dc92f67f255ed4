"""What holds water: walls whose every length is known, on a floor without noise; things in bins are in test_heaps."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_settings
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import frame_on_plane
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.model import Floor
from flatgrasp_cli.scene.container import Container, find_container
from tests.by_hand import MM

SIDE_MM = 500
"""Of the floor, whose cells are 2 mm wide."""


def walls(inner_mm: float, height_mm: float = 60, gap_mm: float = 0) -> FloatArray:
    """Points (n, 3), 2 mm apart, of the rims of a square bin's walls; one has a gap in its middle."""
    places = np.arange(-0.5 * SIDE_MM, 0.5 * SIDE_MM, 2.0) + 1.0
    x, y = (axis.ravel() for axis in np.meshgrid(places, places))
    away = np.maximum(np.abs(x), np.abs(y)) - 0.5 * inner_mm
    gap = (x > 0.5 * inner_mm) & (np.abs(y) < 0.5 * gap_mm)
    rim = (away > 0) & (away < 10) & ~gap
    return MM * np.column_stack([x[rim], y[rim], np.full(np.count_nonzero(rim), height_mm)])


def container(points: FloatArray, mode: str = "table") -> Container | None:
    frame = frame_on_plane(np.array([0.0, 0.0, 1.0]), 0.0)
    raster = Raster.over(np.full(2, -0.5 * SIDE_MM * MM), np.full(2, 0.5 * SIDE_MM * MM), 2 * MM)
    floor = Floor(frame, HeightMap(raster, np.zeros(raster.shape)), 1 * MM)
    return find_container(points, floor, load_settings("default", (f"scene.mode={mode}",)).scene)


def held(found: Container, x_mm: FloatArray) -> BoolArray:
    """Which places beside each other along x the container holds."""
    return found.holds(MM * np.column_stack([x_mm, 0 * x_mm, 0 * x_mm]))


@pytest.mark.parametrize(("gap_mm", "holds_water"), [(34, True), (52, False)])
def test_gaps_of_4_cm_are_the_sensors(gap_mm: float, holds_water: bool) -> None:
    assert (container(walls(360, gap_mm=gap_mm)) is not None) == holds_water


@pytest.mark.parametrize(
    ("inner_mm", "mode", "is_one"),
    [(270, "table", True), (230, "table", False), (115, "bin", True), (85, "bin", False)],
)
def test_it_is_25_cm_wide_or_10_where_somebody_knows_of_it(inner_mm: float, mode: str, is_one: bool) -> None:
    assert (container(walls(inner_mm), mode) is not None) == is_one


def test_what_it_holds_lies_2_cm_from_its_walls() -> None:
    found = container(walls(360))
    assert found is not None
    places = np.arange(-200.0, 200.0)
    inside = places[held(found, places)]
    assert [inside.min(), inside.max()] == pytest.approx([-160, 160], abs=4)
