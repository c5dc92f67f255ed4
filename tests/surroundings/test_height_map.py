"""Maps of heights hold what a search of all points finds."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap


class TestHeightMap:
    POINTS = np.array([[0.0, 0.0, 1.0], [0.004, 0.003, 3.0], [0.012, 0.0, -2.0]])

    def test_each_cell_holds_its_highest_point(self) -> None:
        chart = HeightMap.of(self.POINTS, 0.01)
        assert chart.over(np.array([0.001, 0.015]), np.array([0.009, 0.005])).tolist() == [3.0, -2.0]

    def test_what_lies_outside_or_between_is_unseen(self) -> None:
        chart = HeightMap.of(self.POINTS, 0.01)
        outside = np.array([[0.0, 0.05], [-0.05, 0.0], [9.0, 9.0], [-9.0, -9.0]])
        assert (chart.over(*outside.T) == UNSEEN).all()

    def test_a_map_of_nothing_is_unseen(self) -> None:
        assert HeightMap.of(np.empty((0, 3)), 0.01).over(*np.zeros((2, 2, 4))).tolist() == [[UNSEEN] * 4] * 2

    def test_the_same_cells_averaged(self) -> None:
        chart = HeightMap.of(self.POINTS, 0.01).averaged(self.POINTS)
        assert chart.over(*self.POINTS[:, :2].T).tolist() == [2.0, 2.0, -2.0]

    @settings(max_examples=15)
    @given(st.integers(0, 2**31 - 1), st.floats(0.002, 0.02))
    def test_it_is_the_brute_force_maximum(self, seed: int, cell: float) -> None:
        points = np.random.default_rng(seed).uniform(-0.05, 0.05, (200, 3))
        chart = HeightMap.of(points, cell)
        corner = np.floor((points[:, :2] - chart.raster.origin) / chart.cell_m)
        for k in range(0, 200, 20):
            mates = (corner == corner[k]).all(axis=1)
            assert chart.over(*points[k, :2]) == points[mates, 2].max()
