"""What the method runs on: slices of an object, the maps of what stands around it, and what hangs in the air."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_settings, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import ObjectCloud
from flatgrasp_cli.scene import segment
from flatgrasp_cli.sensor import located
from flatgrasp_cli.surroundings import OnSupport, Place, box_on, hanging_m, places
from flatgrasp_cli.surroundings.slices import slices, top_of
from flatgrasp_cli.surroundings.walls import walls
from tests.by_hand import MM, bar, candidates, on_table
from tests.conftest import TABLE, Box, Camera, Tube
from tests.scene.test_heaps import distance
from tests.surroundings.on_a_table import hand_in

SETTINGS = load_settings()
DEPTH = SETTINGS.depth
BAR = bar(0.1, 0.04, 0.04)


def whole_of(cloud: ObjectCloud) -> Place:
    """The place of the whole object."""
    assert cloud.support is not None
    box = box_on(cloud.support, cloud.points, "min_area")
    assert box is not None
    return next(places(cloud, box, load_gripper("pr2"), SETTINGS))


def around(place: Place) -> OnSupport:
    assert isinstance(place.surroundings, OnSupport)
    return place.surroundings


def block_of(size: tuple[float, float, float], center: tuple[float, float, float], pitch_m: float) -> FloatArray:
    """Points (n, 3) that fill a box."""
    axes = [c + np.arange(-0.5 * s, 0.5 * s + 1e-9, pitch_m) for s, c in zip(size, center, strict=True)]
    return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)


@pytest.mark.parametrize(
    ("leg_m", "feet_mm"), [(0.02, (26.8, 40)), (0.118, (5, 5))], ids=["a board on a leg", "a block"]
)
def test_rays_that_pass_below_a_rim_show_that_it_overhangs(leg_m: float, feet_mm: tuple[float, float]) -> None:
    """A board of 12 × 12 × 0.8 cm, 4 cm high. Seen from 30° aside, rays pass 3 mm inward of its edge 26.8 mm up.

    Its face is hardly seen. What is below its far side nobody saw: it is taken to be like the near one, as of a block.
    """
    board, leg = Box((0.0, 0.0, 0.036), (0.12, 0.12, 0.008)), Box((0.0, 0.0, 0.016), (leg_m, leg_m, 0.032))
    cloud = Camera(tilt_deg=30, pixels=(640, 480), focal=525.0).sees(TABLE, board, leg, noise_m=0)
    (seen,) = segment(located(cloud, None, 0), SETTINGS.scene, 0).objects
    whole = whole_of(seen)
    near, far, center = whole.frame.to_local(np.array([[0.0, -0.06, 0.0], [0.0, 0.06, 0.0], [0.0, 0.0, 0.0]]))[:, :2]
    inward = np.stack([center - near, center - far]) / 0.06
    relief, pads = around(whole), candidates(np.stack([near, far]), inward)
    found = walls(pads, relief.maps.surface, relief.envelope, relief.level_m, 0.5)
    feet = found.feet(np.array([[0], [1]]), np.full(1, 5 * MM))[0]
    assert feet / MM == pytest.approx(np.array([feet_mm, feet_mm]), abs=1.1)  # half a cell


class TestSlices:
    @staticmethod
    def heap(tower_mm: float = 30.0) -> FloatArray:
        """A plate of 100 × 100 × 30 mm with a tower of 50 mm on it, so long and wide, as points 1 mm apart."""
        x, y = np.meshgrid(np.arange(-50, 51) * MM, np.arange(-50, 51) * MM)
        half = 0.5 * tower_mm * MM
        z = np.where((np.abs(x) <= half) & (np.abs(y) <= half), 80 * MM, 30 * MM)
        return np.column_stack([x.ravel(), y.ravel(), z.ravel()])

    def test_what_stands_out_is_a_slice(self) -> None:
        tower = list(slices(self.heap(), 2 * MM, DEPTH))
        assert [len(piece.rows) for piece in tower] == [31**2, 31**2]  # close above the plate, and a step higher
        assert 30 * MM < tower[0].level_m <= 30 * MM + DEPTH.slice_step_m
        assert tower[1].level_m == pytest.approx(tower[0].level_m + DEPTH.slice_step_m)

    @pytest.mark.parametrize(("side", "parts"), [(5, 0), (6, 2)])
    def test_of_fewer_than_30_points_there_is_no_silhouette(self, side: int, parts: int) -> None:
        """A tower of five points a side, or of six, on a plate of 31."""
        heap = self.heap()
        heap = heap[np.abs(heap[:, :2]).max(axis=1) < 15.5 * MM] * [1, 1, 0] + [0, 0, 30 * MM]
        x, y = np.round(heap[:, :2].T / MM)
        heap[(x >= 0) & (x < side) & (y >= 0) & (y < side), 2] = 80 * MM
        assert len(list(slices(heap, 2 * MM, DEPTH))) == parts

    def test_of_a_block_nothing_stands_out(self) -> None:
        block = self.heap()
        block[:, 2] = 60 * MM
        assert not list(slices(block, 2 * MM, DEPTH))

    def test_two_towers_are_two_parts(self) -> None:
        points = self.heap()
        points[:, 2] = np.where(np.abs(np.abs(points[:, 0]) - 0.03) < 0.011, 80 * MM, 30 * MM)
        towers = list(slices(points, 2 * MM, DEPTH))
        assert len(towers) == 4
        for left, right in (towers[:2], towers[2:]):
            assert points[left.rows, 0].max() < 0 < points[right.rows, 0].min()

    @pytest.mark.parametrize(("tower_mm", "parts"), [(80, 2), (99, 0)])
    def test_what_has_nearly_the_whole_footprint_is_no_part(self, tower_mm: float, parts: int) -> None:
        """A tower on 64 % of the plate is one, a block with an edge of a cell all around is not."""
        assert len(list(slices(self.heap(tower_mm), 2 * MM, DEPTH))) == parts

    @pytest.mark.parametrize(("tower_mm", "parts"), [(4, 0), (6, 2)])
    def test_a_part_has_30_points(self, tower_mm: float, parts: int) -> None:
        """25 and 49, on a plate of 40 mm of whose points they are more than one in a hundred."""
        points = self.heap(tower_mm)
        points = points[np.abs(points[:, :2]).max(axis=1) < 20.5 * MM]
        assert len(list(slices(points, 2 * MM, DEPTH))) == parts

    def test_the_next_level_is_a_centimetre_higher(self) -> None:
        low, high = slices(self.heap(), 2 * MM, DEPTH)
        assert high.level_m - low.level_m == pytest.approx(10 * MM)

    def test_no_level_is_so_high_that_the_pads_would_not_hold(self) -> None:
        levels = [piece.level_m for piece in slices(self.heap() * [1, 1, 0.55], 2 * MM, DEPTH)]  # 44 mm
        assert max(levels) == pytest.approx(34 * MM)
        assert len(list(slices(self.heap() * [1, 1, 0.5], 2 * MM, DEPTH))) == 1

    @pytest.mark.parametrize(("spikes", "top_mm"), [(5, 50), (20, 90)])
    def test_a_few_high_points_are_no_top(self, spikes: int, top_mm: float) -> None:
        heights = np.concatenate([np.full(1000 - spikes, 50 * MM), np.full(spikes, 90 * MM)])
        assert top_of(heights) == pytest.approx(top_mm * MM)


def test_the_whole_comes_first_with_all_points_from_the_lowest_tip_on() -> None:
    cloud = on_table(BAR)
    whole = whole_of(cloud)
    assert len(whole.points) == len(cloud.points)
    assert around(whole).level_m == DEPTH.table_clearance_m


class TestMaps:
    """Of a bar 40 mm high on the table."""

    @pytest.mark.parametrize(("pitch_mm", "cell_mm"), [(0.8, 2), (3, 6)])
    def test_cells_are_two_steps_between_points_and_2_mm_at_least(self, pitch_mm: float, cell_mm: float) -> None:
        """The sixth neighbour of a point at the edge is so far away."""
        cells = around(whole_of(on_table(BAR, pitch_m=pitch_mm * MM))).maps.highest
        assert cells.cell_m == pytest.approx(cell_mm * MM, rel=0.01)

    def test_those_of_a_rod_are_no_larger(self) -> None:
        """Of two rows of few points the sixth neighbour lies far along them; the table's points tell the spacing."""
        rod = on_table(bar(0.1, 0.004, 0.008), pitch_m=2 * MM)
        few = replace(rod, points=rod.points[np.lexsort(rod.points.T[:1])][::3])
        assert around(whole_of(few)).maps.highest.cell_m == pytest.approx(4 * MM, rel=0.01)

    def test_what_a_finger_can_meet_8_cm_beside_the_object_is_on_the_map(self) -> None:
        def post(x: FloatArray, y: FloatArray) -> FloatArray:
            return np.where((np.abs(x) < 0.01) & (np.abs(y - 0.11) < 0.01), 0.05, 0.0)

        place = whole_of(on_table(BAR, others=post))
        local = place.frame.to_local(np.array([[0.0, 0.11, 0.0], [0.0, 0.09, 0.0]]))
        for chart in (around(place).maps.rest, around(place).maps.highest):
            assert chart.over(*local[:, :2].T).tolist() == pytest.approx([0.05, 0.0])

    def test_behind_an_object_is_hidden_and_beside_it_is_not(self) -> None:
        """Pixels are small enough to tell the space 6 mm beside an edge, and large enough to have no gaps.

        The bar's points are scattered: where they are sparse, six neighbours are 2.6 mm away.
        """
        cloud = on_table(BAR, sensor=(0.0, -0.8, 0.6))
        x, y = np.random.default_rng(0).uniform([-0.05, -0.02], [0.05, 0.02], (2000, 2)).T
        view = around(whole_of(replace(cloud, points=np.column_stack([x, y, np.full(2000, 0.04)])))).view
        along, across = np.linspace(-0.045, 0.045, 200), np.linspace(-0.02, 0.02, 200)
        assert view.hides(np.stack([along, np.full(200, 0.03), np.full(200, 0.02)]), 6 * MM).all()
        assert not view.hides(np.stack([along, np.full(200, 0.018), np.full(200, 0.046)]), 6 * MM).any()
        assert not view.hides(np.stack([np.full(200, 0.057), across, np.full(200, 0.01)]), 6 * MM).any()


class TestHanging:
    """A small thing in the air, seen obliquely."""

    @staticmethod
    def hangs_at(low_m: float, size_m: float = 0.02, below: FloatArray | None = None) -> float:
        own = block_of((size_m, 0.002, 0.01), (0.0, 0.0, low_m + 0.005), 1 * MM)
        others = np.empty((0, 3)) if below is None else below
        table = on_table(bar(0.01, 0.01, 0.1), sensor=(0.0, -0.7, 0.7))
        cloud = replace(table, points=own, obstacles=others, toward=np.array([0.0, -0.7, 0.7]))
        return hanging_m(whole_of(cloud))

    @staticmethod
    def screen(x_m: tuple[float, float], hidden_m: tuple[float, float]) -> FloatArray:
        """Points of an upright screen 8 mm before what it hides of the space below the thing, from one to another."""
        size = x_m[1] - x_m[0], 0.002, hidden_m[1] - hidden_m[0]
        return block_of(size, (0.5 * sum(x_m), -0.008, 0.008 + 0.5 * sum(hidden_m)), 0.5 * MM)

    @pytest.mark.parametrize(("low_m", "hangs"), [(0.008, False), (0.02, True), (0.08, True)])
    def test_what_has_room_for_a_finger_under_it_does(self, low_m: float, hangs: bool) -> None:
        """Lower it may stand on what was not seen."""
        assert self.hangs_at(low_m) == pytest.approx(low_m if hangs else 0.0)

    @pytest.mark.parametrize(("size_m", "hangs"), [(0.03, True), (0.06, False)])
    def test_what_is_larger_than_4_cm_does_not(self, size_m: float, hangs: bool) -> None:
        assert (self.hangs_at(0.08, size_m) > 0) == hangs

    @pytest.mark.parametrize(
        ("hidden_mm", "hangs"), [((0, 15), True), ((15, 25), True), ((35, 45), False), ((60, 70), True)]
    )
    def test_free_space_is_looked_for_halfway_down(self, hidden_mm: tuple[float, float], hangs: bool) -> None:
        """Of 80 mm."""
        screen = self.screen((-0.015, 0.015), (hidden_mm[0] * MM, hidden_mm[1] * MM))
        assert (self.hangs_at(0.08, below=screen) > 0) == hangs

    @pytest.mark.parametrize(("covered", "hangs"), [(0.25, True), (0.65, False)])
    def test_half_of_it_is_enough(self, covered: float, hangs: bool) -> None:
        screen = self.screen((-0.01, -0.01 + 0.02 * covered), (0.0, 0.06))
        assert (self.hangs_at(0.08, below=screen) > 0) == hangs


def test_hardly_a_pixel_is_empty_where_there_is_a_surface() -> None:
    """The top of a box, on which points lie as they fall: within a cell of 19 of 20 there are six others.

    That is 10.5 in a circle on average, so a pixel of one cell would be empty with e^−3.3, one in thirty.
    """
    cloud, rng = on_table(bar(0.12, 0.08, 0.04)), np.random.default_rng(0)
    scattered = np.column_stack([rng.uniform(-0.06, 0.06, 9000), rng.uniform(-0.04, 0.04, 9000), np.full(9000, 0.04)])
    image = around(whole_of(replace(cloud, points=scattered, floor=None))).view.image
    assert image is not None
    inside = np.isfinite(image.ranges)[3:-3, 3:-3]
    assert inside.size > 500
    assert inside.mean() > 0.99


@pytest.mark.parametrize("preshape_m", [0.18, 0.25])
def test_fingers_that_come_down_far_beside_an_object_meet_what_is_there(preshape_m: float) -> None:
    """A hand that opens by 60 cm, and a can; beside it, 18 cm from its side and farther, walls are as high as it."""
    can = Tube((0.0, 0.0, 0.025), 0.03, 0.05)
    around_it = [Box((side * 0.24, 0.0, 0.025), (0.06, 0.54, 0.05)) for side in (1, -1)]
    around_it += [Box((0.0, side * 0.24, 0.025), (0.42, 0.06, 0.05)) for side in (1, -1)]
    wide = load_gripper("pr2").model_copy(update={"max_opening_m": 0.6, "palm_m": 0.6})
    settings = load_settings("default", (f"hand.preshape_m={preshape_m}", "approach.directions=top"))
    cloud = Camera(distance=1.2, pixels=(400, 300), focal=420.0).sees(TABLE, can, *around_it)
    found = (grasp for item in plan(cloud, wide, settings).objects for grasp in item.grasps)
    best = next(grasp for grasp in found if float(np.hypot(*grasp.position[:2])) < 0.02)
    assert min(distance(wall, hand_in(best, wide)).min() for wall in around_it) > 0
