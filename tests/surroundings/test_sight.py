"""How far an object goes on where it was not seen, told by profiles and envelopes that are known to the millimetre."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.model import FingerCandidates
from flatgrasp_cli.surroundings.envelope import Envelope
from flatgrasp_cli.surroundings.maps import HeightMaps
from flatgrasp_cli.surroundings.sight import hidden_extent, seen_sides, unseen_beyond
from flatgrasp_cli.surroundings.view import View
from tests.by_hand import MM, Relief, candidates

LEVEL_M, GRIP_M = 4 * MM, 8 * MM
CELL_M = 2 * MM
AT_ORIGIN = candidates(np.zeros((1, 2)), np.array([[0.0, 1.0]]))
"""One candidate: the object lies toward +y, the pad, 20 mm wide, along x."""
ANYTHING_M = 1.0
"""A bound that decides nothing."""


def surface(relief_mm: Relief) -> HeightMap:
    """The map of a surface whose height is given over x and y, the way inward, all in millimetres; NaN is unseen."""
    steps = np.arange(-59.75, 120.0, 0.5)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    heights = np.asarray(relief_mm(x, y), dtype=np.float64) + 0 * x
    seen = np.isfinite(heights)
    chart = HeightMap.around(MM * np.column_stack([x, y, 0 * x]), CELL_M)
    return chart.raised(MM * np.column_stack([x, y, heights])[seen])


def shadow(top_mm: Relief) -> View:
    """A view in which everything lower than a shadow's top, in millimetres over y, is hidden: rays from high above."""
    high_m, side_m = 100.0, 0.12
    pixels = Raster.over(np.full(2, -side_m / high_m), np.full(2, side_m / high_m), 0.25 * MM / high_m)
    x, y = np.meshgrid(*(pixels.origin[k] + pixels.cell_m * (np.arange(pixels.shape[k]) + 0.5) for k in (0, 1)))
    tops = np.asarray(top_mm(x.T * high_m / MM, -y.T * high_m / MM), dtype=np.float64) + 0 * x.T
    down = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    image = RangeImage(np.array([0.0, 0.0, high_m]), down, pixels, np.ascontiguousarray(high_m - MM * tops))
    return View(image, Frame(np.zeros(3), np.eye(3)), None)


def roof(bottom_mm: float, top_mm: float) -> View:
    """A view from far aside in which what is between two heights is behind something, and all else lies in the open."""
    far_m, side_m = 100.0, 0.12
    pixels = Raster.over(np.full(2, -side_m / far_m), np.full(2, side_m / far_m), 0.25 * MM / far_m)
    z = far_m * (pixels.origin[1] + pixels.cell_m * (np.arange(pixels.shape[1]) + 0.5))
    roofed = (z > MM * bottom_mm) & (z < MM * top_mm)
    ranges = np.broadcast_to(np.where(roofed, 0.5 * far_m, 2 * far_m), pixels.shape)
    aside = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    image = RangeImage(np.array([0.0, far_m, 0.0]), aside, pixels, np.ascontiguousarray(ranges))
    return View(image, Frame(np.zeros(3), np.eye(3)), None)


def behind_a_box(shadow_mm: Relief, top_mm: float = 40.0) -> Envelope:
    """The envelope about a box that reaches from y = 0 inward, with nothing seen outward of it."""
    return Envelope(surface(lambda _x, y: np.where(y >= 0, top_mm, np.nan)), shadow(shadow_mm))


def may_reach(envelope: Envelope, level_m: float, y_m: FloatArray) -> IntArray:
    """Whether (n,) something may reach a level at places of y alone: chords of no length, looked at where they are."""
    chords = np.zeros((len(y_m), 6))
    chords[:, 1] = y_m
    return envelope.going_on(level_m, chords, np.zeros(1), np.zeros(1))


class TestEnvelope:
    OUT_M = -MM * np.array([5.0, 15.0, 25.0, 35.0])

    def highest_mm(self, envelope: Envelope, y_m: FloatArray) -> FloatArray:
        """The highest level, to a millimetre, that something may reach."""
        levels = MM * np.arange(60.0)
        may = np.array([may_reach(envelope, level, y_m) for level in levels])
        return np.asarray(may.sum(axis=0))

    def test_behind_an_object_something_may_be_as_high_as_the_shadow(self) -> None:
        """A ray at 45° over the edge."""
        envelope = behind_a_box(lambda _x, y: 40 + y)
        assert (envelope.lowest.over(0 * self.OUT_M, self.OUT_M) == UNSEEN).all()
        assert self.highest_mm(envelope, self.OUT_M) == pytest.approx([35, 25, 15, 5], abs=1)

    def test_before_what_was_seen_deep_down_something_may_hide_all_the_same(self) -> None:
        """As it does for a hand that comes from where the sensor was not: under the brim of what it looked down on."""
        view = shadow(lambda _x, y: 40 + y)
        deep = surface(lambda _x, y: np.where(y >= 0, 40.0, 2.0))
        assert self.highest_mm(Envelope(deep, view), self.OUT_M) == pytest.approx([33, 23, 13, 3], abs=1)

    def test_what_was_seen_is_no_question(self) -> None:
        dark = shadow(lambda _x, y: 300 + 0 * y)
        seen = Envelope(surface(lambda _x, y: 40 + 0 * y), dark)
        assert not may_reach(seen, LEVEL_M, np.linspace(-30, 30, 9) * MM).any()

    def test_where_all_was_seen_to_be_free_nothing_may_stand(self) -> None:
        light = shadow(lambda _x, y: 0 * y)
        free = Envelope(surface(lambda _x, y: np.where(y >= 0, 40.0, 0.0)), light)
        assert not may_reach(free, LEVEL_M, np.linspace(-30, 30, 9) * MM).any()


class TestUnseenBeyond:
    @pytest.mark.parametrize("top_mm", [10.0, 20.0, 30.0])
    def test_it_reaches_to_where_the_lowest_ray_comes_down_to_the_fingertips(self, top_mm: float) -> None:
        envelope = behind_a_box(lambda _x, y: top_mm + y, top_mm)
        assert unseen_beyond(AT_ORIGIN, envelope, LEVEL_M)[0] == pytest.approx(top_mm * MM - LEVEL_M, abs=2 * CELL_M)

    def test_higher_up_the_shadow_is_narrower(self) -> None:
        envelope = behind_a_box(lambda _x, y: 40 + y)
        assert unseen_beyond(AT_ORIGIN, envelope, 25 * MM)[0] == pytest.approx(15 * MM, abs=2 * CELL_M)

    def test_nothing_is_looked_for_4_cm_beyond(self) -> None:
        dark = behind_a_box(lambda _x, y: 300 + 0 * y)
        assert unseen_beyond(AT_ORIGIN, dark, LEVEL_M)[0] == pytest.approx(40 * MM, abs=CELL_M)

    def test_a_flat_shadow_hides_nothing_of_what_fingers_reach(self) -> None:
        assert unseen_beyond(AT_ORIGIN, behind_a_box(lambda _x, y: 3 + 0 * y), LEVEL_M)[0] == 0

    @pytest.mark.parametrize(("seen_mm", "bound"), [(6, 0.0), (4, 36.0)])
    def test_half_of_the_pads_places_decide(self, seen_mm: float, bound: float) -> None:
        """Where the plane was seen beside a narrow shadow: at |x| of more than 6 or 4 mm on a pad of 20."""
        wide = surface(lambda _x, y: np.where(y >= 0, 40.0, np.nan))
        narrow = shadow(lambda x, _y: np.where(np.abs(x) < 10 - seen_mm, 300.0, 0.0))
        found = unseen_beyond(AT_ORIGIN, Envelope(wide, narrow), LEVEL_M)[0]
        assert (found > 0) == (bound > 0)


def maps(relief_mm: Relief) -> HeightMaps:
    """The maps of a surface that is all there is."""
    chart = surface(relief_mm)
    return HeightMaps(surface=chart, rest=chart, highest=chart, coarse=chart, others=chart)


def extent_mm(relief_mm: Relief, fall_deg: float, bound_m: float = ANYTHING_M) -> float:
    """How far what has that relief goes on beyond the chord, for a sensor so high above the horizon of the limb."""
    limb_mm = float(relief_mm(np.zeros(1), np.zeros(1))[0])
    fall = np.radians(fall_deg)
    sensor = np.array([0.0, np.cos(fall), np.sin(fall) + limb_mm * MM])
    return float(hidden_extent(AT_ORIGIN, maps(relief_mm), np.array([bound_m]), sensor)[0]) / MM


def lying_can(radius_mm: float, limb_deg: float) -> Relief:
    """A can along x that is last seen where its surface has that slope: at the chord."""

    def relief(_x: FloatArray, y: FloatArray) -> FloatArray:
        from_axis = (radius_mm * np.sin(np.radians(limb_deg)) - y) / radius_mm
        with np.errstate(invalid="ignore"):
            return np.asarray(radius_mm * (1 + np.sqrt(1 - from_axis**2)))

    return relief


class TestHiddenExtent:
    """Sensors see nothing at less than 15°: the slope of the limb is that of the ray less so much."""

    @pytest.mark.parametrize(("radius_mm", "limb_deg"), [(20, 25), (25, 45), (33, 25), (40, 45), (40, 55)])
    def test_a_lying_can_goes_on_to_where_it_is_widest(self, radius_mm: float, limb_deg: float) -> None:
        expected = radius_mm * (1 - np.sin(np.radians(limb_deg)))
        assert extent_mm(lying_can(radius_mm, limb_deg), limb_deg + 15) == pytest.approx(expected, rel=0.15)

    def test_no_farther_than_the_rays_allow(self) -> None:
        assert extent_mm(lying_can(33, 25), 40, bound_m=12 * MM) == pytest.approx(12)

    def test_a_box_ends_at_its_edge(self) -> None:
        assert extent_mm(lambda _x, y: 40 + 0 * y, 60) == 0

    @pytest.mark.parametrize("tilt", [0.05, -0.2, 0.2])
    def test_so_does_one_that_is_not_quite_level(self, tilt: float) -> None:
        assert extent_mm(lambda _x, y: 40 + tilt * (y - 20), 40) == 0

    def test_heights_are_known_to_a_millimetre(self) -> None:
        """What bends by less than that toward its edge is plane, and what bends by more is rounded."""

        def bent(by_mm: float) -> Relief:
            return lambda _x, y: 40 - by_mm * np.clip(1 - y / 20, 0, 1) ** 2

        assert extent_mm(bent(1.0), 40) == 0
        assert extent_mm(bent(6.0), 40) > 5

    def test_a_flank_may_go_over_into_a_level(self) -> None:
        """A cushion: a quarter of a circle of 30 mm and a level top, last seen 10 mm before it is upright."""

        def cushion(_x: FloatArray, y: FloatArray) -> FloatArray:
            return np.asarray(30 + 30 * np.sqrt(1 - np.clip((20 - y) / 30, 0, 1) ** 2))

        limb_deg = np.degrees(np.arctan(20 / np.sqrt(30**2 - 20**2)))
        assert extent_mm(cushion, limb_deg + 15) == pytest.approx(10, abs=2)

    def test_a_blunt_edge_is_an_edge(self) -> None:
        """2 mm lower at the outermost cell, as a camera blurs it: no flank."""
        assert extent_mm(lambda _x, y: np.where(y < 2, 38.0, 40.0), 60) == 0

    @pytest.mark.parametrize(("fall", "known"), [(0.4, True), (0.6, False)])
    def test_of_a_face_without_a_top_nobody_knows_how_thick_it_is(self, fall: float, known: bool) -> None:
        """It rises toward the far edge that it was last seen at: then the object goes on as far as the rays allow."""
        extent = extent_mm(lambda _x, y: np.where(y < 20, 40 - fall * y, np.nan), 40, bound_m=30 * MM)
        assert (extent < 20) if known else (extent == pytest.approx(30))

    @pytest.mark.parametrize(("fall_deg", "extent"), [(28, 30), (40, 0)])
    def test_nor_of_a_plane_that_turns_away_from_the_rays(self, fall_deg: float, extent: float) -> None:
        """One that falls by 14° was lost from sight by rays at 28°, and seen to end by rays at 40°."""
        slope = np.tan(np.radians(14))
        assert extent_mm(lambda _x, y: 40 + slope * y, fall_deg, bound_m=30 * MM) == pytest.approx(extent)

    def test_nor_of_a_strip_of_a_few_millimetres(self) -> None:
        """An upright face seen from the front is as broad as the sensor's noise."""
        assert extent_mm(lambda _x, y: np.where(y < 4, 40.0, np.nan), 40, bound_m=30 * MM) == pytest.approx(30)
        assert extent_mm(lambda _x, y: np.where(y < 8, 40.0, np.nan), 40, bound_m=30 * MM) == 0

    def test_on_the_sensors_side_a_flank_was_seen_to_its_end(self) -> None:
        found = hidden_extent(AT_ORIGIN, maps(lying_can(25, 45)), np.array([ANYTHING_M]), np.array([0.0, -0.5, 0.8]))
        assert found[0] == 0


def sides(envelope: Envelope, loop: int) -> FingerCandidates:
    """What is left of the candidate on that loop, before a lying can."""
    place = replace(AT_ORIGIN, loop=np.array([loop]))
    return seen_sides(place, maps(lying_can(25, 45)), envelope, np.array([0.0, 0.5, 0.9]), LEVEL_M, GRIP_M)


class TestSeenSides:
    def test_in_the_shadow_the_object_goes_on(self) -> None:
        assert sides(behind_a_box(lambda _x, y: 40 + y), loop=0).hidden[0] > 5 * MM

    def test_in_the_light_it_ends(self) -> None:
        assert sides(behind_a_box(lambda _x, y: 0 * y), loop=0).hidden[0] == 0

    def test_a_finger_stands_in_a_hole_only_if_that_was_seen_through(self) -> None:
        assert len(sides(behind_a_box(lambda _x, y: 0 * y), loop=1)) == 1
        assert len(sides(behind_a_box(lambda _x, y: 40 + y), loop=1)) == 0

    @pytest.mark.parametrize(("bottom_mm", "open_sides"), [(30, 0), (40, 1)])
    def test_it_was_seen_through_where_the_pad_will_be(self, bottom_mm: float, open_sides: int) -> None:
        """Aslant, what is far below the rim may be seen in the open: the can is 43 mm high at the chord."""
        roofed = replace(behind_a_box(lambda _x, y: 0 * y), view=roof(bottom_mm, top_mm=50))
        assert len(sides(roofed, loop=1)) == open_sides
        assert sides(roofed, loop=0).hidden[0] == 0
