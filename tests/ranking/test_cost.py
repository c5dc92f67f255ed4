"""§III.C and what counts besides: each term of the cost decides between two grasps that differ in nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flatgrasp_cli.ranking.cost import loneliness

from flatgrasp_cli import load_settings
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import GraspCandidates, GravityCenter, OrientedBox, PlaneShape, Silhouette
from flatgrasp_cli.planner.gravity import best_first
from flatgrasp_cli.ranking import grasp_cost
from flatgrasp_cli.surroundings.descent import descent_cost
from tests.by_hand import MM, WORLD, across

SETTINGS = load_settings()
BOX = OrientedBox(WORLD, np.array([0.2, 0.2, 0.02]), np.zeros((2, 3)))
OUTLINE = Silhouette(WORLD, (), np.empty((0, 2)), np.empty(0), 0.003, 1.0)


def shape(center: tuple[float, float] = (0.0, 0.0)) -> PlaneShape:
    """An object whose centre of gravity lies there."""
    return PlaneShape(BOX, OUTLINE, GravityCenter(np.array(center), np.array(center), "area"))


def paid_for(widths_mm: tuple[float, float], **columns: object) -> float:
    """What the second of two grasps as wide as that, and with these columns, costs more than the first, millimetres."""
    fingers, grasps = across(np.multiply(widths_mm, MM), **columns)
    together = SETTINGS.gravity.model_copy(update={"lonely_cost_m": 0.0})
    first, second = grasp_cost(fingers, grasps, shape(), together)
    return float(second - first) / MM


def about(value_mm: float) -> object:
    """Within a third: all weights are rough, but none is wrong by a factor of two."""
    return pytest.approx(value_mm, rel=0.34)


class TestWhatAGraspCosts:
    """In millimetres by which a grasp's line may miss the centre of gravity instead."""

    def test_missing_the_centre_of_gravity_is_what_the_others_are_measured_in(self) -> None:
        assert paid_for((40, 40), gravity_distance=np.array([0.0, 7 * MM])) == pytest.approx(7)

    def test_a_gap_of_10_mm_between_the_pads(self) -> None:
        assert paid_for((40, 40), inside_share=np.array([1.0, 0.75])) == about(30)

    def test_50_mm_more_width(self) -> None:
        assert paid_for((20, 70)) == about(10)

    def test_friction_of_which_little_costs_nothing_and_much_a_centimetre(self) -> None:
        assert paid_for((40, 40), required_friction=np.array([0.0, 0.05])) < 0.5
        assert paid_for((40, 40), required_friction=np.array([0.0, 0.3])) == about(9)

    def test_a_finger_that_would_have_to_pull_is_the_last_choice_but_no_infinite_one(self) -> None:
        assert paid_for((40, 40), required_friction=np.array([0.0, np.inf])) == about(10_000)

    def test_a_finger_in_a_hole(self) -> None:
        fingers, grasps = across([0.04, 0.04])
        in_hole = replace(fingers, loop=np.array([0, 0, 0, 1]))
        first, second = grasp_cost(in_hole, grasps, shape(), SETTINGS.gravity)
        assert (second - first) / MM == about(20)

    def test_a_centre_of_gravity_50_mm_beyond_the_contacts_on_the_line_itself(self) -> None:
        fingers, grasps = across([0.04])
        between, beyond = (
            grasp_cost(fingers, grasps, shape(center), SETTINGS.gravity)[0] for center in ((0.0, 0.019), (0.0, 0.07))
        )
        assert (beyond - between) / MM == about(10)

    def test_no_other_grasp_on_either_hand(self) -> None:
        fingers, one = across([0.04])
        lone = grasp_cost(fingers, one, shape(), SETTINGS.gravity)[0]
        sure = grasp_cost(fingers, one, shape(), SETTINGS.gravity.model_copy(update={"lonely_cost_m": 0.0}))[0]
        assert (lone - sure) / MM == about(20)


class TestWhatTheWayDownCosts:
    @staticmethod
    def paid_for(**columns: list[float]) -> float:
        """What the second of two grasps costs more than the first on its way down, millimetres.

        Without `columns` the tips end at the table, the pads hold 30 mm and have all the room that they ask for.
        """
        usual = {"tip": [0.0, 0.0], "grip": [30.0, 30.0], "margin": [20.0, 20.0], "unseen": [0.0, 0.0]}
        table = {name: MM * np.array(values) for name, values in (usual | columns).items()}
        first, second = descent_cost(across([0.04, 0.04], **table)[1], SETTINGS)
        return float(second - first) / MM

    def test_staying_20_mm_higher(self) -> None:
        assert self.paid_for(tip=[4, 24]) == about(10)

    def test_pads_that_hold_10_mm_where_20_are_good_and_more_is_no_better(self) -> None:
        assert self.paid_for(grip=[20, 10]) == about(10)
        assert self.paid_for(grip=[60, 20]) == 0

    def test_a_blade_that_the_pads_hold_by_5_mm(self) -> None:
        """15 mm for what good pads hold and this one does not, and twice that for being a blade."""
        assert self.paid_for(grip=[20, 5]) == about(45)

    def test_no_room_beside_the_pads(self) -> None:
        assert self.paid_for(margin=[20, 0]) == about(50)

    def test_half_the_room_that_is_asked_for(self) -> None:
        assert self.paid_for(margin=[20, 10]) == about(12.5)

    def test_coming_down_through_20_mm_that_nobody_saw(self) -> None:
        assert self.paid_for(unseen=[0, 20]) == about(10)


class TestLoneliness:
    @staticmethod
    def alone(*others_mm: tuple[float, float], turned_deg: float = 0.0) -> float:
        """Share of the misses of a grasp at the origin that closes along y, after which it is at none of the others."""
        middles = MM * np.array([(0.0, 0.0), *others_mm])
        angles = np.radians(90 + np.array([0.0, *[turned_deg] * len(others_mm)]))
        return float(loneliness(middles, np.column_stack([np.cos(angles), np.sin(angles)]))[0])

    @pytest.mark.parametrize("aside_mm", [-10, -5, 5, 10])
    def test_another_grasp_half_a_centimetre_or_a_whole_one_aside_forgives_that_miss(self, aside_mm: float) -> None:
        assert self.alone((aside_mm, 0)) == 0.75

    @pytest.mark.parametrize("aside_mm", [-20, 0, 14, 30])
    def test_others_forgive_nothing(self, aside_mm: float) -> None:
        assert self.alone((aside_mm, 0)) == 1.0

    def test_a_row_of_grasps_forgives_all(self) -> None:
        assert self.alone((-10, 0), (-5, 0), (5, 0), (10, 0)) == 0.0

    def test_the_other_grasp_is_as_deep_within_3_mm_and_turned_by_less_than_15_degrees(self) -> None:
        assert (self.alone((10, 2)), self.alone((10, 4))) == (0.75, 1.0)
        assert (self.alone((12, 0)), self.alone((10, 0), turned_deg=180)) == (0.75, 0.75)
        assert (self.alone((10, 0), turned_deg=10), self.alone((10, 0), turned_deg=20)) == (0.75, 1.0)

    def test_of_some_hundred_grasps_each_is_held_against_every_other(self) -> None:
        where = np.arange(200) * 0.1
        middles = np.concatenate([np.column_stack([where, 0 * where]), np.column_stack([where + 0.01, 0 * where])])
        assert loneliness(middles, upright(400)) == pytest.approx(np.full(400, 0.75))

    def test_of_thousands_a_sample_is_enough_along_a_straight_side(self) -> None:
        middles = np.column_stack([np.arange(3000) * 0.1 * MM, np.zeros(3000)])
        assert loneliness(middles, upright(3000))[200:-200] == pytest.approx(np.zeros(2600))


def upright(count: int) -> FloatArray:
    return np.tile([0.0, 1.0], (count, 1))


def test_the_cheapest_comes_first_and_of_equals_the_one_that_needs_less_friction() -> None:
    table = {"cost": np.array([0.02, 0.01, 0.01]), "required_friction": np.array([0.0, 0.2, 0.1])}
    grasps: GraspCandidates = across([0.04] * 3, **table)[1]
    assert best_first(grasps).tolist() == [2, 1, 0]
