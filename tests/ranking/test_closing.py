"""Hands that stand where they should not: what they meet, by hand and by shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.model import OpenHands
from flatgrasp_cli.ranking.closing import Closed, closed
from tests.by_hand import MM
from tests.conftest import I_BEAM, disc, rectangle
from tests.ranking.situations import HAND, shape_of

BAR = rectangle(100, 40)


def hand(at_mm: tuple[float, float] = (0.0, 0.0), turn_deg: float = 0.0, opening_mm: float = 60.0) -> OpenHands:
    """A hand that closes along y, but turned."""
    turn = np.radians(turn_deg)
    where = np.array([*np.multiply(at_mm, MM), -np.sin(turn), np.cos(turn), 0.5 * opening_mm * MM])
    return OpenHands(where[None, None], np.zeros((1, 1)))


def one(region: shapely.Polygon, hands: OpenHands, tolerance_mm: float = 0.01) -> Closed:
    found = closed(shape_of(region).silhouette.loops, hands, HAND, tolerance_mm * MM)
    return Closed(*(row[0] for row in found))


class TestABar:
    def test_a_hand_where_it_should_be_stands_free_with_10_mm_a_side_and_its_rim(self) -> None:
        found = one(BAR, hand())
        assert (found.free[0], found.between[0], found.wedge[0]) == (True, True, 0.0)
        assert found.room[0] == pytest.approx(12.5 * MM)

    @pytest.mark.parametrize(("miss_mm", "free"), [(12.4, True), (12.6, False), (-12.4, True), (-12.6, False)])
    def test_it_comes_down_on_the_bar_once_it_misses_by_more_than_that(self, miss_mm: float, free: bool) -> None:
        assert one(BAR, hand((0.0, miss_mm))).free[0] == free

    @pytest.mark.parametrize(("miss_mm", "between"), [(59.9, True), (60.1, False)])
    def test_it_closes_beside_the_bar_half_a_finger_beyond_its_end(self, miss_mm: float, between: bool) -> None:
        assert one(BAR, hand((miss_mm, 0.0))).between[0] == between

    @pytest.mark.parametrize("turn_deg", [-8.0, 3.0, 12.0])
    def test_pads_turn_its_parallel_sides_flush(self, turn_deg: float) -> None:
        assert one(BAR, hand(turn_deg=turn_deg)).wedge[0] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("miss_mm", [0.0, 6.0, 12.0, 16.0, 20.0, -16.0])
def test_a_disc_is_pushed_out_by_the_edges_of_pads_beside_its_middle(miss_mm: float) -> None:
    """Of radius 25 mm: pads reach 10 mm to its side; what they lack to its middle makes both contacts slant alike."""
    beside = max(abs(miss_mm) - 10, 0.0)
    wedge = np.arctan(one(disc(25), hand((miss_mm, 0.0))).wedge[0])
    assert wedge == pytest.approx(np.arcsin(beside / 25), abs=np.radians(1))


@pytest.mark.parametrize("slope_deg", [5.0, 20.0, 40.0])
def test_the_sides_of_a_wedge_lie_aslant_by_half_its_angle(slope_deg: float) -> None:
    rise = 50 * np.tan(np.radians(slope_deg))
    wedge = shapely.Polygon([(-50, -60 + rise), (50, -60 - rise), (50, 60 + rise), (-50, 60 - rise)])
    found = one(shapely.affinity.scale(wedge, 0.2, 0.2, origin=(0, 0)), hand(opening_mm=90))
    assert np.arctan(found.wedge[0]) == pytest.approx(np.radians(slope_deg), abs=np.radians(0.5))


def test_a_side_that_is_flush_shares_the_slant_of_the_other() -> None:
    half = shapely.Polygon([(-10, -10), (10, -10), (10, 14), (-10, 6)])
    assert one(half, hand()).wedge[0] == pytest.approx(np.tan(0.5 * np.arctan(0.4)), abs=np.radians(0.5))


class TestAnIBeam:
    """A neck 30 mm wide and 40 mm long between flanges: a finger 20 mm wide has 10 mm to either side, and its rim."""

    @pytest.mark.parametrize(("miss_mm", "free"), [(0.0, True), (14.9, True), (15.1, False)])
    def test_the_notch_leaves_the_middle_of_the_fingers_15_mm(self, miss_mm: float, free: bool) -> None:
        found = one(I_BEAM, hand((0.0, miss_mm), -90.0, 50.0))
        assert (found.free[0], found.between[0]) == (free, True)

    def test_fingers_farther_out_than_the_flanges_stand_free_of_them(self) -> None:
        assert one(I_BEAM, hand(opening_mm=110)).free[0]


def test_a_finger_stands_free_in_a_hole_and_not_in_the_rim() -> None:
    ring = disc(40).difference(disc(20))
    assert one(ring, hand((0.0, 30.0), opening_mm=40)).free[0]
    assert not one(ring, hand((0.0, 30.0), opening_mm=110)).free[0]


@given(
    at=st.tuples(st.floats(-60, 60), st.floats(-60, 60)),
    turn=st.floats(0, 360),
    opening=st.floats(1, 150),
    corners=st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=3, max_size=8),
)
def test_free_and_between_are_what_shapely_finds(
    at: tuple[float, float], turn: float, opening: float, corners: list[tuple[float, float]]
) -> None:
    region = shapely.convex_hull(shapely.MultiPoint(corners))
    if not isinstance(region, shapely.Polygon) or region.area < 100:
        return
    found = one(shapely.orient_polygons(region), hand(at, turn, opening))
    seen = shapely.affinity.rotate(shapely.affinity.translate(region, -at[0], -at[1]), -turn, origin=(0, 0))
    face = opening / 2
    cores = [shapely.box(-5, low, 5, high) for low, high in ((face + 2.5, face + 7.5), (-face - 7.5, -face - 2.5))]
    overlap = sum(seen.intersection(core).area for core in cores)
    touch = any(seen.distance(core) < 1e-3 for core in cores)
    assert found.free[0] or touch
    assert not found.free[0] or overlap < 0.05
    strip = seen.intersection(shapely.box(-10, -face - 2.5, 10, face + 2.5))
    if found.free[0] and strip.area > 1 and not touch:
        assert found.between[0]
    if strip.is_empty:
        assert not found.between[0]
