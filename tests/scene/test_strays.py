"""Points that belong to nothing, and those that do."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.scene import without_far_strays, without_repeats
from flatgrasp_cli.scene.strays import lonely

BULK = np.random.default_rng(0).uniform(-0.1, 0.1, (3000, 3))


def left_of(*points: FloatArray) -> int:
    """How many points of a cloud are not dropped as far strays."""
    return len(without_far_strays(Cloud(np.concatenate(points))).points)


class TestFarStrays:
    @pytest.mark.parametrize(("away_m", "stays"), [(0.7, True), (2.0, False)])
    def test_within_a_metre_of_the_bulk_nothing_is_far(self, away_m: float, stays: bool) -> None:
        assert left_of(BULK, np.array([[0.1 + away_m, 0.0, 0.0]])) == len(BULK) + stays

    @pytest.mark.parametrize(("away_m", "stays"), [(7, True), (15, False)])
    def test_nor_is_it_within_the_bulks_own_size(self, away_m: float, stays: bool) -> None:
        """10 m, from corner to corner."""
        wide = BULK * [40, 30, 0.1]
        assert left_of(wide, np.array([[4 + away_m, 0.0, 0.0]])) == len(wide) + stays

    @pytest.mark.parametrize(("share", "stays"), [(0.008, False), (0.0135, True)])
    def test_a_hundredth_at_either_end_is_no_bulk(self, share: float, stays: bool) -> None:
        far = BULK[: round(share * len(BULK))] + np.array([50.0, 0.0, 0.0])
        assert left_of(BULK, far) == len(BULK) + stays * len(far)


class TestRepeats:
    @staticmethod
    def left(copies: int, places: int = 1) -> int:
        """How many points are left of so many places that a cloud holds so often."""
        repeated = np.repeat(np.random.default_rng(1).uniform(-0.1, 0.1, (places, 3)), copies, axis=0)
        return len(without_repeats(Cloud(np.concatenate([BULK[:2000], repeated]))).points) - 2000

    @pytest.mark.parametrize(("copies", "left"), [(1, 1), (2, 2), (4, 1), (500, 1)])
    def test_of_what_is_there_three_times_one_stays(self, copies: int, left: int) -> None:
        assert self.left(copies) == left

    def test_however_many_such_places_there_are(self) -> None:
        assert self.left(copies=50, places=30) == 30

    def test_in_a_large_cloud_a_thousandth_is_noticed(self) -> None:
        """4000 points of it are looked at."""
        many = np.random.default_rng(2).uniform(-0.1, 0.1, (40_000, 3))
        copies = np.repeat(many[:1], 120, axis=0)
        mixed = np.random.default_rng(3).permutation(np.concatenate([many, copies]))
        assert len(without_repeats(Cloud(mixed)).points) == len(many)


@pytest.mark.parametrize(("points", "alone"), [(1, True), (2, True), (3, False)])
def test_three_points_within_a_centimetre_are_no_strays(points: int, alone: bool) -> None:
    together = 0.003 * np.random.default_rng(4).uniform(-1, 1, (points, 3))
    far = np.array([[0.5, 0.0, 0.0]])
    assert lonely(np.concatenate([together, far]), 0.01).tolist() == [*[alone] * points, True]


@pytest.mark.parametrize("stored", [np.repeat(BULK, 2, axis=0), np.tile(BULK, (3, 1))], ids=["each twice", "thrice"])
def test_a_cloud_stored_several_times_is_that_cloud(stored: FloatArray) -> None:
    found = without_repeats(Cloud(stored))
    assert np.array_equal(found.points, BULK)
    assert found.dropped == len(stored) - len(BULK)
