"""Where the sensor was: told by an organised cloud, held against the cloud's shape, named by frames, or assumed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flatgrasp_cli import Cloud, load_gripper, plan
from flatgrasp_cli.cli.place_options import parse_sensor
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import ImageGrid, Sensor
from flatgrasp_cli.scene import without_far_strays, without_repeats
from flatgrasp_cli.sensor import located
from flatgrasp_cli.sensor.frame_names import has_z_up, is_optical
from flatgrasp_cli.sensor.projection import center_of_projection
from flatgrasp_cli.sensor.surface import Surface
from tests.conftest import MM, TABLE, Box, Camera, Solid, Tube

BLOCK = Box((0.02, 0.01, 0.02), (0.10, 0.04, 0.04), 20)
CAN = Tube((0.1, -0.05, 0.05), 0.033, 0.1)
LYING = Tube((0.0, 0.0, 0.02), 0.02, 0.12, (1.0, 0.3, 0.0))
SLANTED = Camera(tilt_deg=35)
NOWHERE = np.zeros(3)


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def image(camera: Camera, *solids: Solid, noise_m: float = 0.5 * MM) -> FloatArray:
    """An organised cloud (rows, columns, 3) in the world's frame; NaN where a ray meets nothing."""
    columns, rows = camera.pixels
    u, v = np.meshgrid(np.arange(columns) - 0.5 * (columns - 1), np.arange(rows) - 0.5 * (rows - 1))
    rays = np.column_stack([u.ravel(), v.ravel(), np.full(u.size, camera.focal)]) / camera.focal @ camera.frame.axes
    depth = np.min([solid.hit(camera.frame.origin, rays) for solid in solids], axis=0)
    depth[~np.isfinite(depth)] = np.nan
    depth += rng().normal(0, noise_m, len(depth))
    points: FloatArray = camera.frame.origin + depth[:, None] * rays
    return np.asarray(points.reshape(rows, columns, 3))


def moved(cloud: Cloud, *shift: float) -> Cloud:
    return replace(cloud, points=cloud.points + np.array(shift))


def seen(camera: Camera, *solids: Solid, **changes: Any) -> Cloud:
    """What a camera sees, in the world's frame, with nothing said of the camera unless `changes` do."""
    return replace(camera.sees(*solids), **{"viewpoint": None, **changes})


def sensor_of(cloud: Cloud, up: tuple[float, float, float] | None = None) -> Sensor:
    sensor = located(cloud, up, 0).sensor
    assert sensor is not None
    return sensor


def codes(cloud: Cloud, up: tuple[float, float, float] | None = None) -> list[str]:
    return [warning.code for warning in located(cloud, up, 0).warnings]


def approach(cloud: Cloud, *, up: str | None = None) -> FloatArray:
    """The way the hand comes to the best grasp."""
    from flatgrasp_cli import load_settings

    best = plan(cloud, load_gripper("pr2"), load_settings("default", (f"scene.up={up}",) if up else ())).best
    assert best is not None
    axes: FloatArray = axes_from_quaternion(best.orientation)
    return np.asarray(axes[2])


class TestProjection:
    @settings(max_examples=25)
    @given(st.integers(0, 2**32 - 1), st.floats(0, 60), st.floats(0, 5 * MM))
    def test_an_organised_cloud_tells_its_centre_wherever_it_was_moved(
        self, seed: int, tilt: float, noise: float
    ) -> None:
        camera = Camera(tilt_deg=tilt)
        turn, shift = Rotation.random(random_state=seed), np.random.default_rng(seed).uniform(-3, 3, 3)
        points = image(camera, TABLE, BLOCK, CAN, noise_m=noise)
        cloud = Cloud(turn.apply(points.reshape(-1, 3)).reshape(points.shape) + shift)
        sensor = sensor_of(cloud)
        assert sensor.known_from == "projection"
        assert sensor.position == pytest.approx(turn.apply(camera.frame.origin) + shift, abs=1e-6)

    @pytest.mark.parametrize("way", ["shuffled", "rows merged from two views", "parallel rays"])
    def test_what_no_one_camera_saw_is_not_believed(self, way: str) -> None:
        points = image(SLANTED, TABLE, BLOCK)
        height, width, _ = points.shape
        if way == "shuffled":
            points = rng().permutation(points.reshape(-1, 3)).reshape(points.shape)
        elif way == "parallel rays":
            x, y = np.meshgrid(np.linspace(0, 1, width), np.linspace(0, 1, height))
            points = np.dstack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)])
        else:
            points[height // 2 :] = image(Camera(tilt_deg=-40), TABLE, BLOCK)[height // 2 :]
        cloud = Cloud(points)
        assert cloud.pixels is not None
        assert center_of_projection(cloud.points, cloud.pixels, rng()) is None

    def test_a_perfect_plane_alone_tells_the_right_centre_or_none(self) -> None:
        for tilt in (0, 20, 50):
            cloud = Cloud(image(Camera(tilt_deg=tilt), TABLE, noise_m=0.0))
            assert cloud.pixels is not None
            center = center_of_projection(cloud.points, cloud.pixels, rng())
            assert center is None or center == pytest.approx(Camera(tilt_deg=tilt).frame.origin, abs=20 * MM)

    def test_few_points_tell_nothing(self) -> None:
        points = image(SLANTED, TABLE)
        points[3:] = np.nan
        points[:, 10:] = np.nan
        cloud = Cloud(points)
        assert cloud.pixels is not None
        assert center_of_projection(cloud.points, cloud.pixels, rng()) is None

    def test_it_counts_more_than_a_stated_viewpoint(self) -> None:
        cloud = Cloud(image(SLANTED, TABLE, BLOCK), viewpoint=np.array([0.5, 0.5, 1.5]))
        assert sensor_of(cloud).position == pytest.approx(SLANTED.frame.origin, abs=1e-6)
        assert codes(cloud) == ["viewpoint_not_believed"]


class TestSurface:
    @pytest.mark.parametrize("thing", [BLOCK, CAN, LYING, Tube((0, 0, 0.05), 0.05, 0.1, (0.2, 0.1, 1.0))])
    @pytest.mark.parametrize("tilt", [20, 45])
    def test_a_thing_alone_bulges_toward_its_sensor(self, thing: Solid, tilt: int) -> None:
        camera = Camera(tilt_deg=tilt)
        cloud = camera.sees(thing)
        surface, middle = Surface.of(cloud.points, rng()), cloud.points.mean(axis=0)
        assert surface.seen_from(camera.frame.origin) == "seen"
        assert surface.seen_from(2 * middle - camera.frame.origin) in ("hollow", "impossible")

    def test_a_face_and_a_side_are_not_seen_from_a_corner_behind_both(self) -> None:
        """The near side would hide the top from below: no smooth surface has such normals."""
        points = Camera(tilt_deg=45).sees(Box((0.0, 0.0, 0.05), (0.12, 0.1, 0.1))).points
        assert Surface.of(points, rng()).seen_from(np.array([0.0, -0.5, -0.4])) == "impossible"

    def test_a_flat_sheet_may_have_been_seen_from_either_side(self) -> None:
        surface = Surface.of(Camera().sees(Box((0, 0, 0), (0.12, 0.05, 0.001))).points, rng())
        assert {surface.seen_from(np.array([0.0, 0.0, z])) for z in (0.8, -0.8)} == {"flat"}

    def test_the_inside_of_a_bowl_is_hollow(self) -> None:
        inside = Tube((0, 0, 0.03), 0.07, 0.06, bore=0.065, floor=0.005)
        camera = Camera(tilt_deg=25, distance=0.5)
        points = camera.sees(inside).points
        points = points[np.hypot(points[:, 0], points[:, 1]) < 0.0655]
        assert Surface.of(points, rng()).seen_from(camera.frame.origin) == "hollow"

    @pytest.mark.parametrize("tilt", [0, 30, 60])
    def test_what_stands_on_a_plane_stands_on_the_sensors_side(self, tilt: int) -> None:
        surface = Surface.of(Camera(tilt_deg=tilt).sees(TABLE, BLOCK, CAN).points, rng())
        assert surface.standing is not None
        assert surface.standing[0][2] > 0.999
        assert surface.seen_from(np.array([0.0, -0.4, 0.7])) == "seen"
        assert surface.seen_from(np.array([0.0, -0.4, -0.7])) == "impossible"
        assert surface.seen_from(np.array([0.0, -0.4, 0.05])) == "impossible"  # in the table's own plane

    def test_a_part_of_a_thing_does_not_stand_on_the_rest_of_it(self) -> None:
        hammer = (Box((0, 0, 0.01), (0.26, 0.03, 0.02)), Box((0.12, 0, 0.015), (0.03, 0.12, 0.03)))
        for thing in (hammer, (LYING,), (CAN,)):
            assert Surface.of(SLANTED.sees(*thing).points, rng()).standing is None

    def test_points_that_fill_a_space_have_no_surface(self) -> None:
        surface = Surface.of(rng().uniform(-0.05, 0.05, (5000, 3)), rng())
        assert len(surface.normals) == 0


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
        assert merged.unseen_m == 0.0
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


class TestCloud:
    """A cloud made from an array alone."""

    def test_what_was_not_measured_is_no_point(self) -> None:
        bad = [[np.nan, 0, 1], [0, 0, 0], [0, -0.0, 0], [1, np.inf, 1], [1e30, 0, 0], [0, 2e4, 0]]
        good = [[0, 0, 1], [0, 1e-30, 0], [1, 2, 3]]
        cloud = Cloud(np.array(bad + good, dtype=np.float32), colors=np.arange(27, dtype=np.uint8).reshape(9, 3))
        assert cloud.points.tolist() == np.array(good, dtype=np.float32).tolist()
        assert cloud.dropped == len(bad)
        assert cloud.colors is not None
        assert cloud.colors[0].tolist() == [18, 19, 20]

    def test_an_image_of_points_is_organised(self) -> None:
        points = np.full((3, 4, 3), np.nan)
        points[1, 2], points[2, 0] = [1, 2, 3], [4, 5, 6]
        cloud = Cloud(points)
        assert cloud.pixels is not None
        assert cloud.pixels.shape == (3, 4)
        assert np.flatnonzero(cloud.pixels.filled).tolist() == [6, 8]
        assert cloud.select(np.array([False, True])).pixels is not None

    @pytest.mark.parametrize("points", [np.zeros(3), np.zeros((4, 2)), np.zeros((2, 2, 2, 3))])
    def test_other_shapes_are_refused(self, points: FloatArray) -> None:
        with pytest.raises(ValueError, match="points"):
            Cloud(points)

    def test_masked_points_were_not_measured(self) -> None:
        image = np.ma.masked_greater(np.arange(1.0, 37.0).reshape(3, 4, 3), 30.0)
        cloud = Cloud(image)
        assert (len(cloud.points), cloud.dropped) == (10, 2)
        assert cloud.points.max() == 30.0
        assert cloud.pixels is not None

    @pytest.mark.parametrize("viewpoint", [[0, 0], [0, 0, np.nan]])
    def test_a_viewpoint_that_is_none_is_refused(self, viewpoint: list[float]) -> None:
        with pytest.raises(ValueError, match="viewpoint"):
            Cloud(np.ones((5, 3)), viewpoint=np.array(viewpoint))

    def test_plan_takes_one(self) -> None:
        cloud = SLANTED.sees(TABLE, BLOCK)
        bare = plan(Cloud(SLANTED.frame.to_local(cloud.points)), load_gripper("pr2"))
        assert bare.best is not None
        assert bare.best.width_m == pytest.approx(0.04, abs=3 * MM)

    def test_its_sensor_moves_with_it(self) -> None:
        frame = Frame(np.array([1.0, 2.0, 3.0]), Rotation.from_euler("x", 90, degrees=True).as_matrix().T)
        cloud = Cloud(np.ones((5, 3)), sensor=Sensor("option", np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])))
        moved = cloud.in_frame(frame, "base")
        assert moved.sensor is not None
        assert moved.sensor.position == pytest.approx([1, 2, 4])
        assert moved.sensor.direction == pytest.approx([0, -1, 0])

    def test_a_grid_of_pixels_follows_what_is_selected(self) -> None:
        grid = ImageGrid((2, 2), np.array([True, False, True, True]))
        assert grid.select(np.array([True, False, True])).filled.tolist() == [True, False, False, True]


class TestStrays:
    @pytest.mark.parametrize("far", [1e3, 1e5, 2e8, 1e9])
    def test_a_far_point_is_left_out_and_counted(self, far: float) -> None:
        cloud = SLANTED.sees(TABLE, BLOCK)
        one = plan(cloud, load_gripper("pr2"))
        assert one.best is not None
        for place in ([far, 0, 0], [0, -far, far], [3.0, 0, -4.0]):
            other = plan(replace(cloud, points=np.vstack([cloud.points, place])), load_gripper("pr2"))
            assert other.cloud.dropped == 1
            assert other.best is not None
            assert other.best.position == pytest.approx(one.best.position, abs=1 * MM)

    @pytest.mark.parametrize("place", [(0.02, 0.01, 0.16), (0.05, 0.02, 0.1), (0.0, 0.1, 0.09)])
    def test_a_point_that_flies_over_an_object_changes_nothing(self, place: tuple[float, float, float]) -> None:
        cloud = SLANTED.sees(TABLE, BLOCK)
        dirty = replace(cloud, points=np.vstack([cloud.points, place]))
        one, other = (plan(each, load_gripper("pr2")).best for each in (cloud, dirty))
        assert one is not None
        assert other is not None
        assert other.position == pytest.approx(one.position, abs=1 * MM)

    def test_a_wall_behind_the_table_stays(self) -> None:
        cloud = SLANTED.sees(TABLE, BLOCK)
        wall = np.column_stack([rng().uniform(-2, 2, 3000), np.full(3000, 3.0), rng().uniform(-1, 2, 3000)])
        both = replace(cloud, points=np.vstack([cloud.points, wall]))
        assert without_far_strays(both).dropped == 0


@pytest.mark.parametrize("shape", [(400, 200), (500, 400), (320, 250)])
def test_objects_do_not_vanish_with_the_order_of_the_points(shape: tuple[int, int]) -> None:
    """Every n-th point of an image takes a few of its columns only if n divides the rows' length."""
    columns, rows = shape
    x, y = np.meshgrid(np.arange(columns) / columns - 0.5, (np.arange(rows) / rows - 0.5) * 0.6)
    z = np.zeros(x.shape)
    for cx, cy in ((-0.3, 0.0), (0.0, 0.1), (0.3, -0.1), (0.44, 0.2)):
        z[(np.abs(x - cx) < 0.03) & (np.abs(y - cy) < 0.03)] = 0.05
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel() + rng().normal(0, 0.4 * MM, x.size)])
    for order in (np.arange(len(points)), rng().permutation(len(points))):
        cloud = Cloud(points[order], viewpoint=np.array([0.0, 0.0, 1.2]))
        assert len(plan(cloud, load_gripper("franka_hand")).objects) == 4


class TestRepeats:
    """What lies in one place again and again was not measured."""

    @pytest.mark.parametrize("place", [(0.0, 0.0, 0.3), (0.02, 0.01, 0.04), (0.3, 0.2, 0.5)])
    def test_many_equal_points_change_nothing(self, place: tuple[float, float, float]) -> None:
        cloud = SLANTED.sees(TABLE, BLOCK)
        dirty = replace(cloud, points=np.vstack([np.tile(place, (600, 1)), cloud.points]))
        one, other = plan(cloud, load_gripper("pr2")), plan(dirty, load_gripper("pr2"))
        assert other.cloud.dropped >= 599
        assert one.best is not None
        assert other.best is not None
        assert other.best.position == pytest.approx(one.best.position, abs=1 * MM)

    def test_invalid_points_that_a_transform_moved(self) -> None:
        """Zeros of a driver, moved into a robot's frame, lie where the sensor is; here nobody says where that is."""
        cloud = moved(seen(SLANTED, BLOCK), 0.45, 0.1, 0.4)
        sensor = SLANTED.frame.origin + np.array([0.45, 0.1, 0.4])
        dirty = replace(cloud, points=np.vstack([cloud.points, np.tile(sensor, (len(cloud.points) // 6, 1))]))
        one, other = (plan(each, load_gripper("pr2")).best for each in (cloud, dirty))
        assert one is not None
        assert other is not None
        assert other.position == pytest.approx(one.position, abs=1 * MM)

    def test_a_grid_of_rounded_coordinates_stays(self) -> None:
        x, y = np.meshgrid(np.arange(60) * MM, np.arange(80) * MM)
        cloud = Cloud(np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.5)]))
        assert without_repeats(cloud).dropped == 0


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
