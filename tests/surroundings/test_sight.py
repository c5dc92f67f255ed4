"""What the sensor saw beside an object, told by profiles and views that are known to the millimetre."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli.funnel import Funnel, NothingLeft
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.model import FingerCandidates
from flatgrasp_cli.surroundings.maps import HeightMaps
from flatgrasp_cli.surroundings.sight import hidden_extent, hidden_share, of_known_thickness, seen_sides
from tests.by_hand import MM, Relief, across, candidates

LEVEL_M = 4 * MM
AT_ORIGIN = candidates(np.zeros((1, 2)), np.array([[0.0, 1.0]]))
"""One candidate: the object lies toward +y, the pad, 20 mm wide, along x."""


def surface(relief_mm: Relief) -> HeightMap:
    """The map of a surface whose height is given over x and y, the way inward, all in millimetres."""
    steps = np.arange(-59.75, 120.0, 0.5)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    return HeightMap.of(MM * np.column_stack([x, y, relief_mm(x, y)]), 0.5 * MM)


@dataclass(frozen=True)
class Seen:
    """A view in which space lies so far behind what was seen there: a function of x, the way out, and height, in mm."""

    behind_mm: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
    image: None = None

    def hides(self, columns: FloatArray, margin_m: float) -> BoolArray:
        x, y, z = columns / MM
        return np.asarray(MM * self.behind_mm(x, -y, z - LEVEL_M / MM) > margin_m)


def share(behind_mm: Callable[[FloatArray, FloatArray, FloatArray], Any]) -> float:
    """The hidden share of the space before the candidate."""
    view: Any = Seen(lambda x, out, up: np.where(behind_mm(x, out, up), 100.0, 0.0))
    return float(hidden_share(AT_ORIGIN, view, LEVEL_M)[0])


class TestHiddenShare:
    @pytest.mark.parametrize(("from_mm", "hidden"), [(2, 1), (4, 2 / 3), (6, 1 / 3), (8, 0)])
    def test_it_is_that_of_the_space_3_to_7_mm_before_the_chord(self, from_mm: float, hidden: float) -> None:
        assert share(lambda _x, out, _up: out > from_mm) == pytest.approx(hidden)

    @pytest.mark.parametrize(("below_mm", "hidden"), [(2, 0), (6, 0.5), (12, 1)])
    def test_and_3_to_10_mm_above_the_fingertips(self, below_mm: float, hidden: float) -> None:
        assert share(lambda _x, _out, up: up < below_mm) == pytest.approx(hidden)

    @pytest.mark.parametrize(("beyond_mm", "hidden"), [(3, 4 / 5), (5, 2 / 5), (9, 0)])
    def test_and_all_along_the_pad(self, beyond_mm: float, hidden: float) -> None:
        assert share(lambda x, _out, _up: np.abs(x) > beyond_mm) == pytest.approx(hidden)

    @pytest.mark.parametrize(("behind_mm", "hidden"), [(4, 0), (8, 1)])
    def test_6_mm_behind_a_surface_may_be_its_noise(self, behind_mm: float, hidden: float) -> None:
        view: Any = Seen(lambda x, _out, _up: np.full(len(x), behind_mm))
        assert hidden_share(AT_ORIGIN, view, LEVEL_M)[0] == hidden


def extent_mm(relief_mm: Relief, fall_deg: float) -> float:
    """How far what has that relief goes on beyond the chord, for a sensor so high above the horizon of the limb."""
    limb_mm = float(relief_mm(np.zeros(1), np.zeros(1))[0])
    fall = np.radians(fall_deg)
    sensor = np.array([0.0, np.cos(fall), np.sin(fall) + limb_mm * MM])
    return float(hidden_extent(AT_ORIGIN, surface(relief_mm), np.array([True]), sensor)[0]) / MM


def lying_can(radius_mm: float, limb_deg: float) -> Relief:
    """A can along x that is last seen where its surface has that slope: at the chord."""

    def relief(_x: FloatArray, y: FloatArray) -> FloatArray:
        from_axis = np.clip((radius_mm * np.sin(np.radians(limb_deg)) - y) / radius_mm, -1, 1)
        return np.asarray(radius_mm * (1 + np.sqrt(1 - from_axis**2)))

    return relief


class TestHiddenExtent:
    """Sensors see nothing at less than 15°: the slope of the limb is that of the ray less so much."""

    @pytest.mark.parametrize(("radius_mm", "limb_deg"), [(25, 45), (40, 45), (40, 55)])
    def test_a_lying_can_goes_on_to_where_it_is_widest(self, radius_mm: float, limb_deg: float) -> None:
        expected = radius_mm * (1 - np.sin(np.radians(limb_deg)))
        assert extent_mm(lying_can(radius_mm, limb_deg), limb_deg + 15) == pytest.approx(expected, rel=0.15)

    def test_no_more_than_3_cm_are_believed(self) -> None:
        assert extent_mm(lying_can(150, 30), 45) == pytest.approx(30)

    def test_a_box_ends_at_its_edge(self) -> None:
        assert extent_mm(lambda _x, y: 40 + 0 * y, 60) == 0

    @pytest.mark.parametrize(("rise", "rounded"), [(0.12, False), (0.4, True)])
    def test_a_surface_that_is_much_flatter_than_the_limb_ends_at_an_edge(self, rise: float, rounded: bool) -> None:
        assert (extent_mm(lambda _x, y: 20 + rise * np.minimum(y, 30), 60) > 0) == rounded

    def test_a_blunt_edge_is_an_edge(self) -> None:
        """2 mm lower at the outermost cell, as a camera smooths it: no flank."""
        assert extent_mm(lambda _x, y: np.where(y < 2, 38.0, 40.0), 60) == 0

    def test_its_height_is_that_of_the_first_4_cm(self) -> None:
        """What stands up farther inside is another part of the object."""
        can = lying_can(25, 45)
        alone = extent_mm(can, 60)
        assert extent_mm(lambda x, y: np.where(y > 45, 200.0, can(x, y)), 60) == alone
        assert extent_mm(lambda x, y: np.where(y > 15, 70.0, can(x, y)), 60) < 0.7 * alone

    def test_on_the_sensors_side_nothing_is_hidden(self) -> None:
        can = surface(lying_can(25, 45))
        assert hidden_extent(AT_ORIGIN, can, np.array([True]), np.array([0.0, -0.5, 0.8]))[0] == 0


def maps(relief_mm: Relief, face_mm: Relief) -> HeightMaps:
    """The maps of an object whose points lie so far below its surface on average."""
    top, mean = surface(relief_mm), surface(lambda x, y: relief_mm(x, y) - face_mm(x, y))
    return HeightMaps(surface=mean, average=mean, rest=top, highest=top, coarse=top)


def sides(hidden: float, face_mm: Relief = lambda _x, y: 0 * y, loop: int = 0) -> FingerCandidates:
    """What is left of the candidate on that loop, before a lying can of which such a share is hidden."""
    view: Any = Seen(lambda x, _out, _up: np.where(np.arange(len(x)) < round(hidden * len(x)), 100.0, 0.0))
    place = replace(AT_ORIGIN, loop=np.array([loop]))
    sensor = np.array([0.0, 0.5, 0.9])
    return seen_sides(place, maps(lying_can(25, 45), face_mm), view, sensor, LEVEL_M)


class TestSeenSides:
    @pytest.mark.parametrize(("hidden", "shadowed"), [(0.4, False), (0.6, True)])
    def test_a_side_lies_in_the_shadow_if_more_than_half_of_the_space_is_hidden(
        self, hidden: float, shadowed: bool
    ) -> None:
        assert (sides(hidden).hidden[0] > 1 * MM) == shadowed

    @pytest.mark.parametrize(("hidden", "left"), [(0.1, 1), (0.3, 0)])
    def test_a_hole_is_seen_through_if_no_more_than_a_fifth_is_hidden(self, hidden: float, left: int) -> None:
        assert len(sides(hidden, loop=1)) == left
        assert len(sides(hidden, loop=0)) == 1

    @pytest.mark.parametrize(("face_mm", "seen"), [(5, True), (12, False)])
    def test_points_8_mm_below_the_highest_are_those_of_a_face(self, face_mm: float, seen: bool) -> None:
        assert sides(1.0, lambda _x, y: face_mm + 0 * y).seen[0] == seen

    def test_a_face_shows_within_5_mm_of_the_chord(self) -> None:
        assert not sides(1.0, lambda _x, y: np.where(y < 6, 12.0, 0.0)).seen[0]
        assert not sides(1.0, lambda _x, y: np.where(y > 2, 15.0, 0.0)).seen[0]
        assert sides(1.0, lambda _x, y: np.where(y > 6, 100.0, 0.0)).seen[0]

    def test_in_the_light_all_was_seen(self) -> None:
        assert sides(0.0, lambda _x, y: 12 + 0 * y).seen[0]


@pytest.mark.parametrize(("distance_mm", "kept"), [(20, False), (40, True)])
def test_two_sides_of_a_seen_face_are_no_thin_object(distance_mm: float, kept: bool) -> None:
    """Within 3 cm they may be. Where both ends were seen it is as thin as it looks."""
    fingers, grasps = across([distance_mm * MM])
    assert len(of_known_thickness(fingers, grasps, Funnel())) == 1
    one_unseen = replace(fingers, seen=np.array([True, False]))
    if kept:
        assert len(of_known_thickness(one_unseen, grasps, Funnel())) == 1
        return
    with pytest.raises(NothingLeft, match="only a face of the object was seen"):
        of_known_thickness(one_unseen, grasps, Funnel())
