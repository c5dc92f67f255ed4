"""Hands that come aslant: from where, over what, and only through space that was seen; the table's top is z = 0."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli import Plan, load_gripper, load_settings, plan
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.geometry.raster import Raster
from flatgrasp_cli.model import ObjectCloud, OrientedBox, SupportPlane
from flatgrasp_cli.scene import segment
from flatgrasp_cli.surroundings import Aslant, Direction, Tilted, beside, between, directions, tilt_deg
from tests.conftest import MM, TABLE, Box, Camera, Tube
from tests.scene.test_heaps import distance, walls
from tests.surroundings.on_a_table import hand_in

UP = np.array([0.0, 0.0, 1.0])
SETTINGS = load_settings()
BIN = walls(0.12)
AT_WALL = Box((0.125, 0.0, 0.015), (0.03, 0.12, 0.03))
"""A bar along a wall that is 55 mm away and 120 mm high; a PR2's palm would come down on that."""
ABOVE = Camera(tilt_deg=5, distance=0.9, pixels=(400, 300), focal=400.0)


def turned(angle_deg: float) -> Frame:
    """A frame turned about x, 10 cm up."""
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return Frame(np.array([0.02, -0.03, 0.1]), np.array([[1.0, 0, 0], [0, c, s], [0, -s, c]]))


@pytest.mark.parametrize("angle_deg", [0, 30, -60])
def test_an_aslant_axis_meets_the_heights_over_the_plane(angle_deg: float) -> None:
    """Over a plane with steps of a millimetre along x, each cell's axis meets z = 0 where it should."""
    raster = Raster.over(np.full(2, -0.5), np.full(2, 0.5), 0.01)
    rows = raster.middles(np.arange(raster.shape[0]), np.zeros(raster.shape[0], dtype=np.intp))[:, 0]
    floor = HeightMap(raster, np.repeat(np.round(rows, 2)[:, None] * 0.1, raster.shape[1], axis=1))
    frame = turned(angle_deg)
    chart = HeightMap.around(np.array([[-0.05, -0.05, 0.0], [0.05, 0.05, 0.0]]), 0.01)
    found = chart.filled(floor, frame, Frame(np.zeros(3), np.eye(3)))
    row, column = np.nonzero(np.isfinite(found.heights))
    world = frame.to_world(np.column_stack([found.raster.middles(row, column), found.heights[row, column]]))
    assert len(world) > 80
    assert np.abs(world[:, 2] - 0.1 * world[:, 0]).max() < 2.5 * MM / np.cos(np.radians(angle_deg))


class TestDirections:
    ITEM = ObjectCloud(0, np.zeros((40, 3)), UP, None, SupportPlane(UP, 0.0, 1 * MM))
    SIDE = np.array([0.6, 0.8, 0.0])

    def around(self, item: ObjectCloud = ITEM, own: OrientedBox | None = None, **asked: Any) -> list[Direction]:
        return list(directions(item, self.SIDE, own, SETTINGS.approach.model_copy(update=asked)))

    def test_hands_come_from_all_around_and_first_along_the_objects_side(self) -> None:
        found = self.around(tilts_deg=(30.0, 60.0, 90.0))
        assert len(found) == 24
        for k, tilt in enumerate((30, 60, 90)):
            toward = np.array([each.toward for each in found[8 * k : 8 * k + 8]])
            assert np.linalg.norm(toward, axis=1) == pytest.approx(1)
            assert [tilt_deg(each, UP) for each in toward] == pytest.approx([tilt] * 8)
            assert toward.mean(axis=0)[:2] == pytest.approx(0, abs=1e-9)
            assert toward[0] == pytest.approx(np.cos(np.radians(tilt)) * UP + np.sin(np.radians(tilt)) * self.SIDE)

    def test_before_that_along_the_main_plane_s_normal_and_the_view(self) -> None:
        seen = replace(self.ITEM, viewpoint=np.array([0.0, -0.6, 0.8]))
        leaning = Frame(np.zeros(3), turned(40).axes)
        first, second, *_ = self.around(seen, OrientedBox(leaning, np.ones(3), np.array([np.zeros(3), np.ones(3)])))
        assert (first.known_from, second.known_from) == ("main_plane", "view")
        assert first.toward == pytest.approx(leaning.axes[2])
        assert second.toward == pytest.approx([0.0, -0.6, 0.8])

    @pytest.mark.parametrize(("own_deg", "count"), [(4, 0), (6, 1)])
    def test_without_tilts_what_is_hardly_turned_is_straight_down(self, own_deg: float, count: int) -> None:
        box = OrientedBox(Frame(np.zeros(3), turned(own_deg).axes), np.ones(3), np.array([np.zeros(3), np.ones(3)]))
        assert len(self.around(own=box, tilts_deg=())) == count

    def test_no_tilt_is_larger_than_the_largest_that_is_wanted(self) -> None:
        seen = replace(self.ITEM, viewpoint=np.array([0.0, -0.6, 0.8]))
        found = self.around(seen, max_tilt_deg=35.0, tilts_deg=(15.0, 30.0, 60.0))
        assert len(found) == 16
        assert max(tilt_deg(each.toward, UP) for each in found) == pytest.approx(30)

    def test_beside_one_are_those_halfway_to_its_neighbours(self) -> None:
        one = self.around()[8 + 2]  # 15 degrees, a quarter of a turn from the side
        found = list(beside(one, self.ITEM, SETTINGS.approach))
        assert len(found) == 8
        tilts = [tilt_deg(each.toward, UP) for each in found]
        assert sorted({round(each, 1) for each in tilts}) == [10.6, 15.0, 21.2]
        level = np.array([each.toward[:2] / np.linalg.norm(each.toward[:2]) for each in found])
        turns = np.degrees(np.arccos(np.clip(level @ [-0.8, 0.6], -1, 1)))
        assert turns == pytest.approx([0, 0, *[22.5] * 6], abs=1e-6)
        flat = self.around()[-1]
        assert max(tilt_deg(each.toward, UP) for each in beside(flat, self.ITEM, SETTINGS.approach)) <= 90 + 1e-6

    def test_between_all_of_them_are_as_many(self) -> None:
        tried = np.array([each.toward for each in self.around()])
        found = np.array([each.toward for each in between(self.ITEM, self.SIDE, SETTINGS.approach)])
        assert found[:, 2] == pytest.approx(tried[:, 2])
        level = [each[:, :2] / np.linalg.norm(each[:, :2], axis=1, keepdims=True) for each in (tried, found)]
        assert (level[0] * level[1]).sum(axis=1) == pytest.approx(np.cos(np.radians(22.5)))

    def test_no_hand_comes_from_behind(self) -> None:
        """Of 16 tilts the sensor, 37 degrees aslant, sees three from behind: 60 degrees, and 90, away from it.

        Those that come across its view remain, and what is asked for by hand.
        """
        seen = replace(self.ITEM, viewpoint=np.array([0.0, -0.6, 0.8]))
        asked = SETTINGS.approach.model_copy(update={"tilts_deg": (60.0, 90.0)})
        away = np.array([0.0, 1.0, 0.0])
        found = [each.toward for each in directions(seen, away, None, asked) if each.known_from == "tilt"]
        turns = [round(float(np.degrees(np.arctan2(abs(x), y)))) for x, y, _ in found]
        assert turns == [45, 90, 135, 180, 135, 90, 45, 90, 135, 180, 135, 90]
        middle = [each.toward[1] for each in between(seen, away, asked)]
        assert max(middle[:8]) > 0 > max(middle[8:])
        nearly = Direction(found[0], "tilt")
        assert 0 < len(list(beside(nearly, seen, asked))) < len(list(beside(nearly, self.ITEM, asked)))
        given = asked.model_copy(update={"directions": (0.0, -1.0, 0.0)})
        assert len(list(directions(seen, away, None, given))) == 1

    def test_of_what_was_asked_for_there_are_none_beside(self) -> None:
        given = SETTINGS.approach.model_copy(update={"directions": (0.0, 0.6, -0.8)})
        assert list(beside(Direction(np.array([0.0, -0.6, 0.8]), "given"), self.ITEM, given)) == []
        assert list(between(self.ITEM, self.SIDE, given)) == []

    @pytest.mark.parametrize(("asked", "toward"), [("view", (0.0, -0.6, 0.8)), ((0.0, 0.0, -2.0), (0.0, 0.0, 1.0))])
    def test_a_direction_that_is_asked_for_is_the_only_one(self, asked: Any, toward: tuple[float, ...]) -> None:
        seen = replace(self.ITEM, viewpoint=np.array([0.0, -0.6, 0.8]))
        (found,) = self.around(seen, directions=asked)
        assert found.toward == pytest.approx(toward)
        assert self.around(seen, directions="top") == []


def planned(*overrides: str, camera: Camera = ABOVE) -> Plan:
    cloud = camera.sees(TABLE, *BIN, AT_WALL)
    return plan(cloud, load_gripper("pr2"), load_settings("default", overrides))


class TestInABin:
    def test_what_stands_at_a_wall_is_had_aslant_and_no_wall_is_touched(self) -> None:
        down = planned("approach.directions=top").best
        assert down is None or down.tilt_deg == pytest.approx(0)
        found = planned()
        assert found.best is not None, found.reason
        for grasp in found.objects[0].grasps:
            assert grasp.tilt_deg == pytest.approx(30), "15 degrees leave one that holds in six of ten"
            assert axes_from_quaternion(grasp.orientation)[2][0] > 0.1, "it leans away from the wall"
            for back in (0.0, 0.03, 0.06, 0.1):
                hand = hand_in(grasp, found.gripper, back_m=back)
                assert min(distance(wall, hand).min() for wall in BIN) > 0
                assert hand[:, 2].min() > 0

    def test_where_none_is_enough_those_beside_the_best_are_tried(self) -> None:
        """Tilts of 10 degrees are too little, and the view's direction, 20 degrees, is turned too far from the wall."""
        found = planned("approach.tilts_deg=[10]").best
        assert found is not None
        assert found.approach.known_from == "tilt"
        assert found.tilt_deg == pytest.approx(20, abs=0.5)

    def test_beside_a_lone_wall_hands_lean_away_from_it(self) -> None:
        """On a table they are tried where only the palm is in the way."""
        cloud = ABOVE.sees(TABLE, BIN[1], AT_WALL)
        down = plan(cloud, load_gripper("pr2"), load_settings("default", ("approach.directions=top",)))
        found = plan(cloud, load_gripper("pr2"))
        bar = [min(plans.objects, key=lambda item: len(item.object.points)) for plans in (down, found)]
        assert not bar[0].grasps
        assert bar[1].grasps
        for grasp in bar[1].grasps:
            assert (
                min(distance(BIN[1], hand_in(grasp, found.gripper, back_m=back)).min() for back in (0, 0.05, 0.1)) > 0
            )

    def test_no_hand_comes_through_what_was_not_seen(self) -> None:
        """With nearly all of its way to be seen there is a grasp; if none of it may be hidden by anything, fewer."""
        some, none = (planned(f"approach.hidden_share={share}") for share in (0.1, 0.0001))
        counts = [sum(len(item.grasps) for item in found.objects) for found in (some, none)]
        assert counts[0] >= counts[1]
        assert counts[0] > 0

    def test_behind_the_object_a_finger_may_stand_where_nothing_was_seen(self) -> None:
        """The bar's far side and the gap to the wall lie in its own shadow, as below a hand from straight above."""
        bar = Box((0.0, 0.115, 0.015), (0.12, 0.03, 0.03))
        cloud = Camera(tilt_deg=20, distance=0.9, pixels=(400, 300), focal=400.0).sees(TABLE, *BIN, bar)
        found = plan(cloud, load_gripper("pr2"))
        assert found.best is not None, found.reason
        assert found.best.tilt_deg > 1
        for back in (0.0, 0.03, 0.06, 0.1):
            hand = hand_in(found.best, found.gripper, back_m=back)
            assert min(distance(solid, hand).min() for solid in (*BIN, bar)) > 0
            assert hand[:, 2].min() > 0


class TestBody:
    """A box 6 cm high, seen from one side."""

    BOX = Box((0.0, 0.0, 0.03), (0.1, 0.06, 0.06))
    CAMERA = Camera(tilt_deg=35)

    def tilted(self) -> Tilted:
        item = segment(self.CAMERA.sees(TABLE, self.BOX), SETTINGS.scene, 0).objects[0]
        assert item.floor is not None
        return Tilted(item, item.floor, SETTINGS.resolve(load_gripper("pr2")))

    def test_along_the_plane_all_that_lies_below_it_is_in_the_way_and_nothing_above(self) -> None:
        """A hand from the front, 4 mm over the table at least: the clearance that fingertips have from above."""
        place = self.tilted().whole(np.array([0.0, -1.0, 0.0]), load_gripper("pr2"))
        assert place is not None
        beside = place.frame.to_local(np.array([[0.08, 0.0, height] for height in (0.001, 0.012, 0.04)]))
        low, high, higher = place.surroundings.maps.rest.over(*beside[:, :2].T)  # type: ignore[attr-defined]
        assert low > 1
        assert max(high, higher) < -1

    def test_it_is_known_which_of_its_surface_was_seen_and_which_was_taken_to_be_there(self) -> None:
        toward = np.array([0.0, np.sin(np.radians(60)), np.cos(np.radians(60))])
        place = self.tilted().whole(toward, load_gripper("pr2"))
        assert place is not None
        around = place.surroundings
        assert isinstance(around, Aslant)
        seen = np.isfinite(around.own.over(*place.points[:, :2].T))
        assert 0.2 < seen.mean() < 0.9

    def test_what_was_hidden_below_its_rim_belongs_to_it(self) -> None:
        """Its far side was not seen. A hand from over there finds it as high as it is, 6 cm, and not the top's edge."""
        toward = np.array([0.0, np.sin(np.radians(30)), np.cos(np.radians(30))])
        place = self.tilted().whole(toward, load_gripper("pr2"))
        assert place is not None
        points = place.frame.to_world(place.points)
        far = points[points[:, 1] > 0.025]
        assert far[:, 2].min() < 10 * MM
        assert distance(self.BOX, points).max() < 4 * MM

    def test_so_it_does_before_the_side_that_was_seen(self) -> None:
        """Along the table from over there, the side that the camera looked at lies right behind the hidden one."""
        place = self.tilted().whole(np.array([0.0, 1.0, 0.0]), load_gripper("pr2"))
        assert place is not None
        points = place.frame.to_world(place.points)
        amid = (np.abs(points[:, 0]) < 0.04) & (np.abs(points[:, 2] - 0.03) < 0.02)
        deep = points[amid, 1]
        assert (deep > 25 * MM).sum() > 100
        assert (deep < -25 * MM).sum() > 100
        assert distance(self.BOX, points).max() < 4 * MM

    def test_slices_are_twice_as_far_apart_as_from_straight_above(self) -> None:
        """Hands along the table find a can 12 cm wide that deep, and narrower the nearer they are."""
        can = Tube((0.0, 0.0, 0.04), 0.06, 0.08)
        item = segment(self.CAMERA.sees(TABLE, can), SETTINGS.scene, 0).objects[0]
        assert item.floor is not None
        tilted = Tilted(item, item.floor, SETTINGS.resolve(load_gripper("pr2")))
        found = tilted.places(np.array([0.0, -1.0, 0.0]), load_gripper("pr2"))
        levels = [place.surroundings.level_m or 0.0 for place in found]
        assert len(levels) > 2
        assert np.diff(np.unique(levels)).min() == pytest.approx(2 * SETTINGS.depth.slice_step_m)

    def test_half_of_its_height_is_what_pads_must_hold_at_most(self) -> None:
        place = self.tilted().whole(UP, load_gripper("pr2"))
        assert place is not None
        assert place.surroundings.height_m == pytest.approx(60 * MM, abs=3 * MM)  # type: ignore[attr-defined]

    def test_there_is_no_place_where_a_palm_has_no_room(self) -> None:
        """Between walls 5 cm apart and 15 cm high."""
        walls = tuple(Box((0.0, side * 0.045, 0.075), (0.3, 0.02, 0.15)) for side in (-1, 1))
        bar = Box((0.0, 0.0, 0.01), (0.1, 0.02, 0.02))
        scene = segment(Camera().sees(TABLE, *walls, bar), SETTINGS.scene, 0)
        item = min(scene.objects, key=lambda item: float(np.abs(item.points[:, 1]).max()))
        assert item.floor is not None
        tilted = Tilted(item, item.floor, SETTINGS.resolve(load_gripper("pr2")))
        assert tilted.whole(np.array([0.0, 0.5, np.sqrt(0.75)]), load_gripper("pr2")) is None
