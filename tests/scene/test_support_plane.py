"""Which plane objects stand on, on scattered planes a little inside and outside of each of the limits."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_settings
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, Scene, Sensor, Source, SupportPlane
from flatgrasp_cli.scene import segment
from flatgrasp_cli.scene.segmentation import _goes_on_below
from flatgrasp_cli.scene.support_plane import _tolerance, find_support_plane, looks_down
from flatgrasp_cli.sensor import located
from tests.by_hand import MM, bar, on_table

ABOVE = Sensor("option", np.array([0.0, 0.0, 1.0]))
UP = np.array([0.0, 0.0, 1.0])


def plane(
    share: float, height_m: float = 0.0, tilt_deg: float = 0.0, noise_m: float = 0.5 * MM, seed: int = 0
) -> FloatArray:
    """Points of a plane through (0, 0, height) that is tilted about y; so many of 10,000, on a square of 60 cm."""
    rng = np.random.default_rng(seed)
    n, slope = round(10_000 * share), np.tan(np.radians(tilt_deg))
    x, y = rng.uniform(-0.3, 0.3, (2, n))
    return np.column_stack([x, y, height_m + slope * x + rng.normal(0, noise_m, n)])


def scattered(share: float) -> FloatArray:
    box = np.random.default_rng(9).uniform(-0.3, 0.3, (round(10_000 * share), 3))
    return np.asarray(box + np.array([0.0, 0.0, 0.1]))


def support(*parts: FloatArray, sensor: Sensor = ABOVE, **changes: object) -> SupportPlane | None:
    settings = load_settings().scene.model_copy(update=changes)
    return find_support_plane(Cloud(np.concatenate(parts)), sensor, settings, seed=0)


def height_and_tilt(found: SupportPlane | None) -> tuple[float, float]:
    assert found is not None
    return found.offset_m / found.normal[2], float(np.degrees(np.arccos(found.normal[2])))


class TestWhichPlane:
    @pytest.mark.parametrize(("share", "found"), [(0.09, False), (0.22, True)])
    def test_it_has_a_seventh_of_the_points(self, share: float, found: bool) -> None:
        assert (support(plane(share), scattered(1 - share)) is not None) == found

    @pytest.mark.parametrize(("tilt_deg", "found"), [(20, True), (40, False)])
    def test_it_lies_within_30_degrees_of_a_given_up(self, tilt_deg: float, found: bool) -> None:
        assert (support(plane(1, tilt_deg=tilt_deg), up=(0.0, 0.0, 1.0)) is not None) == found

    @pytest.mark.parametrize(("elevation_deg", "found"), [(25, True), (5, False)])
    def test_without_one_it_is_seen_by_10_degrees_at_least(self, elevation_deg: float, found: bool) -> None:
        angle = np.radians(elevation_deg)
        sensor = Sensor("option", 2 * np.array([np.cos(angle), 0.0, np.sin(angle)]))
        assert (support(plane(1), sensor=sensor) is not None) == found

    @pytest.mark.parametrize(("share", "nearer"), [(0.2, False), (0.4, True)])
    def test_the_nearer_of_two_counts_if_it_has_three_tenths_of_the_others_points(
        self, share: float, nearer: bool
    ) -> None:
        found = support(plane(1), plane(share, 0.3, seed=1), min_plane_share=0.05)
        assert height_and_tilt(found)[0] == pytest.approx(0.3 if nearer else 0, abs=1 * MM)

    @pytest.mark.parametrize(("tilt_deg", "height_m"), [(20, 0.4), (40, 0.0)])
    def test_they_lie_on_top_of_each_other_if_they_are_parallel_within_30_degrees(
        self, tilt_deg: float, height_m: float
    ) -> None:
        found = support(plane(1), plane(0.6, 0.4, tilt_deg, seed=1))
        assert height_and_tilt(found)[0] == pytest.approx(height_m, abs=2 * MM)

    def test_four_walls_may_be_larger_than_the_table(self) -> None:
        """Of planes one after another, each with fewer points than the one before."""
        walls = [plane(share, seed=k)[:, [2, 0, 1]] + [0.5 + 0.1 * k, 0, 0.3] for k, share in enumerate((1, 0.9, 0.8))]
        assert height_and_tilt(support(*walls, plane(0.7, seed=5), up=(0.0, 0.0, 1.0)))[1] < 1

    @pytest.mark.parametrize(("height_m", "looks"), [(0.085, False), (0.12, True)])
    def test_a_viewpoint_less_than_10_cm_above_it_is_no_sensors(self, height_m: float, looks: bool) -> None:
        assert looks_down(Sensor("option", np.array([3.0, 0.0, height_m])), UP, 0.0) == looks


class TestHowItIsFitted:
    @pytest.mark.parametrize(("distance_m", "tolerance_mm"), [(0.5, 4), (1, 8), (4, 32)])
    def test_points_may_be_off_by_a_share_of_their_distance(self, distance_m: float, tolerance_mm: float) -> None:
        sensor = Sensor("option", np.zeros(3))
        assert _tolerance(np.array([[distance_m, 0.0, 0.0]]), sensor)[0] == pytest.approx(tolerance_mm * MM)

    def test_of_a_sensor_that_nobody_knows_a_metre_is_assumed(self) -> None:
        assert _tolerance(np.ones((1, 3)), Sensor("all_sides"))[0] == pytest.approx(8 * MM)

    @pytest.mark.parametrize("noise_mm", [1.5, 3])
    def test_its_noise_is_a_standard_deviation(self, noise_mm: float) -> None:
        found = support(plane(1, noise_m=noise_mm * MM))
        assert found is not None
        assert found.noise_m == pytest.approx(noise_mm * MM, rel=0.08)

    def test_a_simulators_plane_has_none(self) -> None:
        """And objects are found on it: what is lower than the least of them counts as flat."""
        found = support(plane(1, noise_m=0))
        assert found is not None
        assert found.noise_m < 1e-9
        block = np.random.default_rng(1).uniform(-0.03, 0.03, (2000, 3)) * [1, 1, 0] + [0, 0, 0.004]
        assert len(scene_of(np.concatenate([plane(4, noise_m=0), block]), mode="table").objects) == 1

    def test_what_lies_close_to_it_adds_little_to_its_noise(self) -> None:
        """Half as many points within 15 mm on either side: once they are left out by its own scatter, 12 %."""
        found = support(plane(1, noise_m=0.5 * MM), (scattered(0.5) - [0, 0, 0.1]) * [1, 1, 0.05])
        assert found is not None
        assert 0.5 * MM < found.noise_m < 0.59 * MM

    def test_it_is_known_to_a_hundredth_of_a_degree(self) -> None:
        """Though its noise is 3 mm: by 10,000 points of it."""
        tilts = [height_and_tilt(support(plane(3, noise_m=3 * MM, seed=k)))[1] for k in range(8)]
        assert np.mean(tilts) < 0.015


def scene_of(points: FloatArray, **changes: object) -> Scene:
    settings = load_settings().scene.model_copy(update=changes)
    return segment(located(Cloud(points, ABOVE.position, Source("test")), None, 0), settings, 0)


class TestWhatAViewShows:
    @pytest.mark.parametrize(("side_m", "too_large"), [(12, False), (40, True)])
    def test_no_view_is_wider_than_20_m(self, side_m: float, too_large: bool) -> None:
        reason = scene_of(plane(1) * [side_m / 0.6, 1, 1]).reason or ""
        assert ("no view of objects" in reason) == too_large

    @pytest.mark.parametrize(("share", "too_large"), [(0.01, False), (0.04, True)])
    def test_a_fiftieth_at_either_end_may_be_strays(self, share: float, too_large: bool) -> None:
        away = np.array([50.0, 0.0, 0.0])
        far = np.concatenate([scattered(share) - away, scattered(share) + away])
        assert ("no view of objects" in (scene_of(np.concatenate([plane(1), far])).reason or "")) == too_large

    @pytest.mark.parametrize(
        ("share", "depth_m", "noise_m", "below"),
        [
            *((0.022, 0.05, 1 * MM, False), (0.04, 0.05, 1 * MM, True)),
            *((0.2, 0.008, 1 * MM, False), (0.2, 0.013, 1 * MM, True)),
            *((0.2, 0.16, 1 * MM, True), (0.2, 0.28, 1 * MM, False)),
            *((0.2, 0.013, 6 * MM, False), (0.2, 0.03, 6 * MM, True)),
        ],
        ids=["few", "many", "near", "below", "still close", "floor", "noise", "below noise"],
    )
    def test_what_goes_on_below_a_plane_is_a_body(
        self, share: float, depth_m: float, noise_m: float, below: bool
    ) -> None:
        """More than 3 % of the points, 1 to 20 cm below it, and below three standard deviations of its noise."""
        points = np.concatenate([plane(1, noise_m=0.1 * noise_m), plane(share, -depth_m, noise_m=0)])
        assert _goes_on_below(Cloud(points), SupportPlane(UP, 0.0, noise_m), load_settings().scene) == below

    @pytest.mark.parametrize(("slant_deg", "from_above"), [(8, False), (16, True)])
    def test_the_hand_comes_from_above_unless_the_object_stands_within_11_degrees_of_upright(
        self, slant_deg: float, from_above: bool
    ) -> None:
        """Then its main plane has no upper side, and is turned to the sensor, which stands off toward −x."""
        settings = load_settings().scene.model_copy(update={"mode": "object", "up": (0.0, 0.0, 1.0)})
        sensor = Sensor("option", np.array([-1.0, 0.0, 0.0]))
        (item,) = segment(Cloud(plane(1), None, Source("test"), sensor=sensor), settings, 0).objects
        angle = np.radians(slant_deg)
        upper_side = np.array([np.cos(angle), 0.0, np.sin(angle)])
        assert (upper_side @ item.toward > 0) == from_above

    def test_what_stands_within_20_cm_is_in_the_hands_way(self) -> None:
        blocks = (
            np.random.default_rng(k).uniform(-0.5, 0.5, (3000, 3)) * [0.06, 0.06, 0.0] + [x, 0, 0.05]
            for k, x in enumerate((-0.25, -0.05, 0.2))
        )
        scene = scene_of(np.concatenate([plane(4), *blocks]), mode="table")
        first, *_ = sorted(scene.objects, key=lambda item: float(item.points[:, 0].mean()))
        assert len(scene.objects) == 3
        assert (np.abs(first.obstacles[:, 0] + 0.05) < 0.04).any()
        assert not (first.obstacles[:, 0] > 0.15).any()

    def test_where_no_sensor_is_known_one_a_metre_above_is_assumed(self) -> None:
        block = on_table(bar(0.06, 0.04, 0.03))
        floor = plane(4)
        points = np.concatenate([floor[np.abs(floor[:, :2]).max(axis=1) > 0.05], block.points])
        settings = load_settings().scene.model_copy(update={"mode": "table"})
        (item,) = segment(Cloud(points, None, Source("test"), sensor=Sensor("up", direction=UP)), settings, 0).objects
        assert item.viewpoint is not None
        assert item.viewpoint - item.points.mean(axis=0) == pytest.approx([0, 0, 1], abs=0.01)
