"""How deep fingers go over a table, and where: heights worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, plan, read_clouds
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.surroundings.slices import lowest_tip
from tests.conftest import MM, SAMPLES, TABLE, Box, Camera, Tube, holds
from tests.surroundings.on_a_table import ABOVE, BLOCK, DEPTH, KINECT, best, ground, planned, relief, seen


def test_the_lowest_tip_leaves_the_clearance_to_the_table_and_to_the_middle_of_a_low_object() -> None:
    clearance, least = DEPTH.table_clearance_m, DEPTH.min_clearance_m
    assert lowest_tip(0.1, DEPTH) == clearance
    between = 0.5 * (least + clearance)
    assert lowest_tip(2 * (clearance + between), DEPTH) == pytest.approx(between)
    assert lowest_tip(0.001, DEPTH) == least


class TestDepth:
    def test_fingertips_stop_at_the_clearance_over_the_table(self, pr2: Gripper) -> None:
        grasp = seen(pr2, BLOCK)
        assert grasp.position[2] == pytest.approx(DEPTH.table_clearance_m, abs=0.5 * MM)
        assert grasp.tip_height_m == pytest.approx(DEPTH.table_clearance_m, abs=0.1 * MM)
        assert grasp.grip_m == pytest.approx(0.04 - DEPTH.table_clearance_m, abs=1.5 * MM)
        assert grasp.width_m == pytest.approx(0.04, abs=3 * MM)
        assert grasp.position[:2] == pytest.approx([0, 0], abs=4 * MM)

    def test_fingertips_end_4_mm_below_the_middle_of_a_pen(self, pr2: Gripper) -> None:
        height = 13 * MM
        grasp = seen(pr2, Tube((0.0, 0.0, height / 2), height / 2, 0.14, (1.0, 0.5, 0.0)))
        assert grasp.tip_height_m == pytest.approx(height / 2 - DEPTH.table_clearance_m, abs=0.5 * MM)
        assert DEPTH.min_clearance_m < grasp.position[2] < DEPTH.table_clearance_m

    @pytest.mark.parametrize("name", ["pr2", "lacquey"])
    def test_the_palm_stops_over_a_tall_box(self, name: str, request: pytest.FixtureRequest) -> None:
        """The highest of its points lies some standard deviations of the noise above its top."""
        gripper: Gripper = request.getfixturevalue(name)
        top = 0.12
        grasp = seen(gripper, Box((0.0, 0.0, top / 2), (0.10, 0.04, top)))
        expected = top + DEPTH.palm_clearance_m - gripper.finger_length_m
        assert expected - 0.5 * MM < grasp.position[2] < expected + 3 * MM

    def test_longer_fingers_go_deeper(self, pr2: Gripper) -> None:
        tall = ABOVE.sees(TABLE, Box((0.0, 0.0, 0.06), (0.10, 0.04, 0.12)))
        short, long = (
            best(planned(tall, pr2.model_copy(update={"finger_length_m": length}))) for length in (0.058, 0.078)
        )
        assert short.position[2] - long.position[2] == pytest.approx(0.020, abs=1 * MM)

    def test_the_contacts_lie_on_the_object_at_the_height_of_the_grip(self, pr2: Gripper) -> None:
        grasp = seen(pr2, BLOCK)
        low, high = grasp.contacts[np.argsort(grasp.contacts[:, 1])]
        assert [low[1], high[1]] == pytest.approx([-0.02, 0.02], abs=2.5 * MM)
        assert (grasp.contacts[:, 2] > DEPTH.table_clearance_m).all()
        assert (grasp.contacts[:, 2] < 0.042).all()

    def test_the_hand_comes_straight_down_on_the_table(self, pr2: Gripper) -> None:
        for grasp in planned(Camera(tilt_deg=40).sees(TABLE, BLOCK), pr2).objects[0].grasps:
            assert axes_from_quaternion(grasp.orientation)[2] == pytest.approx([0, 0, -1], abs=0.005)

    def test_a_heaps_upper_box_is_grasped_at_its_own_width_above_the_lower_one(self, pr2: Gripper) -> None:
        lower, upper = Box((0.0, 0.0, 0.0175), (0.16, 0.12, 0.035)), Box((0.01, 0.0, 0.055), (0.09, 0.03, 0.04))
        grasp = seen(pr2, lower, upper)
        assert grasp.width_m == pytest.approx(0.03, abs=3 * MM)
        assert grasp.position[2] > 0.035 + 1 * MM
        assert grasp.position[1] == pytest.approx(0, abs=2 * MM)

    @pytest.mark.parametrize("lower_m", [0.030, 0.038, 0.042])
    def test_a_heaps_upper_box_is_grasped_whatever_the_lower_ones_height(self, lower_m: float, pr2: Gripper) -> None:
        lower = Box((0.0, 0.0, lower_m / 2), (0.16, 0.12, lower_m))
        upper = Box((0.01, 0.0, lower_m + 0.015), (0.09, 0.03, 0.03))
        grasp = seen(pr2, lower, upper, camera=replace(KINECT, tilt_deg=0))
        assert grasp.width_m == pytest.approx(0.03, abs=3 * MM)

    def test_an_object_hardly_wider_than_a_finger_is_grasped(self, pr2: Gripper) -> None:
        die = ABOVE.sees(TABLE, Box((0.0, 0.0, 0.01), (0.02, 0.02, 0.02)))
        grasp = best(planned(die, pr2))
        assert grasp.width_m == pytest.approx(0.02, abs=4 * MM)
        assert grasp.position[:2] == pytest.approx([0, 0], abs=3 * MM)
        assert planned(die, pr2, "fingers.chord_share_max=null").best is None

    @pytest.mark.parametrize("length_m", [0.010, 0.025])
    def test_a_high_end_does_not_keep_the_fingers_off_the_low_middle(self, length_m: float, pr2: Gripper) -> None:
        """A fork: too low in the middle for the tips' height over an object as high as its end."""
        x, y = ground()
        fork, low = (np.abs(x) < 0.055) & (np.abs(y) < 0.004), 6 * MM
        heights = np.where(fork, np.where(x > 0.055 - length_m, 14 * MM, low), 0.0)
        grasps = planned(relief(heights), pr2, top=1000).objects[0].grasps
        middle = [grasp for grasp in grasps if abs(grasp.position[0]) < 0.01]
        assert len(middle) > 0
        for grasp in middle:
            assert grasp.tip_height_m == pytest.approx(DEPTH.min_clearance_m)
            assert grasp.width_m == pytest.approx(0.008, abs=2 * MM)

    def test_the_centre_of_gravity_is_the_objects_and_not_the_slices(self, pr2: Gripper) -> None:
        """A plate with a knob at its end: the knob alone can be gripped, 4 cm from the plate's middle."""
        x, y = ground()
        plate, knob = (np.abs(x) < 0.06) & (np.abs(y) < 0.06), (np.abs(x - 0.04) < 0.012) & (np.abs(y) < 0.012)
        heights = np.where(knob, 40 * MM, np.where(plate, 10 * MM, 0.0))
        item = planned(relief(heights), pr2, top=1000).objects[0]
        assert item.level_m is not None
        assert item.level_m > 10 * MM
        across = [
            grasp.gravity_distance_m
            for grasp in item.grasps
            if abs(axes_from_quaternion(grasp.orientation)[1, 1]) > 0.999
        ]
        assert len(across) > 0
        assert across == pytest.approx(np.full(len(across), 0.04), abs=8 * MM)

    @pytest.mark.parametrize("name", ["lacquey", "pr2", "robotiq_2f_85"])
    def test_a_pen_of_few_points_is_not_in_the_way_of_its_own_fingers(self, name: str) -> None:
        """A rod of 8 mm in three rows of pixels: six neighbours of a point lie far along it, not a cell apart."""
        scene = next(iter(read_clouds(SAMPLES / "table_scene.pcd")))
        pen = min(plan(scene, load_gripper(name)).objects, key=lambda item: len(item.object.points))
        assert len(pen.object.points) < 60
        assert any(grasp.width_m == pytest.approx(0.008, abs=1.5 * MM) for grasp in pen.grasps)

    def test_a_knife_is_taken_by_its_handle(self, pr2: Gripper) -> None:
        """Though its middle is nearer, and wide enough for the pads: a blade is low."""
        x, y = ground()
        blade, handle = (np.abs(x) < 0.06) & (np.abs(y) < 0.012), (x > 0.02) & (x < 0.10) & (np.abs(y) < 0.008)
        grasp = best(planned(relief(np.where(handle, 15 * MM, np.where(blade, 5 * MM, 0.0))), pr2))
        assert grasp.position[0] > 0.02

    @pytest.mark.parametrize(("tilt_deg", "height_m"), [(35, 0.016), (35, 0.025), (50, 0.008), (50, 0.025)])
    @pytest.mark.parametrize("seed", [0, 1, 2])
    def test_the_face_that_the_sensor_sees_is_a_wall(
        self, tilt_deg: float, height_m: float, seed: int, pr2: Gripper
    ) -> None:
        """The mean height of its points is but half of its own, and its foot is lower than its top."""
        box = Box((0.0, 0.0, height_m / 2), (0.10, 0.04, height_m))
        (item,) = planned(replace(KINECT, tilt_deg=tilt_deg).sees(TABLE, box, seed=seed), pr2).objects
        best, middle = item.grasps[0], min(item.grasps, key=lambda grasp: float(abs(grasp.position[0])))
        assert middle.position[0] == pytest.approx(0, abs=10 * MM)
        assert holds(middle) > holds(best) - 0.12  # how upright it looks differs along it by chance
        for grasp in (best, middle):
            assert grasp.grip_m is not None
            assert grasp.grip_m > 0.5 * height_m

    @pytest.mark.parametrize(("slope", "held"), [(1.2, False), (4.0, True)])
    def test_pads_slip_off_a_flank(self, slope: float, held: bool, pr2: Gripper) -> None:
        """A ridge whose sides rise by so much: friction holds where that is more than 1/μ."""
        x, y = ground()
        rise = np.minimum(slope * (0.025 - np.abs(y)), 0.03)
        result = planned(relief(np.where((np.abs(x) < 0.05) & (rise > 0), rise, 0.0)), pr2)
        across = [abs(axes_from_quaternion(grasp.orientation)[1, 1]) > 0.9 for grasp in result.objects[0].grasps]
        assert any(across) == held
