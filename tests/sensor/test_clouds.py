"""Clouds made from arrays, with strays, repeats and any order of points."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flatgrasp_cli import Cloud, load_gripper, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import ImageGrid, Sensor
from flatgrasp_cli.scene import without_far_strays, without_repeats
from tests.conftest import MM, TABLE
from tests.sensor.scenes import BLOCK, SLANTED, moved, rng, seen


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

    def test_it_knows_a_box_around_its_points_and_takes_a_sample_once(self) -> None:
        cloud = Cloud(np.array([[np.nan, 0, 9], [0, 2, 1], [1, 0, 3], [0.5, 1, 2], [1e30, 0, 0]]))
        assert cloud.measured.corners.tolist() == [[0, 0, 1], [1, 2, 3]]
        fewer = cloud.select(np.array([True, True, False]))
        assert (cloud.measured.corners == fewer.measured.corners).all()  # they still lie in that
        assert cloud.sample(2) is replace(cloud, frame_id="base").sample(2)
        assert len(cloud.sample(9)) == 3
        other = replace(cloud, points=cloud.points + 1)
        assert (other.sample(2) == cloud.sample(2) + 1).all()
        assert other.measured.corners[0].tolist() == [1, 1, 2]

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

    @pytest.mark.parametrize(
        ("sensor", "words"),
        [
            ({"known_from": "foo"}, "not 'foo'"),
            ({"known_from": "option", "position": [0, np.nan, 0]}, "the position of a sensor is three finite numbers"),
            ({"known_from": "option", "position": [0, 0]}, "the position of a sensor is three finite numbers"),
            ({"known_from": "up", "direction": [0, 0, np.inf]}, "the direction of a sensor is three finite numbers"),
            ({"known_from": "up", "direction": [0, 0, 0]}, "the direction of a sensor is a unit vector"),
        ],
    )
    def test_a_sensor_that_is_none_is_refused(self, sensor: dict[str, Any], words: str) -> None:
        with pytest.raises(ValueError, match=words):
            Sensor(**sensor)

    def test_the_other_viewpoint_is_checked_too(self) -> None:
        with pytest.raises(ValueError, match="the inverse_viewpoint of a cloud is three finite numbers"):
            Cloud(np.ones((4, 3)), inverse_viewpoint=np.array([0, 0, np.inf]))

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
