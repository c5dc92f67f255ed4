"""Support plane, objects, crop and selection, on scenes seen by a synthetic depth camera; the table's top is z = 0."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, load_settings, plan, read_clouds
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, ObjectCloud, Scene, Sensor, Source, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings
from flatgrasp_cli.scene import segment
from flatgrasp_cli.scene.support_plane import find_support_plane, looks_down
from flatgrasp_cli.sensor import located
from tests.conftest import FLOOR, MM, SAMPLES, TABLE, WALL, Box, Camera, Tube, planned_sample

ABOVE, OBLIQUE = Camera(), Camera(tilt_deg=40)
FAR = Camera(tilt_deg=60, distance=1.5, focal=260.0)
"""A camera that sees the whole table, the floor in front of it, and a wall behind it."""
BLOCK = Box((0.02, 0.01, 0.02), (0.10, 0.04, 0.04), 20)
PEN = Tube((0.0, 0.0, 0.003), 0.003, 0.14, (1.0, 0.5, 0.0))
KINECT_NOISE = 1.7 * MM


def asked(*overrides: str) -> SceneSettings:
    """The default settings of a scene with some replaced."""
    return load_settings("default", tuple(f"scene.{text}" for text in overrides)).scene


def scene_of(cloud: Cloud, *overrides: str, seed: int = 0) -> Scene:
    settings = asked(*overrides)
    return segment(located(cloud, settings.up, seed), settings, seed)


def sensor_at(viewpoint: FloatArray | None) -> Sensor:
    return Sensor("option", viewpoint)


def plane_of(cloud: Cloud, *overrides: str, seed: int = 0) -> SupportPlane:
    plane = find_support_plane(cloud, sensor_at(cloud.viewpoint), asked(*overrides), seed)
    assert plane is not None
    return plane


def degrees_between(one: FloatArray, other: Sequence[float]) -> float:
    return float(np.degrees(np.arccos(np.clip(one @ np.array(other), -1, 1))))


def assert_is_table(plane: SupportPlane | None) -> None:
    """Upright within 0.3°, and z = 0 within a millimetre."""
    assert plane is not None
    assert degrees_between(plane.normal, [0, 0, 1]) < 0.3
    assert abs(plane.offset_m) < 1 * MM


def floor_of(item: ObjectCloud) -> FloatArray:
    assert item.floor is not None
    return item.floor.points


def the_object(scene: Scene) -> ObjectCloud:
    assert scene.reason is None
    assert len(scene.objects) == 1
    return scene.objects[0]


def middles(scene: Scene) -> FloatArray:
    """Where the objects stand (n, 2), from left to right."""
    middle = np.array([0.5 * (item.points.min(axis=0) + item.points.max(axis=0)) for item in scene.objects])[:, :2]
    return np.asarray(middle[np.argsort(middle[:, 0])])


class TestSupportPlane:
    @settings(max_examples=6)
    @given(st.integers(0, 2**31 - 1), st.floats(0, 60), st.sampled_from([0.5 * MM, KINECT_NOISE, 3 * MM]))
    def test_it_is_found_under_noise(self, seed: int, tilt: float, noise: float) -> None:
        cloud = Camera(tilt_deg=tilt).sees(TABLE, BLOCK, noise_m=noise, seed=seed % 1000)
        assert_is_table(plane_of(cloud, seed=seed))

    def test_its_noise_is_that_of_the_sensor(self) -> None:
        plane = plane_of(ABOVE.sees(TABLE, noise_m=KINECT_NOISE))
        assert plane.noise_m == pytest.approx(KINECT_NOISE, rel=0.1)

    def test_the_same_seed_gives_the_same_plane(self) -> None:
        cloud = FAR.sees(TABLE, FLOOR, WALL, noise_m=KINECT_NOISE)
        one, other = (plane_of(cloud, seed=5) for _ in range(2))
        assert (one.normal.tolist(), one.offset_m, one.noise_m) == (
            other.normal.tolist(),
            other.offset_m,
            other.noise_m,
        )

    @pytest.mark.parametrize(
        ("up", "normal", "offset"),
        [("[0,0,1]", [0, 0, 1], 0.0), ("[0,0.2,2]", [0, 0, 1], 0.0), ("[0,-1,0]", [0, -1, 0], -0.39)],
    )
    def test_up_chooses_table_or_wall(self, up: str, normal: list[float], offset: float) -> None:
        """Seen at 30° over a narrow table, the wall behind has most of the points."""
        camera = Camera(tilt_deg=60, distance=1.0, target=(0.0, 0.2, 0.15))
        plane = plane_of(camera.sees(TABLE, WALL), f"up={up}")
        assert degrees_between(plane.normal, normal) < 0.3
        assert plane.offset_m == pytest.approx(offset, abs=1.5 * MM)

    def test_a_wall_bigger_than_the_table_is_not_taken_when_up_is_given(self) -> None:
        cloud = Camera(tilt_deg=75, distance=1.0, target=(0.0, 0.2, 0.15)).sees(TABLE, WALL)
        on_wall, on_table = (np.abs(cloud.points - [0, 0.39, 0]) < 5 * MM)[:, 1], np.abs(cloud.points[:, 2]) < 5 * MM
        assert on_wall.sum() > 1.5 * on_table.sum()
        assert_is_table(plane_of(cloud, "up=[0,0,1]"))

    def test_up_that_nothing_is_normal_to_finds_nothing(self) -> None:
        cloud = ABOVE.sees(TABLE)
        assert find_support_plane(cloud, sensor_at(cloud.viewpoint), asked("up=[1,0,0]"), 0) is None

    def test_the_table_is_preferred_to_the_floor_below_it(self) -> None:
        cloud = Camera(tilt_deg=30, distance=1.3, focal=260.0).sees(TABLE, FLOOR)
        on_floor, on_table = cloud.points[:, 2] < -0.7, np.abs(cloud.points[:, 2]) < 0.02
        assert on_floor.sum() > on_table.sum()
        assert_is_table(plane_of(cloud))
        assert_is_table(plane_of(cloud, "up=[0,0,1]"))

    def test_its_normal_points_to_the_sensor_wherever_the_frame_lies(self) -> None:
        cloud, frame = OBLIQUE.sees(TABLE, BLOCK), OBLIQUE.frame
        plane = plane_of(replace(cloud, points=frame.to_local(cloud.points), viewpoint=np.zeros(3)))
        assert degrees_between(plane.normal @ frame.axes, [0, 0, 1]) < 0.3
        assert plane.offset_m == pytest.approx(-frame.origin[2], abs=1 * MM)

    def test_without_a_sensor_its_normal_points_to_where_the_objects_are(self) -> None:
        cloud = ABOVE.sees(TABLE, BLOCK)
        for viewpoint in (np.zeros(3), np.array([0.0, 0.0, 0.01])):
            plane = plane_of(replace(cloud, viewpoint=viewpoint))
            assert not looks_down(sensor_at(viewpoint), plane.normal, plane.offset_m)
            assert_is_table(plane)

    def test_points_in_a_line_have_none(self) -> None:
        line = np.linspace(0, 1, 1000)[:, None] * np.array([1.0, 2.0, 0.5])
        assert find_support_plane(Cloud(line), sensor_at(np.array([0.0, 0.0, 1.0])), asked(), 0) is None

    def test_a_scattered_cloud_has_none(self) -> None:
        ball = np.random.default_rng(0).normal(0, 0.2, (5000, 3))
        assert find_support_plane(Cloud(ball), sensor_at(np.array([0.0, 0.0, 1.0])), asked(), 0) is None


class TestObjects:
    @pytest.mark.parametrize("camera", [ABOVE, OBLIQUE])
    def test_a_box_is_the_one_object_and_has_all_its_points(self, camera: Camera) -> None:
        cloud = camera.sees(TABLE, BLOCK)
        scene = scene_of(cloud)
        assert_is_table(scene.support)
        found = the_object(scene).points
        truth = cloud.points[cloud.points[:, 2] > 5 * MM]
        assert len(truth) > 900
        missing = {tuple(row) for row in truth} - {tuple(row) for row in found}
        assert len(missing) < 0.01 * len(truth)
        assert len(found) - len(truth) < 0.1 * len(truth)

    def test_a_pen_of_6_mm_is_found_on_a_noisy_table(self) -> None:
        for seed in range(4):
            scene = scene_of(ABOVE.sees(TABLE, PEN, noise_m=KINECT_NOISE, seed=seed))
            length = np.ptp(the_object(scene).points @ np.array([2.0, 1.0, 0.0]) / np.sqrt(5))
            assert length == pytest.approx(0.14, abs=0.02)

    @pytest.mark.parametrize("noise", [0.5 * MM, KINECT_NOISE])
    def test_the_tables_ripple_is_no_object(self, noise: float) -> None:
        """2 mm up and down over 0.2 m is less steep than a sensor's own distortion."""
        cloud = ABOVE.sees(TABLE, noise_m=noise)
        cloud.points[:, 2] += 2 * MM * np.sin(2 * np.pi * cloud.points[:, 0] / 0.2)
        scene = scene_of(cloud, "mode=table")
        assert scene.objects == ()
        assert scene.reason == "nothing stands on the support plane"
        assert_is_table(scene.support)

    def test_a_box_on_a_rippled_table_is_still_found(self) -> None:
        cloud = ABOVE.sees(TABLE, BLOCK, noise_m=KINECT_NOISE)
        cloud.points[:, 2] += 2 * MM * np.sin(2 * np.pi * cloud.points[:, 0] / 0.2)
        assert middles(scene_of(cloud)) == pytest.approx(np.array([[0.02, 0.01]]), abs=6 * MM)

    @pytest.mark.parametrize(("gap_mm", "count"), [(20, 2), (3, 1)])
    def test_objects_20_mm_apart_are_two_and_3_mm_apart_one(self, gap_mm: float, count: int) -> None:
        left, right = (Box((side * (0.02 + 0.5 * gap_mm * MM), 0.0, 0.02), (0.04, 0.08, 0.04)) for side in (-1, 1))
        assert len(scene_of(ABOVE.sees(TABLE, left, right)).objects) == count

    def test_objects_come_largest_first_and_know_the_others_as_obstacles(self) -> None:
        small, large = Box((-0.08, 0.0, 0.02), (0.04, 0.04, 0.04)), Box((0.08, 0.0, 0.02), (0.06, 0.12, 0.04))
        first, second = scene_of(ABOVE.sees(TABLE, small, large)).objects
        assert first.points[:, 0].mean() == pytest.approx(0.08, abs=0.01)
        assert [item.id for item in (first, second)] == [0, 1]
        assert {tuple(row) for row in second.points} <= {tuple(row) for row in first.obstacles}
        near = first.points[first.points[:, 0] < 0.1]
        assert {tuple(row) for row in near} <= {tuple(row) for row in second.obstacles}

    def test_a_wall_behind_the_table_is_no_object_but_an_obstacle(self) -> None:
        block = Box((0.0, 0.25, 0.02), (0.1, 0.04, 0.04))
        scene = scene_of(Camera(tilt_deg=50, distance=1.0, target=(0.0, 0.15, 0.05)).sees(TABLE, block, WALL))
        assert_is_table(scene.support)
        found = the_object(scene)
        assert found.points[:, 1].max() < 0.29
        on_wall = found.obstacles[np.abs(found.obstacles[:, 1] - 0.39) < 0.01]
        assert len(on_wall) > 100

    def test_the_floor_beside_the_table_is_neither_object_nor_obstacle_nor_free(self) -> None:
        scene = scene_of(Camera(tilt_deg=30, distance=1.6, focal=300.0).sees(TABLE, FLOOR, BLOCK))
        found = the_object(scene)
        for points in (found.points, found.obstacles, floor_of(found), scene.clutter):
            assert len(points) == 0 or points[:, 2].min() > -0.02

    @pytest.mark.parametrize(
        "height",
        [
            0.02,
            0.05,
            0.2,
        ],
    )
    def test_flying_pixels_are_neither_objects_nor_obstacles(self, height: float) -> None:
        cloud = ABOVE.sees(TABLE, BLOCK)
        flying = [(-0.1, 0.05, height), (0.02, -0.08, height), (0.15, 0.10, height), (0.02, 0.06, height)]
        scene = scene_of(replace(cloud, points=np.vstack([cloud.points, flying])))
        found = the_object(scene)
        for points in (found.points, found.obstacles, scene.clutter):
            assert not set(flying) & {tuple(row) for row in points.tolist()}

    def test_furniture_is_no_object(self) -> None:
        plank = Box((0.0, 0.05, 0.02), (0.5, 0.06, 0.04))
        cloud = ABOVE.sees(TABLE, plank)
        assert len(scene_of(cloud).objects) == 1
        scene = scene_of(cloud, "max_size_m=0.4", "mode=table")
        assert scene.objects == ()
        assert len(scene.clutter) > 1000

    def test_a_stool_beside_the_table_is_no_object(self) -> None:
        """It is as high as what stands on the table, but the table does not reach it."""
        stool = Box((0.62, 0.0, -0.35), (0.2, 0.2, 0.8))
        scene = scene_of(Camera(tilt_deg=20, distance=1.6, focal=300.0).sees(TABLE, FLOOR, BLOCK, stool))
        assert middles(scene) == pytest.approx(np.array([[0.02, 0.01]]), abs=6 * MM)

    @settings(max_examples=4)
    @given(st.integers(0, 2**31 - 1))
    def test_a_turned_and_moved_cloud_has_the_same_objects(self, seed: int) -> None:
        cloud = OBLIQUE.sees(TABLE, BLOCK, Tube((-0.1, 0.0, 0.05), 0.03, 0.1))
        turn, shift = Rotation.random(random_state=seed), np.random.default_rng(seed).uniform(-1, 1, 3)
        moved = replace(cloud, points=turn.apply(cloud.points) + shift, viewpoint=turn.apply(cloud.viewpoint) + shift)
        before, after = scene_of(cloud), scene_of(moved)
        assert after.support is not None
        assert degrees_between(after.support.normal, turn.apply([0.0, 0.0, 1.0])) < 0.3
        assert len(before.objects) == len(after.objects) == 2
        for one, other in zip(before.objects, after.objects, strict=True):
            assert turn.apply(one.points.mean(axis=0)) + shift == pytest.approx(other.points.mean(axis=0), abs=1 * MM)
            assert len(other.points) == pytest.approx(len(one.points), rel=0.05)

    def test_a_cloud_without_noise_is_segmented_too(self) -> None:
        assert_is_table(scene_of(ABOVE.sees(TABLE, BLOCK, noise_m=0.0)).support)

    def test_a_cloud_in_millimetre_steps_is_segmented_too(self) -> None:
        cloud = ABOVE.sees(TABLE, BLOCK, noise_m=0.5 * MM)
        scene = scene_of(replace(cloud, points=np.round(cloud.points, 3)))
        assert_is_table(scene.support)
        assert middles(scene) == pytest.approx(np.array([[0.02, 0.01]]), abs=4 * MM)


class TestOneObjectAlone:
    def test_a_box_from_above_is_no_table(self) -> None:
        scene = scene_of(ABOVE.sees(BLOCK))
        assert scene.support is None
        assert len(the_object(scene).points) == len(ABOVE.sees(BLOCK).points)

    def test_a_box_seen_obliquely_is_no_table(self) -> None:
        assert scene_of(OBLIQUE.sees(Box((0.0, 0.0, 0.04), (0.2, 0.12, 0.08), 30))).support is None

    def test_a_pans_floor_is_no_table(self) -> None:
        """The rim stands on the floor, as objects do; but nothing of the floor lies around it."""
        pan = Tube((0.0, 0.0, 0.02), 0.12, 0.04, bore=0.115, floor=0.003)
        scene = scene_of(ABOVE.sees(pan))
        assert scene.support is None
        assert len(the_object(scene).points) == len(ABOVE.sees(pan).points)

    def test_a_pan_on_a_table_is_an_object(self) -> None:
        pan = Tube((0.0, 0.0, 0.02), 0.10, 0.04, bore=0.095, floor=0.003)
        assert_is_table(scene_of(ABOVE.sees(TABLE, pan)).support)

    def test_mode_object_looks_for_no_plane(self) -> None:
        cloud = ABOVE.sees(TABLE, BLOCK)
        scene = scene_of(cloud, "mode=object")
        assert scene.support is None
        assert len(the_object(scene).points) == len(cloud.points)

    def test_mode_table_never_plans_the_table_itself(self) -> None:
        scene = scene_of(ABOVE.sees(TABLE), "mode=table")
        assert_is_table(scene.support)
        assert (scene.objects, scene.reason) == ((), "nothing stands on the support plane")

    def test_mode_table_says_that_there_is_no_plane(self) -> None:
        ball = np.random.default_rng(0).normal(0, 0.2, (5000, 3))
        scene = scene_of(replace(ABOVE.sees(BLOCK), points=ball), "mode=table")
        assert (scene.support, scene.objects, scene.reason) == (None, (), "no support plane was found")


class TestWanted:
    LEFT, RIGHT = Box((-0.12, -0.05, 0.02), (0.05, 0.05, 0.04)), Box((0.10, 0.06, 0.03), (0.08, 0.12, 0.06))

    def test_crop_forgets_what_lies_outside(self) -> None:
        cloud = ABOVE.sees(TABLE, self.LEFT, self.RIGHT)
        scene = scene_of(cloud, "crop=[-0.25,0,-0.2,0.2,-0.1,0.5]")
        assert middles(scene) == pytest.approx(np.array([[-0.12, -0.05]]), abs=4 * MM)
        assert the_object(scene).obstacles.shape == (0, 3)
        assert floor_of(the_object(scene))[:, 0].max() <= 1 * MM  # the middle of a cell

    def test_crop_keeps_its_own_borders(self) -> None:
        points = np.array([[0.0, 0, 0.5], [1.0, 1, 1], [1.0, 1, 1.01], [-0.01, 0, 0.5]])
        scene = scene_of(replace(ABOVE.sees(BLOCK), points=points), "crop=[0,1,0,1,0,1]", "mode=object")
        assert the_object(scene).points.tolist() == points[:2].tolist()

    def test_crop_to_nothing_leaves_an_empty_object(self) -> None:
        scene = scene_of(ABOVE.sees(TABLE, BLOCK), "crop=[5,6,5,6,5,6]")
        assert [len(item.points) for item in scene.objects] in ([], [0])

    @pytest.mark.parametrize(
        ("select", "where"),
        [
            ("largest", [0.10, 0.06]),
            ("nearest", [0.10, 0.06]),
            ("[-0.2,0.0]", [-0.12, -0.05]),
            ("[0.1,0.1]", [0.10, 0.06]),
        ],
    )
    def test_one_object_is_selected_and_the_other_stays_an_obstacle(self, select: str, where: list[float]) -> None:
        """From straight above, the higher box is nearer to the sensor."""
        scene = scene_of(ABOVE.sees(TABLE, self.LEFT, self.RIGHT), f"select={select}")
        assert middles(scene) == pytest.approx(np.array([where]), abs=5 * MM)
        assert len(the_object(scene).obstacles) > 100

    @pytest.mark.parametrize(("away_m", "means_it"), [(0.06, True), (0.08, False), (3.0, False), (200.0, False)])
    def test_a_place_farther_away_than_the_object_is_long_means_none(self, away_m: float, means_it: bool) -> None:
        """The left box is 5 cm by 5 cm: 7 cm from corner to corner."""
        place = -0.145 - away_m
        scene = scene_of(ABOVE.sees(TABLE, self.LEFT, self.RIGHT), f"select=[{place},-0.05]")
        assert len(scene.objects) == means_it
        if not means_it:
            assert scene.reason is not None
            assert f"no object lies at {place:g}, -0.05: the nearest, object " in scene.reason
            stated = re.search(r"around (\S+), (\S+), is (\S+) m away and (\S+) m long", scene.reason)
            assert stated is not None
            numbers = [float(number) for number in stated.groups()]
            assert numbers == pytest.approx([-0.12, -0.05, away_m, 0.07], abs=4 * MM)
            assert len(scene.clutter) > 500  # both boxes are still there to be seen in a picture

    def test_a_place_far_from_the_only_object_means_none(self) -> None:
        for place, count in (("[0.0,0.0]", 1), ("[1.0,0.0]", 0)):
            scene = scene_of(ABOVE.sees(BLOCK), "mode=object", f"select={place}")
            assert (len(scene.objects), scene.reason is None) == (count, count == 1)

    def test_nearest_goes_by_the_sensor_and_not_by_size(self) -> None:
        beside = Camera(target=(-0.15, 0.0, 0.0), distance=0.7)
        scene = scene_of(beside.sees(TABLE, self.LEFT, Box((0.05, 0.06, 0.02), (0.08, 0.12, 0.04))), "select=nearest")
        assert middles(scene) == pytest.approx(np.array([[-0.12, -0.05]]), abs=4 * MM)

    def test_all_keeps_all(self) -> None:
        assert len(scene_of(ABOVE.sees(TABLE, self.LEFT, self.RIGHT)).objects) == 2


@pytest.mark.parametrize("mode", ["auto", "object", "table"])
def test_what_is_no_view_of_objects_is_refused(mode: str) -> None:
    lidar = np.random.default_rng(0).uniform(-1, 1, (5000, 3)) * [100.0, 90.0, 8.0]
    scene = scene_of(replace(ABOVE.sees(BLOCK), points=lidar), f"mode={mode}")
    assert (scene.support, scene.objects) == (None, ())
    assert scene.reason is not None
    assert scene.reason.startswith("the cloud is 19")


@pytest.mark.parametrize(("wide_m", "refused"), [(17, False), (25, True)])
def test_no_view_of_objects_is_wider_than_20_m(wide_m: float, refused: bool) -> None:
    room = np.random.default_rng(0).uniform(-0.5, 0.5, (5000, 3)) * [wide_m, 3.0, 3.0]
    reason = scene_of(replace(ABOVE.sees(BLOCK), points=room), "mode=table").reason
    assert (reason is not None and reason.startswith("the cloud is")) == refused


def test_a_stray_point_far_away_does_not_make_a_scene_too_large() -> None:
    view = ABOVE.sees(TABLE, BLOCK)
    far = np.vstack([view.points, [[0.0, 0.0, 300.0]]])
    assert len(scene_of(replace(view, points=far)).objects) == 1


@pytest.mark.parametrize("name", ["pan", "hammer", "spray_bottle", "teddy_bear"])
@pytest.mark.parametrize("stray", [(0.0, 0.0, 0.0), (0.0, 0.0, 2.0), (1e5, 0.0, 3.0)])
def test_one_stray_point_changes_nothing(name: str, stray: tuple[float, float, float]) -> None:
    (cloud,) = read_clouds(SAMPLES / f"{name}.pcd")
    clean = planned_sample(name).best
    strayed = plan(replace(cloud, points=np.vstack([cloud.points, stray])), load_gripper("pr2")).best
    assert clean is not None
    assert strayed is not None
    np.testing.assert_allclose(strayed.position, clean.position, atol=1e-9)


def test_a_pile_of_identical_points_is_no_table() -> None:
    """Most points lie in a plane through the pile, but no cell of the raster does on average: one object, no table."""
    ball = np.random.default_rng(2).normal(size=(1000, 3))
    ball *= 0.05 / np.linalg.norm(ball, axis=1)[:, None]
    cloud = Cloud(np.vstack([ball, np.repeat(ball[:1], 150, axis=0)]), np.zeros(3), Source("pile"))
    scene = segment(cloud, load_settings().scene, seed=0)
    assert scene.support is None
    assert len(scene.objects) == 1
