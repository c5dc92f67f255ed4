"""What counts as an object: tables whose every bump is known, a millimetre before and behind each of the limits."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_settings
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.height_map import UNSEEN
from flatgrasp_cli.model import Cloud, SupportPlane
from flatgrasp_cli.scene import segment
from flatgrasp_cli.scene.cells import fitting_cell_m
from flatgrasp_cli.scene.clusters import Clusters, find_clusters
from tests.by_hand import MM, Relief

SETTINGS = load_settings().scene
UP = np.array([0.0, 0.0, 1.0])


def bump(
    height_mm: float, width_mm: float, at_mm: tuple[float, float] = (0, 0), length_mm: float | None = None
) -> Relief:
    """The relief of a block so high and wide, and as long if nothing else is said, about a place."""

    def relief(x: FloatArray, y: FloatArray) -> FloatArray:
        half_x, half_y = 0.5 * MM * (length_mm or width_mm), 0.5 * MM * width_mm
        inside = (np.abs(x - at_mm[0] * MM) < half_x) & (np.abs(y - at_mm[1] * MM) < half_y)
        return np.where(inside, height_mm * MM, 0.0)

    return relief


def waves(height_mm: float, length_mm: float) -> Relief:
    """The relief of waves along x, so far up and down."""
    return lambda x, _y: height_mm * MM * np.sin(2 * np.pi * x / (length_mm * MM))


def table(
    *reliefs: Relief, side_mm: float = 200, pitch_mm: float = 1, noise_mm: float = 0.2, seed: int = 0
) -> FloatArray:
    """Points (n, 3) of a table of that side, z = 0, and of what stands on it; scattered by half a step."""
    rng = np.random.default_rng(seed)
    steps = MM * np.arange(-0.5 * side_mm, 0.5 * side_mm, pitch_mm)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    x, y = x + rng.uniform(0, 0.5 * MM * pitch_mm, len(x)), y + rng.uniform(0, 0.5 * MM * pitch_mm, len(x))
    return np.column_stack([x, y, sum(relief(x, y) for relief in reliefs) + rng.normal(0, noise_mm * MM, len(x))])


def found(points: FloatArray, noise_mm: float = 0.2) -> Clusters:
    clusters = find_clusters(Cloud(points), SupportPlane(UP, 0.0, noise_mm * MM), SETTINGS)
    assert clusters is not None
    return clusters


def count(points: FloatArray, noise_mm: float = 0.2) -> int:
    """How many objects there are."""
    return len(found(points, noise_mm).members)


def without(points: FloatArray, lost: BoolArray) -> FloatArray:
    return points[~lost]


class TestWhatStandsOut:
    @pytest.mark.parametrize(("height_mm", "objects"), [(1.2, 0), (3.5, 1)])
    def test_2_mm_do(self, height_mm: float, objects: int) -> None:
        assert count(table(bump(height_mm, 40))) == objects

    @pytest.mark.parametrize(("height_mm", "objects"), [(4, 0), (12, 1)])
    def test_on_a_table_with_ripples_what_is_higher_than_they_are_does(self, height_mm: float, objects: int) -> None:
        """Ripples of 1.5 mm, 25 mm long: no plane's noise, which averages out, but as good as that."""
        points = table(waves(1.5, 25), bump(height_mm, 40))
        assert count(points, noise_mm=0.8) == objects

    def test_a_card_that_is_narrower_than_8_cm_is_no_ripple(self) -> None:
        """Though it is as low as the plane's points may be: the plane's own level is that of its surroundings."""
        points = table(bump(3.5, 40), noise_mm=1.3)
        clusters = found(points, noise_mm=1.3)
        assert len(clusters.members) == 1
        assert np.ptp(points[clusters.members[0], :2], axis=0) == pytest.approx([0.04, 0.04], abs=8 * MM)

    def test_a_block_on_waves_of_20_cm_is_found(self) -> None:
        """Of 2 mm up and down, as of a sensor's distortion: the plane's level follows them."""
        assert count(table(waves(2, 200), bump(4, 30), side_mm=300, noise_mm=0.8), noise_mm=0.8) == 1

    def test_a_die_of_15_mm_is_found(self) -> None:
        assert count(table(bump(8, 15, (30, -20)), pitch_mm=2)) == 1

    def test_a_block_of_6_mm_is_found_in_noise_of_more_than_half_of_that(self) -> None:
        """What no cell tells by itself, nine do."""
        for seed in range(4):
            assert count(table(bump(6, 40), noise_mm=3.5, seed=seed), noise_mm=3.5) == 1

    def test_the_tables_points_at_an_objects_foot_are_not_its_own(self) -> None:
        points = table(bump(40, 37), noise_mm=1, pitch_mm=2)
        own = points[found(points, noise_mm=1.0).members[0]]
        assert np.count_nonzero(own[:, 2] < 10 * MM) < 3

    def test_two_points_in_the_air_lift_no_cell_of_the_table(self) -> None:
        flying = MM * np.array([[50.0, 50, 200], [52, 50, 200]])
        clusters = found(np.vstack([table(bump(20, 30)), flying]))
        assert (len(clusters.members), len(clusters.clutter)) == (1, 0)

    def test_nothing_far_below_the_table_counts(self) -> None:
        """Reflections 6 standard deviations down, as many as the table's own points: the block has all of its own."""
        points = table(bump(6, 40), noise_mm=0.5, pitch_mm=2)
        mirrored = points * [1, 1, 0] - [0, 0, 3 * MM]
        clusters = found(np.vstack([points, mirrored]), noise_mm=0.5)
        assert len(clusters.members) == 1
        assert len(clusters.members[0]) == pytest.approx(400, rel=0.1)

    def test_a_table_that_bends_by_twice_its_noise_is_one(self) -> None:
        """The block stands where it is highest."""
        assert count(table(waves(2, 400), bump(20, 30, (60, 0)), side_mm=240, noise_mm=0.2), noise_mm=1.0) == 1


class TestHowLarge:
    @pytest.mark.parametrize(("width_mm", "objects"), [(8, 0), (16, 1)])
    def test_12_mm_square_are_no_outlier(self, width_mm: float, objects: int) -> None:
        assert count(table(bump(20, width_mm))) == objects

    @pytest.mark.parametrize(("width_mm", "objects"), [(20, 0), (28, 1)])
    def test_nor_are_30_points(self, width_mm: float, objects: int) -> None:
        """25, and 49, 4 mm apart."""
        assert count(table(bump(4, width_mm), pitch_mm=4, side_mm=400)) == objects

    @pytest.mark.parametrize(("length_mm", "objects"), [(500, 1), (900, 0)])
    def test_what_is_longer_than_70_cm_is_furniture(self, length_mm: float, objects: int) -> None:
        """It has no seam: a heap so long is parted."""
        points = table(bump(40, 60, length_mm=length_mm), side_mm=1300, pitch_mm=6)
        settings = load_settings("default", ("scene.mode=table",)).scene
        assert len(segment(Cloud(points, np.array([0.0, 0.0, 1.0])), settings, 0).objects) == objects

    @pytest.mark.parametrize(("gap_mm", "objects"), [(4, 1), (13, 2)])
    def test_where_no_finger_fits_between_two_things_they_are_one(self, gap_mm: float, objects: int) -> None:
        left, right = (bump(20, 30, (side * (15 + 0.5 * gap_mm), 0)) for side in (-1, 1))
        assert count(table(left, right)) == objects


class TestWhere:
    """The table ends at ±100 mm."""

    @pytest.mark.parametrize(("from_edge_mm", "objects"), [(10, 0), (28, 1)])
    def test_its_middle_is_15_mm_from_the_edge(self, from_edge_mm: float, objects: int) -> None:
        assert count(table(bump(20, 18, (100 - from_edge_mm, 0)))) == objects

    @pytest.mark.parametrize(("from_deg", "objects"), [(18, 1), (25, 0)])
    def test_in_five_of_16_directions(self, from_deg: float, objects: int) -> None:
        """Up to 95 degrees, the table beside a block is seen in so many, or in four."""
        points = table(bump(20, 30), side_mm=300)
        ring = np.abs(points[:, :2]).max(axis=1)
        angle = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
        hidden = (ring > 15 * MM) & (ring < 50 * MM) & ((angle < from_deg) | (angle > 95))
        assert count(without(points, hidden)) == objects

    @pytest.mark.parametrize(("free_mm", "objects"), [(25, 1), (70, 0)])
    def test_the_table_is_seen_within_4_cm_of_it(self, free_mm: float, objects: int) -> None:
        """A shadow may hide what is nearer. What has nothing around it stands on something else."""
        points = table(bump(20, 30), side_mm=300)
        ring = np.abs(points[:, :2]).max(axis=1)
        assert count(without(points, (ring > 15 * MM) & (ring < (15 + free_mm) * MM))) == objects

    @pytest.mark.parametrize(("open_deg", "objects"), [(70, 0), (150, 1)])
    def test_and_in_5_of_16_directions(self, open_deg: float, objects: int) -> None:
        points = table(bump(20, 30), side_mm=300)
        away = np.hypot(*points[:, :2].T)
        aside = np.abs(np.degrees(np.arctan2(points[:, 1], points[:, 0]))) > 0.5 * open_deg
        hidden = aside & (points[:, 2] < 10 * MM) & (away < 90 * MM)
        assert count(without(points, hidden)) == objects

    @pytest.mark.parametrize(("ring_mm", "lies"), [(140, True), (176, False)])
    def test_three_tenths_of_the_table_lie_outside_of_all_objects(self, ring_mm: float, lies: bool) -> None:
        """Else it is the floor of a pan. Its rim is a ring of that size, with a gap, on a square of 200 mm."""
        outer, inner = bump(20, ring_mm), bump(20, ring_mm - 12)

        def rim(x: FloatArray, y: FloatArray) -> FloatArray:
            return np.where((x > 0) & (np.abs(y) < 10 * MM), 0.0, outer(x, y) - inner(x, y))

        clusters = found(table(rim))
        assert len(clusters.members) == 1
        assert clusters.lie_on_table == lies

    @pytest.mark.parametrize(("beyond_mm", "looked_at"), [(150, True), (260, False)])
    def test_20_cm_beyond_the_table_are_looked_at(self, beyond_mm: float, looked_at: bool) -> None:
        post = table(lambda x, _y: 0 * x + 50 * MM, side_mm=20) + np.array([(100 + beyond_mm) * MM, 0.0, 0.0])
        points = np.vstack([table(bump(20, 30)), post])
        assert (len(found(points).clutter) > 100) == looked_at


class TestStrays:
    """Three points in the air over a block, each as far from the others."""

    @staticmethod
    def left(apart_mm: float, width_mm: float, pitch_mm: float) -> int:
        points = table(bump(20, width_mm), side_mm=2 * width_mm, pitch_mm=pitch_mm)
        three = apart_mm * MM * np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.87, 0]]) + [-0.4 * apart_mm * MM, 0, 0.3]
        rows = np.concatenate(found(np.vstack([points, three])).members)
        return int(np.count_nonzero(rows >= len(points)))

    @pytest.mark.parametrize(("apart_mm", "left"), [(9, 3), (28, 0)])
    def test_within_a_centimetre_or_two_they_are_something(self, apart_mm: float, left: int) -> None:
        assert self.left(apart_mm, width_mm=80, pitch_mm=1) == left

    @pytest.mark.parametrize(("apart_mm", "left"), [(45, 3), (130, 0)])
    def test_in_a_sparse_cloud_within_three_cells_of_20_mm(self, apart_mm: float, left: int) -> None:
        assert self.left(apart_mm, width_mm=300, pitch_mm=10) == left


class TestFloor:
    def test_its_level_is_known_to_a_fraction_of_the_noise(self) -> None:
        levels = found(table(bump(20, 30), noise_mm=1, pitch_mm=2), noise_mm=1.0).floor.levels.heights
        assert np.std(levels[levels > UNSEEN]) < 0.15 * MM

    def test_and_follows_a_bend_of_a_decimetre(self) -> None:
        levels = found(table(waves(1.5, 100), side_mm=300), noise_mm=1.0).floor.levels.heights
        assert np.max(levels) > 1.2 * MM


class TestCellSize:
    @pytest.mark.parametrize(("pitch_mm", "cell_mm"), [(0.6, 1.2), (2.5, 5), (12, 20)])
    def test_cells_hold_four_points_and_are_20_mm_wide_at_most(self, pitch_mm: float, cell_mm: float) -> None:
        x, y, _ = table(pitch_mm=pitch_mm, side_mm=max(100, 20 * pitch_mm)).T
        assert fitting_cell_m(x, y, 0.01) == pytest.approx(cell_mm * MM, rel=0.1)

    def test_gaps_wider_than_a_centimetre_do_not_count(self) -> None:
        """A table seen in stripes of 3 cm has cells as small as where it was seen."""
        x, y, _ = table(pitch_mm=2.5, side_mm=300).T
        seen = x % 0.09 < 0.03
        assert fitting_cell_m(x[seen], y[seen], 0.01) == pytest.approx(5 * MM, rel=0.2)
