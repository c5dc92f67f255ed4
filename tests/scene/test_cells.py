"""Cells that a scene's points are sorted into, and the frame of the plane that they lie in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flatgrasp_cli.geometry.frames import Frame, frame_on_plane
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.scene.cells import SortedPoints, fitting_cell_m, usual


def test_cells_add_up_what_falls_into_them() -> None:
    points = np.array([[0.0, 0.0, 1.0], [0.004, 0.004, 3.0], [0.012, 0.0, 5.0], [0.0, 0.025, 9.0], [0.0, 0.0, -1.0]])
    raster = Raster.over(points[:, :2].min(axis=0), points[:, :2].max(axis=0), 0.01)
    aside = np.array([[0.0, 0.5, 2.0]])
    found = SortedPoints.of(np.concatenate([points, aside]), Frame(np.zeros(3), np.eye(3)), raster, (0.0, 7.0))
    assert found.cell[4:].tolist() == [0, 0]
    assert found.count[1:3, 1:4].sum() == found.count.sum() == 4  # two by three cells, and a rim
    assert (found.total[1, 1], found.total[2, 1], found.total[1, 3]) == (4.0, 5.0, 7.0)
    assert found.total.sum() == 16.0
    floor = np.full(raster.shape, np.inf)
    floor[1, 1], floor[1, 3] = 2.0, 6.0
    assert [part.tolist() for part in found.standing(floor)] == [[1, 3], [3.0, 7.0]]


def test_cells_hold_a_few_points_each() -> None:
    points = np.random.default_rng(0).uniform(0, 0.4, (40_000, 2))  # 25 points in a square centimetre
    x, y = points.T
    assert fitting_cell_m(x, y, 0.01) == pytest.approx(0.004, rel=0.05)


@given(st.lists(st.integers(0, 9), min_size=1).filter(any))
def test_the_usual_count_is_the_median_of_those_that_are_not_0(counts: list[int]) -> None:
    assert usual(np.array([counts])) == np.median([count for count in counts if count])


@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1))
@settings(max_examples=15)
def test_the_planes_frame_is_right_handed_with_its_normal_up(vector: tuple[float, float, float]) -> None:
    normal = np.array(vector) / np.linalg.norm(vector)
    frame = frame_on_plane(normal, 0.3)
    assert frame.axes @ frame.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.cross(frame.axes[0], frame.axes[1]) == pytest.approx(normal, abs=1e-12)
    assert frame.origin @ normal == pytest.approx(0.3)
