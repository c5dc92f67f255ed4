"""Things that touch, lie on each other or in a bin, or are cut off; the table's top is z = 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_settings, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, ImageGrid, ObjectPlan, Scene
from flatgrasp_cli.planning import plan_object, scenes
from flatgrasp_cli.scene import segment
from flatgrasp_cli.scene.parting.pieces import fitting_cell_m
from flatgrasp_cli.sensor import located
from tests.conftest import MM, TABLE, Box, Camera, Solid, Tube

ABOVE, OBLIQUE = Camera(tilt_deg=10), Camera(tilt_deg=40)


def scene_of(cloud: Cloud, *overrides: str) -> Scene:
    settings = load_settings("default", tuple(f"scene.{text}" for text in overrides)).scene
    return segment(located(cloud, settings.up, 0), settings, 0)


def assert_each_is_one(scene: Scene, solids: Sequence[Solid], least: float = 0.95) -> None:
    """Each solid is one object: nearly all points of an object lie on one, and of each solid on one object."""
    assert len(scene.objects) == len(solids)
    owners = [np.argmin([distance(solid, item.points) for solid in solids], axis=0) for item in scene.objects]
    main = [int(np.argmax(np.bincount(owner))) for owner in owners]
    assert sorted(main) == list(range(len(solids)))
    for owner, solid in zip(owners, main, strict=True):
        assert np.mean(owner == solid) >= least


def distance(solid: Solid, points: FloatArray) -> FloatArray:
    """How far (n,) points lie outside of a solid, or inside it, roughly."""
    if isinstance(solid, Box):
        turn = np.radians(solid.yaw_deg)
        c, s = np.cos(turn), np.sin(turn)
        local = (points - np.array(solid.center)) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        return np.asarray(np.linalg.norm(np.maximum(np.abs(local) - 0.5 * np.array(solid.size), 0.0), axis=1))
    axis = np.array(solid.axis) / np.linalg.norm(solid.axis)
    local = points - np.array(solid.center)
    along = local @ axis
    across = np.linalg.norm(local - along[:, None] * axis, axis=1)
    return np.asarray(np.hypot(np.maximum(across - solid.radius, 0), np.maximum(abs(along) - solid.length / 2, 0)))


LOW_BOX = Box((-0.041, 0.03, 0.02), (0.08, 0.10, 0.04))
HIGH_BOX = Box((0.041, 0.0, 0.035), (0.08, 0.10, 0.07))
ON_IT = Box((-0.055, 0.035, 0.065), (0.05, 0.06, 0.05), 15)
LEANING = Tube((0.10, 0.0, 0.055), 0.02, 0.16, (-0.55, 0.0, 0.8))
CANS = (*(Tube((x, y, 0.033), 0.033, 0.12, (0.0, 1.0, 0.0)) for x, y in ((-0.066, 0.0), (0.0, 0.03), (0.066, 0.0))),)


class TestTouching:
    @pytest.mark.parametrize("noise", [0.5 * MM, 1.7 * MM])
    @pytest.mark.parametrize(
        ("camera", "solids"),
        [
            (ABOVE, (LOW_BOX, HIGH_BOX)),
            (OBLIQUE, (LOW_BOX, HIGH_BOX)),
            (OBLIQUE, (LOW_BOX, HIGH_BOX, ON_IT)),
            (OBLIQUE, CANS),
            (OBLIQUE, (HIGH_BOX, LEANING)),
        ],
        ids=["side by side", "side by side, obliquely", "one on two", "three cans that lie", "one leans"],
    )
    def test_things_that_touch_are_told_apart(self, camera: Camera, solids: tuple[Solid, ...], noise: float) -> None:
        scene = scene_of(camera.sees(TABLE, *solids, noise_m=noise))
        assert_each_is_one(scene, solids, 0.9)
        assert {item.group for item in scene.objects} == {0}

    def test_a_bend_that_nobody_asks_for_parts_nothing(self) -> None:
        scene = scene_of(OBLIQUE.sees(TABLE, *CANS), "seam_deg=180")
        assert len(scene.objects) == 1
        assert scene.objects[0].group is None

    @pytest.mark.parametrize("tilt", [0, 20, 40])
    @pytest.mark.parametrize(
        "solid",
        [
            Box((0.0, 0.0, 0.05), (0.2, 0.12, 0.1), 30),
            Tube((0.0, 0.0, 0.04), 0.04, 0.2, (1.0, 0.4, 0.0)),
            Tube((0.0, 0.0, 0.05), 0.04, 0.1),
        ],
    )
    def test_one_convex_thing_stays_one(self, solid: Solid, tilt: float) -> None:
        assert len(scene_of(Camera(tilt_deg=tilt).sees(TABLE, solid, noise_m=1.7 * MM)).objects) == 1

    def test_a_knob_narrower_than_a_part_is_no_object(self) -> None:
        plate, knob = Box((0.0, 0.0, 0.01), (0.14, 0.12, 0.02)), Box((0.03, 0.0, 0.035), (0.02, 0.02, 0.03))
        assert len(scene_of(ABOVE.sees(TABLE, plate, knob)).objects) == 1
        assert len(scene_of(ABOVE.sees(TABLE, plate, knob), "least_part_m=0.012").objects) == 2

    @pytest.mark.parametrize(("neck_mm", "count"), [(25, 1), (50, 1), (80, 2)])
    def test_what_a_neck_joins_is_one_thing(self, neck_mm: float, count: int) -> None:
        """A narrow bar, or a wide one, ends at the side of a box: a handle, or another thing."""
        box = Box((0.0, 0.0, 0.02), (0.08, 0.10, 0.04))
        handle = Box((0.10, 0.0, 0.013), (0.118, neck_mm * MM, 0.026))
        assert len(scene_of(Camera(tilt_deg=20).sees(TABLE, box, handle)).objects) == count

    def test_a_long_heap_is_no_furniture(self) -> None:
        heights = (0.05, 0.08, 0.04, 0.07, 0.05)
        row = tuple(Box((0.09 * k - 0.18, 0.02 * (k % 2), h / 2), (0.088, 0.08, h)) for k, h in enumerate(heights))
        scene = scene_of(OBLIQUE.sees(TABLE, *row), "max_size_m=0.3", "mode=table")
        assert_each_is_one(scene, row, 0.85)
        assert scene.wholes == ()  # half a metre is no single thing

    def test_cells_grow_with_noise_until_normals_are_sure(self) -> None:
        """σ = 1.7 mm, points 2 mm apart: slopes through 3 × 3 cells scatter by 25°/4/√2 in cells of 4.2 mm."""
        cell_m = fitting_cell_m(2 * MM, 1.7 * MM, 25)
        slope = 1.7 * MM * 2 * MM / (np.sqrt(6) * cell_m**2)
        assert np.degrees(4 * np.sqrt(2) * slope) == pytest.approx(25)

    def test_no_grasp_straddles_two(self) -> None:
        found = plan(OBLIQUE.sees(TABLE, LOW_BOX, HIGH_BOX), load_gripper("robotiq_2f_140"))
        assert len(found.objects) == 2
        for item in found.objects:
            assert item.grasps
            for grasp in item.grasps:
                x = grasp.contacts[:, 0]
                assert (x < 8 * MM).all() or (x > -8 * MM).all()

    def test_pieces_that_none_can_grasp_alone_are_planned_as_one(self, monkeypatch: pytest.MonkeyPatch) -> None:
        real = plan_object

        def only_wholes(item: object, *rest: object) -> ObjectPlan:
            found: ObjectPlan = real(item, *rest)  # type: ignore[arg-type]
            return found if len(found.object.points) > most else replace(found, grasps=())

        cloud = OBLIQUE.sees(TABLE, LOW_BOX, HIGH_BOX)
        most = max(len(item.points) for item in scene_of(cloud).objects)
        monkeypatch.setattr(scenes, "plan_object", only_wholes)
        (whole,) = plan(cloud, load_gripper("robotiq_2f_140")).objects
        assert len(whole.object.points) > most
        assert whole.grasps


def walls(height: float, inner: float = 0.36, thick: float = 0.01) -> tuple[Box, ...]:
    """Those of a square bin about the origin, without a floor of its own."""
    off, long = 0.5 * (inner + thick), inner + 2 * thick
    return (
        *(Box((x * off, 0.0, height / 2), (thick, long, height)) for x in (-1, 1)),
        *(Box((0.0, y * off, height / 2), (long, thick, height)) for y in (-1, 1)),
    )


WIDE = Camera(tilt_deg=15, distance=0.9)
THINGS = (Box((-0.08, 0.02, 0.02), (0.08, 0.05, 0.04), 20), Tube((0.05, -0.06, 0.04), 0.03, 0.08))
AT_WALL = Box((0.145, 0.06, 0.03), (0.07, 0.09, 0.06))


class TestContainer:
    def test_a_bin_is_no_object_and_what_lies_in_it_is(self) -> None:
        scene = scene_of(WIDE.sees(TABLE, *walls(0.12), *THINGS, AT_WALL))
        assert_each_is_one(scene, (*THINGS, AT_WALL), 0.9)
        assert np.mean(np.abs(scene.container[:, :2]).max(axis=1) > 0.17) > 0.98

    def test_a_low_thing_near_a_wall_is_found_among_the_floors_ripple(self) -> None:
        phone = Box((-0.142, 0.05, 0.012), (0.05, 0.11, 0.024))
        scene = scene_of(WIDE.sees(TABLE, *walls(0.12), phone, noise_m=1.2 * MM))
        assert_each_is_one(scene, (phone,), 0.9)

    def test_what_is_seen_of_a_wall_right_behind_a_thing_is_the_walls(self) -> None:
        thing = Box((0.02, 0.14, 0.015), (0.10, 0.06, 0.03), -20)
        cloud = Camera(tilt_deg=30, distance=0.9).sees(TABLE, *walls(0.12), thing, noise_m=1.2 * MM)
        (found,) = scene_of(cloud).objects
        assert np.mean(distance(thing, found.points) > 6 * MM) < 0.005

    def test_its_walls_are_solid_down_to_the_floor_outside_too(self) -> None:
        scene = scene_of(WIDE.sees(TABLE, *walls(0.12), *THINGS))
        obstacles = scene.objects[0].obstacles
        on_side = obstacles[np.abs(obstacles[:, 0] - -0.185) < 8 * MM]
        assert on_side[:, 2].min() < 0.011
        assert on_side[:, 2].max() == pytest.approx(0.12, abs=5 * MM)

    def test_things_in_a_bin_are_grasped_within_its_walls(self) -> None:
        found = plan(WIDE.sees(TABLE, *walls(0.10), *THINGS), load_gripper("pr2"))
        assert [bool(item.grasps) for item in found.objects] == [True, True]
        assert all(np.abs(item.grasps[0].position[:2]).max() < 0.18 for item in found.objects)

    def test_a_bin_whose_floor_is_hidden_is_one_too(self) -> None:
        """Boxes side by side cover it all but for the gaps along the walls."""
        boxes = tuple(
            Box((x, y, h / 2), (0.11, 0.11, h))
            for (x, y), h in zip(
                [(0.115 * i, 0.115 * j) for i in (-1, 0, 1) for j in (-1, 0, 1)],
                (0.05, 0.07, 0.055, 0.075, 0.05, 0.07, 0.05, 0.07, 0.05),
                strict=True,
            )
        )
        scene = scene_of(WIDE.sees(TABLE, *walls(0.13), *boxes))
        assert len(scene.container) > 1000
        assert len(scene.objects) >= 7
        for item in scene.objects:
            assert np.abs(item.points[:, :2]).max() < 0.182

    def test_crop_to_the_inside_works(self) -> None:
        cloud = WIDE.sees(TABLE, *walls(0.12), *THINGS)
        scene = scene_of(cloud, "crop=[-0.17,0.17,-0.17,0.17,-0.1,0.5]", "mode=bin")
        assert_each_is_one(scene, THINGS, 0.9)

    def test_a_small_tray_is_a_container_where_somebody_says_so(self) -> None:
        tray, thing = walls(0.03, 0.2), Box((0.0, 0.0, 0.01), (0.05, 0.03, 0.02))
        cloud = ABOVE.sees(TABLE, *tray, thing)
        assert len(scene_of(cloud).container) == 0
        scene = scene_of(cloud, "mode=bin")
        assert len(scene.container) > 100
        assert_each_is_one(scene, (thing,))

    @pytest.mark.parametrize(
        "solids",
        [
            (Tube((0.0, 0.0, 0.02), 0.12, 0.04, bore=0.11, floor=0.003),),  # a pan
            (Box((-0.1, 0.0, 0.03), (0.06, 0.2, 0.06)), Box((0.1, 0.0, 0.03), (0.06, 0.2, 0.06))),
            walls(0.05, 0.3)[:3],  # open to one side
        ],
        ids=["pan", "two boxes", "three walls"],
    )
    def test_what_holds_no_water_or_little_is_none(self, solids: tuple[Solid, ...]) -> None:
        thing = Box((0.0, 0.0, 0.03), (0.04, 0.04, 0.06))
        assert len(scene_of(WIDE.sees(TABLE, *solids, thing)).container) == 0


class TestCutOff:
    def pictured(self, camera: Camera, *solids: Solid) -> Cloud:
        cloud = camera.sees(TABLE, *solids)
        columns, rows = camera.pixels
        assert len(cloud.points) == rows * columns, "the table fills the picture"
        return replace(cloud, pixels=ImageGrid((rows, columns), np.ones(rows * columns, dtype=np.bool_)))

    NEAR = Camera(distance=0.6)
    EDGE = Box((0.20, 0.0, 0.02), (0.06, 0.05, 0.04))
    WHOLE = Box((-0.05, 0.0, 0.02), (0.08, 0.05, 0.04))

    @pytest.mark.parametrize("organised", [True, False])
    def test_what_the_pictures_edge_cuts_is_marked_and_last(self, organised: bool) -> None:
        cloud = self.pictured(self.NEAR, self.EDGE, self.WHOLE)
        found = plan(cloud if organised else replace(cloud, pixels=None), load_gripper("pr2"))
        assert [item.object.cut_off for item in found.objects] in ([False], [False, True])
        assert found.objects[0].object.points[:, 0].mean() == pytest.approx(-0.05, abs=0.01)

    @pytest.mark.parametrize(("x", "at_edge"), [(0.38, False), (0.43, True)])
    def test_what_lies_within_3_cm_of_the_tables_edge_is_marked_and_last(self, x: float, at_edge: bool) -> None:
        """The table ends at 0.45 m. The object there is the easier one: lower, and as wide."""
        low = Box((x, 0.0, 0.015), (0.03, 0.05, 0.03))
        cloud = Camera(distance=1.2, pixels=(400, 300), focal=400.0).sees(TABLE, low, self.WHOLE)
        found = plan(cloud, load_gripper("pr2"))
        assert sorted(item.object.at_edge for item in found.objects) == [False, at_edge]
        assert not found.objects[0].object.at_edge

    def test_the_end_of_a_crop_is_not_the_pictures(self) -> None:
        cloud = self.pictured(self.NEAR, self.WHOLE)
        scene = scene_of(cloud, "crop=[-0.12,0.02,-0.1,0.1,-0.1,0.1]", "mode=table")
        assert [item.cut_off for item in scene.objects] == [False]
