"""How far the hand comes down on bars whose surroundings are known without noise, in millimetres, and how wide open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_settings
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.model import Grasp, ObjectPlan
from flatgrasp_cli.planning import plan_object
from flatgrasp_cli.ranking import TIE
from flatgrasp_cli.surroundings.below import fingers_meet, under_fingers, under_palm
from tests.by_hand import MM, Relief, across, bar, on_table
from tests.conftest import holds

PR2 = load_gripper("pr2")
SETTINGS = load_settings("default", ("caging.certify=false", "approach.directions=top")).resolve(PR2)


def bar_of(size_mm: Sequence[float], others: Relief | None = None, **changes: float) -> ObjectPlan:
    """The plan for a bar of that length, width and height amid others, for a PR2's hand with some changes."""
    length, width, height = np.multiply(size_mm, MM)
    cloud = on_table(bar(length, width, height), others=others)
    return plan_object(cloud, PR2.model_copy(update=changes), SETTINGS)


def best(item: ObjectPlan) -> Grasp:
    assert item.grasps, item.rejection
    return item.grasps[0]


def beside(gap_mm: float, height_mm: float) -> Relief:
    """All around a bar 40 mm wide, from `gap_mm` on, something so high."""
    return lambda x, y: np.where((np.abs(y) > (20 + gap_mm) * MM) | (np.abs(x) > 0.09), height_mm * MM, 0.0)


class TestTips:
    @pytest.mark.parametrize(("height_mm", "tip_mm"), [(40, 4), (16, 4), (13, 2.5), (11, 1.5), (3.2, 1.5)])
    def test_they_end_4_mm_over_the_table_or_below_the_middle_of_a_low_object(
        self, height_mm: float, tip_mm: float
    ) -> None:
        grasp = best(bar_of((100, 40, height_mm)))
        assert grasp.tip_height_m == pytest.approx(tip_mm * MM)
        assert grasp.grip_m == pytest.approx((height_mm - tip_mm) * MM)

    def test_the_middle_is_that_of_what_is_between_the_pads(self) -> None:
        """Scissors: high at the handles, which are too wide, and 12 mm high in front, of which half would be enough."""
        wide, low = bar(0.12, 0.12, 0.03), bar(0.10, 0.02, 0.012)
        item = plan_object(on_table(lambda x, y: np.maximum(wide(x + 0.06, y), low(x - 0.05, y))), PR2, SETTINGS)
        assert best(item).position[0] > 0
        assert best(item).tip_height_m == pytest.approx(2 * MM)

    @pytest.mark.parametrize(("step_mm", "tip_mm"), [(1.4, 4), (3, 4.5), (15, 18)])
    def test_they_keep_3_mm_from_what_lies_below_them_or_half_of_that(self, step_mm: float, tip_mm: float) -> None:
        """What is hardly higher than the table's own ripple is met by half of the clearance."""
        assert best(bar_of((100, 40, 50), beside(1, step_mm))).tip_height_m == pytest.approx(tip_mm * MM)

    def test_the_palm_keeps_4_mm_from_the_top(self) -> None:
        tall = best(bar_of((100, 40, 120)))
        assert tall.tip_height_m == pytest.approx(0.120 + 0.004 - PR2.finger_length_m)

    @pytest.mark.parametrize(("step_mm", "held"), [(28, True), (30, False)])
    def test_pads_hold_8_mm(self, step_mm: float, held: bool) -> None:
        assert bool(bar_of((100, 40, 40), beside(1, step_mm)).grasps) == held

    @pytest.mark.parametrize(("step_mm", "held"), [(1.4, True), (3.6, False)])
    def test_of_what_is_lower_than_16_mm_they_hold_half(self, step_mm: float, held: bool) -> None:
        """5 mm of a bar of 10 mm: 6.5 mm over the table, 3.4 mm over a step."""
        assert bool(bar_of((100, 40, 10), beside(1, step_mm)).grasps) == held


def test_a_piece_whose_foot_was_not_seen_is_had_where_the_largest_is_too_wide() -> None:
    """As a handle behind a bowl: beside a block 12 cm wide, 1 cm of nothing away, a bar 2 cm wide."""
    block, beside_it = bar(0.12, 0.12, 0.04), bar(0.06, 0.02, 0.012)
    item = plan_object(on_table(lambda x, y: np.maximum(block(x, y), beside_it(x - 0.1, y))), PR2, SETTINGS)
    assert abs(best(item).position[0] - 0.1) < 0.03
    assert best(item).width_m == pytest.approx(0.02, abs=2 * MM)


class TestTooHigh:
    """Fingertips that end some millimetres higher than they should."""

    @staticmethod
    def lost_by(height_mm: Relief) -> float:
        """How much less probably a bar with that top is held if heights are off by 3 mm and nothing else is."""
        outline = bar(0.1, 0.028, 1.0)
        cloud = on_table(lambda x, y: outline(x, y) * height_mm(x / MM, y / MM) * MM, pitch_m=0.5 * MM)
        chances = []
        for height_m in (0.0, 0.003):
            figures = ("position_m=0", "yaw_deg=0", "outline_m=0.0001", f"height_m={height_m}")
            asked = ("caging.certify=false", "approach.directions=top", *(f"uncertainty.{each}" for each in figures))
            chances.append(holds(best(plan_object(cloud, PR2, load_settings("default", asked).resolve(PR2)))))
        return chances[0] - chances[1]

    def test_slip_off_what_is_rounded_and_not_off_what_is_upright(self) -> None:
        assert self.lost_by(lambda _x, y: 14 + 0 * y) < 0.01
        assert self.lost_by(lambda _x, y: 7 + np.sqrt(np.maximum(49 - y**2 / 4, 0))) > 0.025


class TestOpening:
    """Openings leave 20, 14, 8 or 2 mm beside each pad; a finger is 9 mm thick."""

    def test_20_mm_are_free_beside_each_pad(self) -> None:
        grasp = best(bar_of((100, 40, 40)))
        assert grasp.opening_m - grasp.width_m == pytest.approx(40 * MM, abs=1e-6)

    @pytest.mark.parametrize(("gap_mm", "margin_mm"), [(22, 8), (15, 2)])
    def test_less_if_a_finger_would_come_down_on_a_wall(self, gap_mm: float, margin_mm: float) -> None:
        grasp = best(bar_of((100, 40, 40), beside(gap_mm, 50)))
        assert grasp.opening_m - grasp.width_m == pytest.approx(2 * margin_mm * MM, abs=1e-6)
        assert grasp.tip_height_m == pytest.approx(4 * MM)

    @pytest.mark.parametrize(("gap_mm", "margin_mm"), [(46, 20), (40, 14), (28, 8), (16, 2)])
    def test_less_if_a_wall_behind_the_finger_would_be_nearer_than_the_pad(
        self, gap_mm: float, margin_mm: float
    ) -> None:
        """20 mm beside the pad would leave 11 mm behind the finger of a gap of 40 mm, 14 mm leave 17 mm."""
        grasp = best(bar_of((100, 40, 40), beside(gap_mm, 50)))
        assert grasp.opening_m - grasp.width_m == pytest.approx(2 * margin_mm * MM, abs=1e-6)

    def test_a_finger_that_stands_in_the_middle_of_a_gap_is_as_good_as_one_with_room(self) -> None:
        """A hand that misses by less than 14 mm finds its place."""
        tight, free = best(bar_of((100, 40, 40), beside(40, 50))), best(bar_of((100, 40, 40)))
        assert holds(tight) == pytest.approx(holds(free), abs=TIE)

    @pytest.mark.parametrize(("step_mm", "margin_mm"), [(3.0, 20), (3.9, 8)])
    def test_but_not_for_less_than_a_millimetre_of_depth(self, step_mm: float, margin_mm: float) -> None:
        """The step lets the tips down to 4.5 mm, and to 5.4 mm, instead of 4 mm."""
        grasp = best(bar_of((100, 40, 40), beside(22, step_mm)))
        assert grasp.opening_m - grasp.width_m == pytest.approx(2 * margin_mm * MM, abs=1e-6)

    @pytest.mark.parametrize(("width_mm", "held"), [(85, True), (88, False)])
    def test_2_mm_a_side_are_the_least(self, width_mm: float, held: bool) -> None:
        assert bool(bar_of((150, width_mm, 40)).grasps) == held


class TestUnderFingers:
    """A pair across 40 mm, opened by 20 mm a side: the pads at ±20 mm, the fingers' backs at ±49 mm."""

    @staticmethod
    def charts(own_mm: tuple[float, float], seen_mm: float = 100.0) -> tuple[HeightMap, HeightMap]:
        """The table as far as it was seen, and the same with 30 mm of the object itself from one y to another."""
        steps = np.arange(-99.5, 100)
        x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
        table = np.column_stack([x, y, 0 * x])[y < seen_mm]
        own = np.column_stack([x, y, 30 + 0 * x])[(y > own_mm[0]) & (y < own_mm[1])]
        rest = HeightMap.of(MM * table, 1 * MM)
        return rest, rest.raised(MM * own)

    @staticmethod
    def under(charts: tuple[HeightMap, HeightMap]) -> tuple[float, float]:
        """Highest point below the fingers, and length of their way that no ray reached, millimetres."""
        _, grasps = across([0.04])
        highest, unseen = under_fingers(grasps, np.array([[0.02]]), *charts, PR2, 0.002)
        return float(highest[0, 0]) / MM, float(unseen[0, 0]) / MM

    @pytest.mark.parametrize(("own_mm", "met_mm"), [((22, 23), 0), ((23, 24), 30), ((47, 48), 30), ((51, 60), 0)])
    def test_within_2_mm_and_a_cell_of_the_pad_the_object_may_be_what_it_rests_on(
        self, own_mm: tuple[float, float], met_mm: float
    ) -> None:
        assert self.under(self.charts(own_mm))[0] == pytest.approx(met_mm)

    @pytest.mark.parametrize(("seen_mm", "unseen_mm"), [(100, 0), (39, 10), (-100, 58)])
    def test_the_length_that_no_ray_reached_is_that_of_both_sides(self, seen_mm: float, unseen_mm: float) -> None:
        assert self.under(self.charts((0, 0), seen_mm))[1] == pytest.approx(unseen_mm, abs=1.5)

    @pytest.mark.parametrize(("others_mm", "cause"), [(29.2, "neighbours"), (28.7, "itself")])
    def test_what_is_a_millimetre_lower_without_the_objects_points_is_the_object(
        self, others_mm: float, cause: str
    ) -> None:
        assert fingers_meet(0.001, 30 * MM, others_mm * MM).cause == cause


@pytest.mark.parametrize(("aside_m", "met"), [(0.01, True), (0.02, True), (0.03, False)])
def test_the_palm_meets_what_lies_below_it_and_half_a_cell_beside(aside_m: float, met: bool) -> None:
    """A PR2's is 52 mm wide across the closing axis."""
    post = HeightMap.of(np.array([[aside_m, 0.0, 0.1], [0.2, 0.2, 0.0], [-0.2, -0.2, 0.0]]), 5 * MM)
    highest = under_palm(np.array([[0.0, 0.0, 0.0, 1.0]]), np.zeros((1, 1)), post, 0.05, PR2)
    assert np.isfinite(highest[0, 0]) == met


@pytest.mark.parametrize(("opening_mm", "met"), [(20, False), (80, True)])
def test_the_roots_of_open_fingers_meet_what_the_palm_does_not(opening_mm: float, met: bool) -> None:
    """Of a hand with a palm 101 mm long, and fingers 37 mm thick at their roots: 80 mm open they reach 77 mm aside."""
    hand = PR2.model_copy(update={"palm_m": 0.101, "finger_root_m": 0.037})
    post = HeightMap.of(np.array([[0.0, 0.065, 0.1], [0.2, 0.2, 0.0], [-0.2, -0.2, 0.0]]), 5 * MM)
    highest = under_palm(np.array([[0.0, 0.0, 0.0, 1.0]]), np.array([[opening_mm * MM]]), post, 0.05, hand)
    assert np.isfinite(highest[0, 0]) == met


def test_the_hand_comes_and_goes_by_10_cm() -> None:
    grasp = best(bar_of((100, 40, 40)))
    assert grasp.pre_grasp.position - grasp.position == pytest.approx([0, 0, 0.1], abs=1e-9)
    assert grasp.lift.position - grasp.position == pytest.approx([0, 0, 0.1], abs=1e-9)
