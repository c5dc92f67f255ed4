"""How deep, how wide and where fingers go over a table: heights worked out by hand, and a search for any collision."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flatgrasp_cli import Plan, load_gripper, load_settings, plan, read_clouds
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.model import Cloud, Grasp, ObjectPlan, Source
from flatgrasp_cli.planning import plan_object
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.scene import segment
from flatgrasp_cli.surroundings.slices import lowest_tip
from tests.conftest import EACH, MM, SAMPLES, TABLE, Box, Camera, Solid, Tube

ABOVE = Camera(pixels=(320, 240), focal=420.0)
KINECT = Camera(tilt_deg=50, pixels=(640, 480), focal=525.0)
DEPTH, HAND = load_settings().depth, load_settings().hand
BLOCK = Box((0.0, 0.0, 0.02), (0.10, 0.04, 0.04))
SLACK_M = 3 * MM
"""A cell of the height maps: fingers may come this much nearer to a point than their own boxes."""
PALM_SLACK_M = 6 * MM
"""The same of the palm's coarser map."""
HEIGHT_SLACK_M = 2 * MM
"""What the sensor's noise of 0.5 mm does to a single point, at most."""


def planned(cloud: Cloud, gripper: Gripper, *overrides: str, top: int = 10) -> Plan:
    """The best `top` grasps, those at about one place, too."""
    return plan(cloud, gripper, load_settings("default", (*EACH, *overrides)), top=top)


def best(result: Plan) -> Grasp:
    assert result.best is not None, result.reason
    return result.best


def seen(gripper: Gripper, *solids: Solid, camera: Camera = ABOVE) -> Grasp:
    """The best grasp of what a camera sees on the table."""
    return best(planned(camera.sees(TABLE, *solids), gripper))


def ground() -> tuple[FloatArray, FloatArray]:
    """X and y (n, n) of places 1 mm apart on a table of 30 × 30 cm."""
    x, y = np.meshgrid(np.arange(-150, 151) * MM, np.arange(-150, 151) * MM)
    return x, y


def relief(heights: FloatArray) -> Cloud:
    """The cloud of a surface so high over `ground`, seen from above, with noise of 0.3 mm."""
    x, y = ground()
    noise = np.random.default_rng(0).normal(0, 0.3 * MM, heights.size)
    return Cloud(
        np.column_stack([x.ravel(), y.ravel(), heights.ravel() + noise]), np.array([0, 0, 0.8]), Source("relief")
    )


def in_hand(grasp: Grasp, points: FloatArray) -> FloatArray:
    """Points (n, 3) in the fingertip frame."""
    return Frame(grasp.position, axes_from_quaternion(grasp.orientation)).to_local(points)


def struck(grasp: Grasp, gripper: Gripper, points: FloatArray) -> FloatArray:
    """Which of `points`, in the fingertip frame, fingers and palm sweep on their way down, opened for the approach."""
    local = in_hand(grasp, points)
    x, y, z = local.T
    hit = np.zeros(len(local), dtype=np.bool_)
    half, above = 0.5 * grasp.opening_m, z < -HEIGHT_SLACK_M
    for sign, offsets in zip((-1, 1), gripper.jaws, strict=True):
        out = sign * y
        in_depth = (out > half + SLACK_M) & (out < half + gripper.finger_thickness_m - SLACK_M)
        for offset in offsets:
            hit |= above & in_depth & (np.abs(x - offset) < 0.5 * gripper.finger_width_m - SLACK_M)
    in_palm = (np.abs(x) < 0.5 * gripper.hand_width_m - PALM_SLACK_M) & (
        np.abs(y) < 0.5 * gripper.palm_m - PALM_SLACK_M
    )
    return np.asarray(local[hit | (in_palm & (z < -gripper.finger_length_m))])


class TestHeightMap:
    POINTS = np.array([[0.0, 0.0, 1.0], [0.004, 0.003, 3.0], [0.012, 0.0, -2.0]])

    def test_each_cell_holds_its_highest_point(self) -> None:
        chart = HeightMap.of(self.POINTS, 0.01)
        assert chart.over(np.array([0.001, 0.015]), np.array([0.009, 0.005])).tolist() == [3.0, -2.0]

    def test_what_lies_outside_or_between_is_unseen(self) -> None:
        chart = HeightMap.of(self.POINTS, 0.01)
        outside = np.array([[0.0, 0.05], [-0.05, 0.0], [9.0, 9.0], [-9.0, -9.0]])
        assert (chart.over(*outside.T) == UNSEEN).all()

    def test_a_map_of_nothing_is_unseen(self) -> None:
        assert HeightMap.of(np.empty((0, 3)), 0.01).over(*np.zeros((2, 2, 4))).tolist() == [[UNSEEN] * 4] * 2

    def test_the_same_cells_averaged(self) -> None:
        chart = HeightMap.of(self.POINTS, 0.01).averaged(self.POINTS)
        assert chart.over(*self.POINTS[:, :2].T).tolist() == [2.0, 2.0, -2.0]

    @settings(max_examples=15)
    @given(st.integers(0, 2**31 - 1), st.floats(0.002, 0.02))
    def test_it_is_the_brute_force_maximum(self, seed: int, cell: float) -> None:
        points = np.random.default_rng(seed).uniform(-0.05, 0.05, (200, 3))
        chart = HeightMap.of(points, cell)
        corner = np.floor((points[:, :2] - chart.raster.origin) / chart.cell_m)
        for k in range(0, 200, 20):
            mates = (corner == corner[k]).all(axis=1)
            assert chart.over(*points[k, :2]) == points[mates, 2].max()


def test_the_lowest_tip_leaves_the_clearance_or_a_share_of_a_low_object() -> None:
    clearance, least, share = DEPTH.table_clearance_m, DEPTH.min_clearance_m, DEPTH.low_object_share
    assert lowest_tip(0.1, DEPTH) == clearance
    pen = 0.5 * (least + clearance) / share
    assert lowest_tip(pen, DEPTH) == pytest.approx(share * pen)
    assert lowest_tip(0.001, DEPTH) == least


class TestDepth:
    def test_fingertips_stop_at_the_clearance_over_the_table(self, pr2: Gripper) -> None:
        grasp = seen(pr2, BLOCK)
        assert grasp.position[2] == pytest.approx(DEPTH.table_clearance_m, abs=0.5 * MM)
        assert grasp.tip_height_m == pytest.approx(DEPTH.table_clearance_m, abs=0.1 * MM)
        assert grasp.grip_m == pytest.approx(0.04 - DEPTH.table_clearance_m, abs=1.5 * MM)
        assert grasp.width_m == pytest.approx(0.04, abs=3 * MM)
        assert grasp.position[:2] == pytest.approx([0, 0], abs=4 * MM)

    def test_fingertips_stop_at_a_third_of_a_pen(self, pr2: Gripper) -> None:
        height = 9 * MM
        grasp = seen(pr2, Tube((0.0, 0.0, height / 2), height / 2, 0.14, (1.0, 0.5, 0.0)))
        assert grasp.tip_height_m == pytest.approx(DEPTH.low_object_share * height, abs=0.8 * MM)
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
            assert grasp.tip_height_m == pytest.approx(DEPTH.low_object_share * low, abs=0.4 * MM)
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
        assert pen.grasps[0].width_m == pytest.approx(0.008, abs=1.5 * MM)

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
        grasp = best(planned(replace(KINECT, tilt_deg=tilt_deg).sees(TABLE, box, seed=seed), pr2))
        assert grasp.position[0] == pytest.approx(0, abs=10 * MM)
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


class TestOpening:
    def test_it_is_the_width_and_the_preshape_where_nothing_is_in_the_way(self, pr2: Gripper) -> None:
        for grasp in planned(ABOVE.sees(TABLE, BLOCK), pr2).objects[0].grasps:
            wanted = min(grasp.width_m + 2 * HAND.preshape_m, pr2.max_opening_m)
            assert grasp.opening_m == pytest.approx(wanted, abs=0.1 * MM)

    def test_an_obstacle_close_on_one_side_narrows_it(self, pr2: Gripper) -> None:
        """The finger, 9 mm thick, comes down between the block and a wall 20 mm beside it."""
        gap = 0.020
        wall = Box((0.0, 0.02 + gap + 0.01, 0.025), (0.2, 0.02, 0.05))
        result = planned(ABOVE.sees(TABLE, BLOCK, wall), pr2, "scene.select=[0,0]")
        grasp = best(result)
        free = gap - pr2.finger_thickness_m
        assert grasp.width_m == pytest.approx(0.04, abs=3 * MM)
        assert grasp.width_m + 2 * HAND.clearance_m - 0.1 * MM < grasp.opening_m < 0.04 + 2 * (free + SLACK_M)
        assert grasp.position[2] == pytest.approx(DEPTH.table_clearance_m, abs=1.5 * MM)

    def test_an_obstacle_too_close_removes_the_grasp(self, lacquey: Gripper) -> None:
        """Between block and wall there are 15 mm, a finger is 20 mm thick, and the block is too long the other way."""
        wall, block = Box((0.0, 0.045, 0.025), (0.2, 0.02, 0.05)), Box((0.0, 0.0, 0.02), (0.14, 0.04, 0.04))
        result = planned(ABOVE.sees(TABLE, block, wall), lacquey, "scene.select=[0,0]")
        assert result.best is None
        rejection = result.objects[0].rejection
        assert rejection is not None
        assert (rejection.stage, rejection.limit) == ("depth", 0.0)
        assert best(planned(ABOVE.sees(TABLE, block), lacquey)).width_m == pytest.approx(0.04, abs=3 * MM)

    def test_a_low_obstacle_only_keeps_the_fingertips_up(self, pr2: Gripper) -> None:
        step = Box((0.0, 0.034, 0.0075), (0.2, 0.02, 0.015))
        free, over = Box((0.0, 0.0, 0.03), (0.14, 0.04, 0.06)), 0.015
        grasp = best(planned(ABOVE.sees(TABLE, free, step), pr2, "scene.select=[0,0]", "scene.gap_m=0.001"))
        assert grasp.position[2] == pytest.approx(over + DEPTH.obstacle_clearance_m, abs=3 * MM)

    def test_what_is_wider_than_the_hand_is_refused_with_the_numbers(self, pr2: Gripper) -> None:
        result = planned(ABOVE.sees(TABLE, Box((0.0, 0.0, 0.03), (0.15, 0.13, 0.06))), pr2)
        rejection = result.objects[0].rejection
        assert rejection is not None
        assert rejection.stage == "grasping_range"
        assert rejection.value == pytest.approx(0.13, abs=4 * MM)
        assert rejection.limit == pytest.approx(pr2.max_opening_m - 2 * HAND.clearance_m)
        assert f"{rejection.value:.3f} m" in str(result.reason)
        assert f"gripper opens {pr2.max_opening_m:.3f} m" in str(result.reason)


class TestWhatHangsInTheAir:
    """Something small 0.1 m over the table, as a stereo camera sees it beside an edge."""

    GHOST = Box((0.05, 0.0, 0.11), (0.02, 0.012, 0.02))

    def ends(self, gripper: Gripper, *solids: Solid, camera: Camera = KINECT) -> dict[int, str | None]:
        """The stages at which the method ended, by object; None for those with a grasp."""
        objects = planned(camera.sees(TABLE, *solids), gripper).objects
        return {item.object.id: item.rejection.stage if item.rejection else None for item in objects}

    def test_with_free_space_below_it_is_not_grasped(self, pr2: Gripper) -> None:
        assert self.ends(pr2, Box((-0.1, 0.0, 0.02), (0.10, 0.04, 0.04)), self.GHOST) == {0: None, 1: "support"}
        result = planned(KINECT.sees(TABLE, self.GHOST), pr2)
        assert result.reason == "it hangs 100 mm up in the air: only free space was seen below it"

    def test_on_a_post_it_is(self, pr2: Gripper) -> None:
        assert self.ends(pr2, self.GHOST, Tube((0.05, 0.0, 0.05), 0.004, 0.1)) == {0: None}

    def test_where_nothing_was_seen_below_it_is(self, pr2: Gripper) -> None:
        assert self.ends(pr2, self.GHOST, camera=Camera(target=(0.05, 0.0, 0.0))) == {0: None}

    def test_what_is_larger_may_be_held_by_what_was_not_seen(self, pr2: Gripper) -> None:
        assert self.ends(pr2, Box((0.05, 0.0, 0.11), (0.06, 0.012, 0.02))) == {0: None}


@settings(max_examples=8)
@given(st.integers(0, 2**31 - 1), st.sampled_from(["pr2", "lacquey", "wsg_50"]), st.sampled_from([0, 35]))
def test_nothing_seen_is_inside_fingers_or_palm_on_their_way(seed: int, name: str, tilt: int) -> None:
    rng, gripper = np.random.default_rng(seed), load_gripper(name)
    boxes = [Box((0.0, 0.18, 0.025), (0.1, 0.03, 0.05))]  # apart from the others: this one is surely grasped
    for _ in range(rng.integers(2, 5)):
        size = rng.uniform([0.03, 0.02, 0.015], [0.12, 0.06, 0.10])
        x, y = rng.uniform(-0.12, 0.12), rng.uniform(-0.08, 0.08)
        boxes.append(Box((x, y, size[2] / 2), (size[0], size[1], size[2]), rng.uniform(0, 180)))
    cloud = Camera(tilt_deg=tilt).sees(TABLE, *boxes, seed=seed % 1000)
    above = cloud.points[cloud.points[:, 2] > 3 * MM]
    items = [item for item in planned(cloud, gripper, top=20).objects if item.object.support is not None]
    grasps = [grasp for item in items for grasp in item.grasps]
    from_above = [grasp for grasp in grasps if axes_from_quaternion(grasp.orientation)[2, 2] < -0.99]
    assert len(from_above) > 0
    for grasp in from_above:
        assert struck(grasp, gripper, above).tolist() == []


def test_a_hand_that_is_too_wide_open_would_be_found_out(pr2: Gripper) -> None:
    """The search above does find a collision where there is one."""
    cloud = ABOVE.sees(TABLE, BLOCK, Box((0.0, 0.05, 0.025), (0.2, 0.02, 0.05)))
    grasp = best(planned(cloud, pr2, "scene.select=[0,0]"))
    above = cloud.points[cloud.points[:, 2] > 3 * MM]
    assert len(struck(grasp, pr2, above)) == 0
    assert len(struck(replace(grasp, opening_m=0.08), pr2, above)) > 10
    assert len(struck(replace(grasp, position=grasp.position - [0, 0, 0.05]), pr2, above)) > 10


class TestHiddenSides:
    @pytest.mark.parametrize("radius", [0.02, 0.025, 0.033])
    def test_the_opening_clears_a_lying_can_whose_far_flank_is_hidden(self, radius: float, pr2: Gripper) -> None:
        can = Tube((0.0, 0.0, radius), radius, 0.14, (1.0, 0.0, 0.0))
        grasp = seen(pr2, can, camera=KINECT)
        low, high = (grasp.position[1] + sign * grasp.opening_m / 2 for sign in (-1, 1))
        assert abs(axes_from_quaternion(grasp.orientation)[1, 1]) > 0.98
        assert low < -radius - HAND.clearance_m
        assert high > radius + HAND.clearance_m

    def test_the_same_with_coarser_pixels(self, pr2: Gripper) -> None:
        grasp = seen(pr2, Tube((0.0, 0.0, 0.033), 0.033, 0.12, (1.0, 0.0, 0.0)), camera=replace(ABOVE, tilt_deg=50))
        assert grasp.position[1] + grasp.opening_m / 2 > 0.033

    def test_a_box_seen_obliquely_goes_on_no_further(self, pr2: Gripper) -> None:
        box = Box((0.0, 0.0, 0.025), (0.12, 0.05, 0.05))
        grasp = seen(pr2, box, camera=KINECT)
        assert grasp.width_m == pytest.approx(0.05, abs=3 * MM)
        assert grasp.position[1] == pytest.approx(0, abs=2 * MM)
        assert grasp.unseen_m is not None
        assert grasp.unseen_m > 5 * MM  # the far finger comes down in the box's shadow

    def test_from_straight_above_nothing_is_hidden(self, pr2: Gripper) -> None:
        assert seen(pr2, BLOCK).unseen_m == pytest.approx(0, abs=1 * MM)

    def test_unseen_may_be_refused(self, pr2: Gripper) -> None:
        box = Box((0.0, 0.0, 0.025), (0.14, 0.05, 0.05))
        result = planned(KINECT.sees(TABLE, box), pr2, "depth.unseen=refuse")
        assert result.best is None
        assert result.objects[0].rejection is not None
        assert result.objects[0].rejection.stage in {"unseen", "seen"}
        assert "hidden" in str(result.reason)

    def in_hole(self, camera: Camera, gripper: Gripper) -> int:
        """How many of the best grasps of a ring have a finger in its bore, of 30 mm radius."""
        ring = Tube((0.0, 0.0, 0.04), 0.06, 0.08, bore=0.03)
        result = planned(camera.sees(TABLE, ring), gripper, top=50)
        assert result.scene.support is not None
        contacts = [grasp.contacts for item in result.objects for grasp in item.grasps]
        return sum(bool((np.linalg.norm(pair[:, :2], axis=1) < 0.04).any()) for pair in contacts)

    def test_a_hole_is_used_only_if_it_was_seen_through(self, pr2: Gripper) -> None:
        assert self.in_hole(ABOVE, pr2) > 0
        assert self.in_hole(KINECT, pr2) == 0


class TestOnTheObject:
    def plan_alone(self, cloud: Cloud, gripper: Gripper) -> ObjectPlan:
        asked = load_settings().resolve(gripper)
        scene = segment(cloud, asked.scene, 0)
        return plan_object(scene.objects[0], gripper, asked)

    def test_levels_and_heights_are_null_for_an_object_alone(self, pr2: Gripper) -> None:
        answer = self.plan_alone(ABOVE.sees(BLOCK), pr2)
        assert answer.level_m is None
        assert {(grasp.tip_height_m, grasp.grip_m, grasp.unseen_m) for grasp in answer.grasps} == {(None, None, None)}

    def test_the_level_is_that_of_the_fingertips(self, pr2: Gripper) -> None:
        answer = self.plan_alone(ABOVE.sees(TABLE, BLOCK), pr2)
        assert answer.level_m == pytest.approx(DEPTH.table_clearance_m)
        assert answer.box is not None
        assert answer.box.size == pytest.approx([0.10, 0.04, 0.04], abs=4 * MM)

    @settings(max_examples=4)
    @given(st.integers(0, 2**31 - 1))
    def test_a_moved_cloud_has_the_moved_grasp(self, seed: int) -> None:
        gripper, cloud = load_gripper("pr2"), Camera(tilt_deg=25).sees(TABLE, BLOCK)
        turn, shift = Rotation.random(random_state=seed), np.random.default_rng(seed).uniform(-1, 1, 3)
        moved = replace(cloud, points=turn.apply(cloud.points) + shift, viewpoint=turn.apply(cloud.viewpoint) + shift)
        one, other = best(planned(cloud, gripper)), best(planned(moved, gripper))
        assert other.position == pytest.approx(turn.apply(one.position) + shift, abs=1.5 * MM)
        before, after = (axes_from_quaternion(grasp.orientation) for grasp in (one, other))
        assert turn.apply(before[2]) @ after[2] > np.cos(np.radians(1.5))
        assert abs(turn.apply(before[1]) @ after[1]) > np.cos(np.radians(1.5))
        assert [other.width_m, other.opening_m] == pytest.approx([one.width_m, one.opening_m], abs=2 * MM)
