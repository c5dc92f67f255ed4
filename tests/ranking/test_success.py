"""The probability that a grasp holds: by hand, by plain sampling, and each cause on its own."""

from __future__ import annotations

from itertools import pairwise
from math import erf, sqrt
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.model import Tolerance
from flatgrasp_cli.ranking import CAUSES, Situation
from flatgrasp_cli.ranking.success import PUSHED_ASIDE
from tests.by_hand import MM
from tests.conftest import I_BEAM, disc, rectangle
from tests.ranking.situations import (
    HAND,
    Around,
    by_monte_carlo,
    chance,
    grasp,
    moved_along_x,
    shape_of,
    situation,
    unsure,
)

BAR = rectangle(80, 40)
DISC = disc(25)


LONG = rectangle(400, 40)


def free(share: float) -> float:
    """How probably a grasp holds that comes down on the object unless it hits that share of the misses."""
    return share + PUSHED_ASIDE * (1 - share)


def within(limit_mm: float, spread_mm: float) -> float:
    """How probably a normally distributed miss is less."""
    return erf(limit_mm / (spread_mm * sqrt(2)))


class TestByHand:
    @pytest.mark.parametrize("spread_mm", [5, 8, 15])
    def test_a_bar_is_come_down_on_by_a_hand_that_misses_by_more_than_its_room(self, spread_mm: int) -> None:
        """10 mm to each side, and a quarter of a fingertip's thickness; the bar's ends are 30 mm away."""
        found = chance(situation(BAR, unsure(f"position_m={spread_mm * MM}")), grasp(40, 60))
        by_hand = free(within(12.5, spread_mm)) * within(50, spread_mm)
        assert found == pytest.approx(by_hand, abs=0.02)

    @pytest.mark.parametrize("spread_mm", [6, 9])
    def test_a_disc_slips_out_of_pads_too_far_beside_its_middle(self, spread_mm: int) -> None:
        """Friction 0.5 holds 26.6 degrees: pads may end 11.2 mm beside its middle, the hand 21.2 mm."""
        settings = unsure(f"position_m={spread_mm * MM}")
        found = chance(situation(DISC, settings), grasp(50, 120))
        aside = 10 + 25 * np.sin(np.arctan(0.5))
        assert found == pytest.approx(within(aside, spread_mm) * free(within(37.5, spread_mm)), abs=0.025)

    @pytest.mark.parametrize("spread_mm", [5, 10])
    def test_an_i_beams_notch_leaves_the_fingers_15_mm(self, spread_mm: int) -> None:
        turned = shapely.affinity.rotate(I_BEAM, 90)
        found = chance(situation(turned, unsure(f"position_m={spread_mm * MM}")), grasp(30, 50))
        assert found == pytest.approx(free(within(15, spread_mm) * within(12.5, spread_mm)), abs=0.03)

    def test_friction_is_there_or_not(self) -> None:
        """Walls that lean by 0.4 need 0.4; there is 0.3 to 0.7."""
        found = situation(BAR, unsure("friction_share=0.4")).tried(grasp(40, 60, lean=0.4))
        assert found.probability[0] == pytest.approx(0.75, abs=1e-4)
        assert dict(zip(CAUSES, found.causes[0], strict=True))["slips"] == pytest.approx(0.25)

    def test_walls_of_which_little_is_held_are_known_badly(self) -> None:
        """1 mm over both sides is 0.71 mm, over the half of 4 mm: the lean is 0.354 at one standard deviation."""
        found = chance(situation(BAR, unsure("outline_m=0.001")), grasp(40, 60, grip=4 * MM))
        assert found == pytest.approx(0.5 + 0.5 * within(0.5, 0.3536), abs=0.01)

    def test_what_is_too_heavy_for_the_hand(self) -> None:
        """96 cm³ at 200 to 30,000 kg/m³; 40 N and friction 0.5 lift 2.72 kg, which has 28,300."""
        found = chance(situation(BAR, unsure("density_kg_m3=[200,24000]")), grasp(40, 60))
        assert found == 1.0
        weak = HAND.model_copy(update={"max_force_n": 10.0})
        found = chance(situation(BAR, unsure("density_kg_m3=[200,24000]"), hand=weak), grasp(40, 60))
        heaviest = 2 * 0.5 * 10 / (1.5 * 9.80665) / (80 * 40 * 30 * MM**3)
        assert found == pytest.approx((heaviest - 200) / 23800, abs=0.01)
        stated = unsure("density_kg_m3=[200,24000]", "force_n=10")  # comes before what the hand's profile says
        assert chance(situation(BAR, stated), grasp(40, 60)) == found

    @pytest.mark.parametrize(
        ("fall", "mass_kg", "held"),
        [
            ((0.0, 0.0, -1.0), 0.53, True),
            ((0.0, 0.0, -1.0), 0.56, False),
            ((1.0, 0.0, 0.0), 1.60, True),
            ((1.0, 0.0, 0.0), 1.66, False),
            ((0.0, 1.0, 0.0), 2.30, True),
        ],
    )
    def test_what_leaning_walls_leave_of_the_friction_bears_the_weight(
        self, fall: tuple[float, float, float], mass_kg: float, held: bool
    ) -> None:
        """Of 0.5 a lean of 0.4 leaves 0.1 the same way, 0.3 across it: 2 × 40 N bear 8 or 24 N: 1.5 weights."""
        density = mass_kg / (80 * 40 * 30 * MM**3)
        around = Around(fall=fall)
        found = chance(situation(BAR, unsure(f"density_kg_m3=[{density},{density}]"), around), grasp(40, 60, lean=0.4))
        assert (found > 0.5) == held

    @pytest.mark.parametrize(("height_mm", "held"), [(20.0, True), (23.9, True), (24.1, False)])
    def test_a_hand_that_is_stopped_holds_what_is_left(self, height_mm: float, held: bool) -> None:
        """The pads would hold from 5 to 25 mm; with less than a millimetre they hold nothing."""
        assert chance(situation(BAR, unsure(), Around(height_mm * MM)), grasp(40, 60)) == float(held)

    def test_a_height_that_is_off_is_held_less_of(self) -> None:
        """Pads that would hold 4 mm hold nothing if they are more than 3 mm too high."""
        found = chance(situation(BAR, unsure("height_m=0.003")), grasp(40, 60, grip=4 * MM))
        assert found == pytest.approx(0.5 + 0.5 * within(3, 3), abs=0.01)

    def test_walls_lean_more_higher_up(self) -> None:
        """Pads over 20 mm that hold nothing of what is upright: 6 mm up walls lean by 0.4, 5 mm up by 0.35."""
        table = grasp(40, 60, lean=[0.25, 0.35, 0.55, 0.9])
        found = [
            situation(BAR, unsure("friction_share=0.4"), Around(height_mm * MM)).tried(table).probability[0]
            for height_mm in (5.0, 10.0, 11.25, 15.0)
        ]
        assert found == pytest.approx([1.0, 0.875, 0.75, 0.375], abs=1e-4)

    @pytest.mark.parametrize(
        ("fall", "density", "held"),
        [
            ((0.0, 0.0, -1.0), 800.0, 1.0),
            ((1.0, 0.0, 0.0), 800.0, 1.0),
            ((0.0, 1.0, 0.0), 650.0, 1.0),
            ((0.0, 1.0, 0.0), 800.0, 0.0),
        ],
    )
    def test_a_deep_object_tilts_out_of_a_hand_along_the_table(
        self, fall: tuple[float, float, float], density: float, held: float
    ) -> None:
        """Its middle is 18 cm deeper than the contacts. Where it falls across the closing axis, it turns about that
        and is up by half.

        Where it falls along the axis, two pads 20 mm high bear 40 N × 20 mm, and friction the rest across 40 mm: at
        650 kg/m³, 8.2 N, 0.42; at 800 kg/m³, 10.0 N, 0.63. There is 0.5.
        """
        settings = unsure(f"density_kg_m3=[{density},{density}]")
        deep = Situation(shape_of(BAR, 0.4), Around(fall=fall), HAND, settings)
        assert chance(deep, grasp(40, 60)) == pytest.approx(held)

    @pytest.mark.parametrize(("raised", "held"), [(0, 0.0), (1, 1.0)], ids=["goes up", "goes down"])
    def test_a_rim_at_the_end_that_goes_up_is_not_pressed_low_down(self, raised: int, held: float) -> None:
        """The one of 650 kg/m³, whose wall on that side ends at its top: friction has to bear it all, 0.92."""
        feet = np.full((1, 2, 2), 5 * MM)
        feet[0, raised] = 25 * MM
        settings, around = unsure("density_kg_m3=[650,650]"), Around(fall=(0.0, 1.0, 0.0))
        deep = Situation(shape_of(BAR, 0.4), around, HAND, settings)
        assert chance(deep, grasp(40, 60, feet=feet)) == pytest.approx(held)

    @pytest.mark.parametrize("side", [0, 1])
    @pytest.mark.parametrize(("low_mm", "high_mm", "held"), [(25, 25, 1.0), (45, 45, 0.5), (25, 45, 0.9)])
    def test_a_rim_above_the_other_wall_is_pushed_aslant(
        self, side: int, low_mm: float, high_mm: float, held: float
    ) -> None:
        """Pads 40 mm apart that push 20 mm higher on one side need a friction of 0.5 there; there is 0.3 to 0.7.

        Of a rim that ends anywhere in these 20 mm, friction bears the lower 12 mm surely, and three quarters of the
        rest.
        """
        feet = np.full((1, 2, 2), 5 * MM)
        feet[0, side] = low_mm * MM, high_mm * MM
        found = situation(BAR, unsure("friction_share=0.4")).tried(grasp(40, 60, feet=feet))
        assert found.probability[0] == pytest.approx(held, abs=0.01)
        assert found.causes[0, CAUSES.index("slips")] == pytest.approx(1 - found.probability[0], abs=1e-3)

    @pytest.mark.parametrize("dark", [0.0, 0.5, 1.0])
    def test_what_was_not_seen_may_be_there(self, dark: float) -> None:
        found = chance(situation(BAR, unsure("occupied_share=0.2"), Around(dark=dark)), grasp(40, 60))
        assert found == pytest.approx(1 - 0.2 * dark)

    def test_an_object_that_goes_on_unseen_may_do_so_by_less(self) -> None:
        """30 mm at most, evenly: the finger stands 10 mm beside what was seen, and may push aside 2.5 mm."""
        found = chance(situation(BAR, unsure()), grasp(40, 60, hidden=np.array([[0.0, 30 * MM]])))
        assert found == pytest.approx(free(12.5 / 30), abs=0.01)


@pytest.mark.parametrize(
    "region", [BAR, DISC, shapely.affinity.rotate(rectangle(70, 30), 8)], ids=["bar", "disc", "askew"]
)
@pytest.mark.parametrize("changes", [("position_m=0.008",), ("position_m=0.006", "yaw_deg=6", "friction_share=0.4")])
def test_it_is_what_plain_sampling_finds(region: shapely.Polygon, changes: tuple[str, ...]) -> None:
    settings = unsure(*changes)
    width = region.bounds[3] - region.bounds[1]
    slow = by_monte_carlo(region, width + 16, settings, 1500)
    assert 0.5 < slow < 0.999
    assert chance(situation(region, settings), grasp(width, width + 16)) == pytest.approx(slow, abs=0.04)


class TestMoreAndLess:
    @pytest.mark.parametrize(
        "name", ["position_m", "height_m", "yaw_deg", "friction_share", "outline_m", "center_share"]
    )
    def test_more_error_never_holds_better(self, name: str) -> None:
        top = {"position_m": 0.03, "height_m": 0.02, "yaw_deg": 40, "friction_share": 0.9, "outline_m": 0.01}.get(
            name, 0.9
        )
        pads = grasp(40, 56, grip=6 * MM, lean=0.3, hidden=np.array([[0.0, 4 * MM]]))
        heavy = ("density_kg_m3=[600,900]", "force_n=40")
        found = [chance(situation(LONG, unsure(*heavy, f"{name}={top * k / 8}")), pads) for k in range(9)]
        assert all(less >= more - 0.004 for less, more in pairwise(found))  # a sample or two
        assert found[0] > found[-1]

    @given(low=st.floats(0.05, 2), more=st.floats(0, 1), lean=st.floats(0, 1), grip=st.floats(1, 30))
    def test_more_friction_never_holds_worse(self, low: float, more: float, lean: float, grip: float) -> None:
        table = grasp(40, 56, lean=lean, grip=grip * MM)
        found = [
            chance(
                situation(
                    BAR, unsure("position_m=0.006", "samples=64"), hand=HAND.model_copy(update={"pad_friction": mu})
                ),
                table,
            )
            for mu in (low, low + more)
        ]
        assert found[1] >= found[0]


ALONE: dict[str, tuple[tuple[str, ...], Any, Any]] = {
    "lands_on_object": (("position_m=0.012",), Around(), grasp(40, 44)),
    "stopped_short": (("occupied_share=0.5",), Around(dark=1.0), grasp(40, 60)),
    "closes_beside": (("position_m=0.02",), Around(), moved_along_x(grasp(1, 60), 60.0)),
    "slips": (("friction_share=0.4",), Around(), grasp(40, 60, lean=0.5)),
    "too_heavy": (("density_kg_m3=[20000,25000]", "friction_share=0.4"), Around(), grasp(40, 60)),
    "turns": (("density_kg_m3=[900,901]", "center_share=0.4"), Around(), grasp(40, 60)),
}


@pytest.mark.parametrize("cause", CAUSES)
def test_each_cause_on_its_own_is_named_and_no_other(cause: str) -> None:
    changes, around, table = ALONE[cause]
    region = {"turns": LONG, "lands_on_object": LONG, "closes_beside": rectangle(80, 1)}.get(cause, BAR)
    hand = HAND.model_copy(update={"max_force_n": 30.0}) if cause == "too_heavy" else HAND
    found = situation(region, unsure(*changes), around, hand).tried(table)
    shares = dict(zip(CAUSES, found.causes[0], strict=True))
    assert 0 < shares.pop(cause) <= 1
    assert max(shares.values()) < 1e-4 or cause == "closes_beside"
    assert max(shares, key=lambda name: shares[name]) != cause


def test_the_parts_make_the_whole() -> None:
    settings = unsure("position_m=0.008", "friction_share=0.4", "occupied_share=0.2", "height_m=0.003")
    found = situation(BAR, settings, Around(dark=0.5)).tried(grasp(40, 56, lean=0.3, grip=5 * MM))
    assert np.prod(found.success[0]) == pytest.approx(found.probability[0])
    assert found.causes[0].sum() + found.probability[0] == pytest.approx(1)
    assert (found.causes[0] >= 0).all()


@pytest.mark.parametrize("samples", [1, 2, 50, 128])
def test_what_is_tried_briefly_and_then_to_the_end_is_tried_with_all_samples(samples: int) -> None:
    settings = unsure("position_m=0.008", "friction_share=0.4", "occupied_share=0.2", f"samples={samples}")
    whole, table = situation(BAR, settings, Around(dark=0.5)), grasp(40, 50, lean=0.3, grip=5 * MM)
    at_once, bit_by_bit = whole.tried(table), whole.to_the_end.tried(whole.briefly.tried(table))
    for name in ("probability", "success", "causes"):
        assert getattr(bit_by_bit, name) == pytest.approx(getattr(at_once, name), abs=1e-12)


def test_inside_a_basin_closing_ends_in_the_grasp() -> None:
    """Though a disc is pushed out of pads beside its middle: its cage forgives 6 cm, but no lean of its walls."""
    settings = unsure("position_m=0.012")
    everywhere = Tolerance(position_m=0.06, along_m=0.06, across_m=0.06, rotation_deg=90.0, lever_m=0.0)
    found, table = situation(DISC, settings), grasp(50, 120)
    without, inside = (found.tried(table, known).probability[0] for known in ((), (everywhere,)))
    assert without < 0.95
    assert inside > 0.985
    slanted = found.tried(grasp(50, 120, lean=0.6), (everywhere,)).probability[0]
    assert slanted == 0.0


def test_of_an_object_alone_nothing_is_known_of_walls_and_heights() -> None:
    alone = grasp(40, 60, grip=np.nan)
    assert chance(situation(BAR, unsure("outline_m=0.01")), alone) == 1.0


def test_a_fingertip_on_the_object_is_pushed_aside_four_times_in_five() -> None:
    """The hand stands 15 mm beside where it should, 2.5 mm too far."""
    beside = grasp(40, 60)
    beside = beside.having(middle=beside.middle + np.array([0.0, 15 * MM]))
    assert chance(situation(BAR, unsure()), beside) == pytest.approx(0.8)


@pytest.mark.parametrize(
    ("density", "grip_mm", "held"), [(640, 20, 1.0), (640, 2, 1.0), (2500, 20, 1.0), (2500, 2, 0.0)]
)
def test_what_turns_about_the_pads_slides_meanwhile_and_must_not_slide_out(
    density: float, grip_mm: float, held: float
) -> None:
    """A bar of 40 cm, gripped 15 cm beside its middle: 310 g or 1.2 kg. Its middle comes up by more than half.

    Pads of 20 mm have a mean radius of 7.7 mm, by 2 mm high ones of 5.1 mm: it turns by some 90°, and slides by 12 or
    8 mm where the weight takes 0.7 of the friction. The light one takes 0.1 of 0.5; of the heavy one's 0.22 four times
    as much is needed for what is to stay between 2 mm.
    """
    table = moved_along_x(grasp(40, 60, grip=grip_mm * MM), 150.0)
    found = chance(situation(LONG, unsure(f"density_kg_m3=[{density},{density}]")), table)
    assert found == pytest.approx(held)


@pytest.mark.parametrize(("beside_mm", "density", "held"), [(0, 500, 1.0), (-190, 500, 0.0), (-190, 60, 1.0)])
def test_a_hammer_that_is_held_at_its_end_must_not_turn(beside_mm: float, density: float, held: float) -> None:
    """40 cm long, its middle 10 cm beside the handle's: held at its end it lies on its head, unless it is light."""
    hammer = rectangle(400, 40) | shapely.affinity.translate(rectangle(60, 400), 170)
    settings = unsure(f"density_kg_m3=[{density},{density}]")
    assert chance(situation(hammer, settings), moved_along_x(grasp(40, 60), beside_mm)) == held
