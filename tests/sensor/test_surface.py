"""The projection and the surface that tell where a cloud was seen from."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flatgrasp_cli import Cloud
from flatgrasp_cli.sensor.projection import center_of_projection
from flatgrasp_cli.sensor.surface import Surface
from tests.conftest import MM, TABLE, Box, Camera, Solid, Tube
from tests.sensor.scenes import BLOCK, CAN, LYING, SLANTED, codes, image, rng, sensor_of


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
