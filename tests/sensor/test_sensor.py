"""Where a cloud was seen from: found, stated, and held against the cloud."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli import Cloud, load_gripper, plan
from flatgrasp_cli.cli.place_options import parse_sensor
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.model import Sensor
from flatgrasp_cli.sensor import located
from flatgrasp_cli.sensor.frame_names import has_z_up, is_optical
from tests.conftest import MM, TABLE, Box, Camera, Solid, Tube
from tests.sensor.scenes import BLOCK, CAN, LYING, NOWHERE, SLANTED, approach, codes, image, moved, seen, sensor_of


class TestFound:
    """Clouds of which nothing is said, as most segmented ones are."""

    def test_a_cloud_in_the_cameras_frame_was_seen_from_the_origin(self) -> None:
        for things in ((TABLE, BLOCK, CAN), (BLOCK,), (CAN,), (LYING,)):
            cloud = seen(SLANTED, *things)
            cloud = replace(cloud, points=SLANTED.frame.to_local(cloud.points))
            assert sensor_of(cloud).position == pytest.approx(NOWHERE)
            assert codes(cloud) == []

    @pytest.mark.parametrize("height", [-0.75, -0.4, -0.2, 0.2, 0.4, 0.75])
    @pytest.mark.parametrize("tilt", [0, 30])
    def test_a_table_at_any_height_of_a_robots_frame(self, height: float, tilt: int) -> None:
        cloud = seen(Camera(tilt_deg=tilt), TABLE, BLOCK, CAN)
        assert approach(moved(cloud, 0.5, 0.0, height))[2] < -0.99

    @pytest.mark.parametrize("thing", [BLOCK, CAN, LYING])
    def test_a_thing_above_a_robots_base_is_not_taken_from_below(self, thing: Solid) -> None:
        cloud = moved(seen(SLANTED, thing), 0.45, 0.1, 0.4)
        assert sensor_of(cloud).known_from == "visibility"
        assert codes(cloud) == ["sensor_found"]
        assert approach(cloud)[2] < -0.3

    def test_without_a_clear_case_the_frames_name_says_which_way_is_up(self) -> None:
        plate = moved(seen(Camera(), Box((0, 0, 0), (0.12, 0.05, 0.001))), 0.1, 0.1, 0.6)
        assert codes(plate) == ["sensor_assumed"]
        assert approach(plate)[2] > 0.9  # from the origin, which is below
        named = replace(plate, frame_id="base_link")
        assert sensor_of(named).known_from == "up"
        assert codes(named) == ["sensor_unknown"]
        assert approach(named)[2] < -0.9

    def test_or_the_option_does(self) -> None:
        plate = moved(seen(Camera(), Box((0, 0, 0), (0.12, 0.05, 0.001))), 0.1, 0.1, 0.6)
        for up, side in (("[0,0,1]", -1), ("[0,0,-1]", 1)):
            assert np.sign(approach(plate, up=up)[2]) == side
        assert codes(plate, (0.0, 0.0, 1.0)) == ["sensor_unknown"]

    def test_up_decides_the_side_of_a_lone_object_whatever_the_sensor(self) -> None:
        cloud = SLANTED.sees(Box((0, 0, 0), (0.12, 0.05, 0.01)))
        assert approach(cloud)[2] < -0.9
        assert approach(cloud, up="[0,0,-1]")[2] > 0.9


class TestStated:
    def test_a_viewpoint_is_believed_if_the_cloud_can_have_been_seen_from_there(self) -> None:
        for things in ((TABLE, BLOCK), (BLOCK,), (CAN,), (Box((0, 0, 0), (0.1, 0.05, 0.001)),)):
            cloud = SLANTED.sees(*things)
            assert sensor_of(cloud).known_from == "viewpoint"
            assert codes(cloud) == []

    def test_a_pose_that_is_meant_the_other_way_round(self) -> None:
        """Of the points' frame in another one, as pcl_ros and CloudCompare write it."""
        cloud = seen(SLANTED, TABLE, BLOCK)
        frame = SLANTED.frame
        stated = frame.to_local(np.zeros(3))  # the world's origin in the camera's frame: under the table
        cloud = replace(cloud, viewpoint=stated - [0, 0, 1.5], inverse_viewpoint=frame.origin)
        assert sensor_of(cloud).position == pytest.approx(frame.origin)
        assert codes(cloud) == ["viewpoint_not_believed"]

    def test_a_camera_at_the_origin_whose_pose_in_another_frame_is_stated(self) -> None:
        cloud = seen(SLANTED, BLOCK)
        cloud = replace(cloud, points=SLANTED.frame.to_local(cloud.points), viewpoint=np.array([0.1, 0.0, 1.4]))
        assert sensor_of(cloud).position == pytest.approx(NOWHERE)
        assert codes(cloud) == ["viewpoint_not_believed"]

    def test_a_bowl_seen_from_where_it_is_stated_stays_one(self) -> None:
        inside = Tube((0, 0, 0.03), 0.07, 0.06, bore=0.065, floor=0.005)
        cloud = Camera(tilt_deg=25, distance=0.5).sees(inside)
        cloud = cloud.select(np.hypot(cloud.points[:, 0], cloud.points[:, 1]) < 0.0655)
        assert sensor_of(cloud).known_from == "viewpoint"

    def test_points_at_the_sensors_own_place_are_dropped(self) -> None:
        cloud = SLANTED.sees(TABLE, BLOCK)
        dirty = replace(cloud, points=np.vstack([cloud.points, np.repeat(SLANTED.frame.origin[None], 500, axis=0)]))
        found = located(dirty, None, 0)
        assert (len(found.points), found.dropped) == (len(cloud.points), 500)

    @pytest.mark.parametrize("side", [1.0, -1.0])
    def test_above_is_up_and_up_is_z_unless_it_is_said(self, side: float) -> None:
        cloud = replace(SLANTED.sees(BLOCK), sensor=Sensor("option"))
        assert sensor_of(cloud).direction == pytest.approx([0, 0, 1])
        assert sensor_of(cloud, (0.0, 0.0, 2 * side)).direction == pytest.approx([0, 0, side])

    def test_what_was_seen_from_all_sides_casts_no_shadow(self) -> None:
        """Behind a box a low camera sees nothing; what lies close behind it can be gripped only if that was seen."""
        low = Camera(tilt_deg=60)
        cloud = low.sees(TABLE, Box((0, 0, 0.04), (0.05, 0.05, 0.08)))
        one, merged = (
            plan(each, load_gripper("pr2")).best for each in (cloud, replace(cloud, sensor=Sensor("all_sides")))
        )
        assert one is not None
        assert merged is not None
        assert merged.unseen_m == pytest.approx(0.0, abs=1 * MM)
        assert one.unseen_m is not None

    @pytest.mark.parametrize(
        ("text", "position"), [("1,2,-3.5", [1, 2, -3.5]), ("above", None), ("none", None), (" 0,0,1e-1", [0, 0, 0.1])]
    )
    def test_places_in_words(self, text: str, position: list[float] | None) -> None:
        sensor = parse_sensor(text)
        assert isinstance(sensor, Sensor)
        assert (sensor.position is None) if position is None else sensor.position == pytest.approx(position)

    def test_a_frame_in_words(self) -> None:
        assert parse_sensor("/camera_optical_frame") == "camera_optical_frame"

    @pytest.mark.parametrize("text", ["", "1,2", "1,2,x", "1,2,nan", "1 2 3", "0.5"])
    def test_no_place_in_words(self, text: str) -> None:
        with pytest.raises(UsageError, match="--sensor"):
            parse_sensor(text)


def test_names_of_frames() -> None:
    for name in ("base_link", "base", "world", "map", "odom", "robot1/base_link", "base_footprint", "table"):
        assert has_z_up(name)
        assert not is_optical(name)
    for name in ("camera_depth_optical_frame", "head_rgbd_optical"):
        assert is_optical(name)
        assert not has_z_up(name)
    assert not has_z_up("camera_link")


class TestHeldAgainstTheCloud:
    def test_a_viewpoint_of_a_file_whose_cloud_a_camera_at_the_origin_sees_as_well(self) -> None:
        cloud = seen(SLANTED, TABLE, BLOCK, CAN)
        aside = np.array([0.3, -0.2, 0.1])  # of a camera at the origin, and on its side of the table
        local = replace(cloud, points=SLANTED.frame.to_local(cloud.points), viewpoint=aside)
        assert sensor_of(local).known_from == "viewpoint"  # nobody else's pose could be meant
        pose = replace(local, inverse_viewpoint=np.array([5.0, 5.0, 5.0]))
        assert sensor_of(pose).position == pytest.approx(NOWHERE)
        assert codes(pose) == ["viewpoint_not_believed"]

    def test_a_sensor_by_the_transforms_that_cannot_be(self) -> None:
        cloud = seen(SLANTED, TABLE, BLOCK, sensor=Sensor("transforms", np.array([0.0, 0.0, -1.0])))
        assert sensor_of(cloud).known_from == "visibility"
        likely = replace(cloud, sensor=Sensor("transforms", SLANTED.frame.origin))
        assert sensor_of(likely).known_from == "transforms"

    def test_a_lens_does_not_move_a_depth_images_sensor(self) -> None:
        points = image(SLANTED, TABLE, BLOCK)
        cloud = Cloud(points, sensor=Sensor("frame", SLANTED.frame.origin + np.array([0.0, 0.03, 0.05])))
        assert sensor_of(cloud).known_from == "frame"

    @pytest.mark.parametrize("far", [1e30, 1e300])
    def test_a_viewpoint_out_of_this_world_says_nothing(self, far: float) -> None:
        cloud = replace(SLANTED.sees(TABLE, BLOCK), viewpoint=np.array([far, 0.0, 0.0]))
        assert sensor_of(cloud).known_from == "visibility"
