"""Pieces that are parts of a thing, and ripples that are none; the table's top is z = 0."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, Source
from tests.conftest import MM, TABLE, Box, Camera, Solid, Tube
from tests.scene.test_heaps import assert_each_is_one, distance, scene_of

KINECT = Camera(tilt_deg=40, pixels=(400, 300), focal=525.0)
BODY = Box((0.0, 0.0, 0.045), (0.08, 0.08, 0.09))


class TestParts:
    @pytest.mark.parametrize("tilt", [15, 30, 45])
    def test_what_hangs_at_a_side_is_a_part(self, tilt: float) -> None:
        """A bar as wide as a thing, 4 cm up in the air, whose lower edge is seen, can only be held by the box."""
        bar = Box((0.09, 0.0, 0.06), (0.1, 0.05, 0.04))
        assert len(scene_of(Camera(tilt_deg=tilt).sees(TABLE, BODY, bar)).objects) == 1

    @pytest.mark.parametrize("tilt", [15, 30, 45])
    def test_what_lies_on_the_table_is_none(self, tilt: float) -> None:
        bar = Box((0.09, 0.0, 0.02), (0.1, 0.05, 0.04))
        assert_each_is_one(scene_of(replace(KINECT, tilt_deg=tilt).sees(TABLE, BODY, bar)), (BODY, bar), 0.9)

    @pytest.mark.parametrize("thick_mm", [15, 30])
    def test_nor_is_what_lies_on_something(self, thick_mm: float) -> None:
        plate = Box((0.0, 0.0, 0.02), (0.14, 0.12, 0.04))
        lid = Box((0.0, 0.0, 0.04 + 0.5 * thick_mm * MM), (0.07, 0.06, thick_mm * MM))
        assert_each_is_one(scene_of(KINECT.sees(TABLE, plate, lid)), (plate, lid), 0.9)

    @pytest.mark.parametrize(
        "hollow",
        [
            Tube((0.0, 0.0, 0.05), 0.045, 0.1, bore=0.038, floor=0.004),
            Tube((0.0, 0.0, 0.02), 0.09, 0.04, bore=0.08, floor=0.004),
        ],
        ids=["mug", "pan"],
    )
    @pytest.mark.parametrize("tilt", [5, 25, 45])
    def test_the_inside_of_a_hollow_thing_is_a_part_of_it(self, hollow: Solid, tilt: float) -> None:
        assert len(scene_of(Camera(tilt_deg=tilt).sees(TABLE, hollow)).objects) == 1

    def test_what_stands_in_a_hollow_thing_is_none(self) -> None:
        pan = Tube((0.0, 0.0, 0.02), 0.09, 0.04, bore=0.08, floor=0.004)
        block = Box((0.0, 0.0, 0.034), (0.06, 0.06, 0.06))
        objects = scene_of(Camera(tilt_deg=20).sees(TABLE, pan, block)).objects
        off = [np.mean(distance(block, item.points) > 2 * MM) for item in objects]
        assert sorted(share > 0.1 for share in off)[:2] == [False, True]

    def drill(self, scale: float) -> tuple[Box, ...]:
        """A body, a handle and a battery on a table, 26 by 20 cm if the scale is 1; the handle is 30 by 40 mm thick."""
        sizes = ((0.26, 0.06, 0.05), (0.03, 0.10, 0.04), (0.10, 0.045, 0.05))
        places = ((0.0, 0.0, 0.025), (-0.04, -0.08, 0.02), (-0.04, -0.1475, 0.025))
        return tuple(
            Box((scale * x, scale * y, z), (scale * long if long > 0.05 else long, scale * wide, high))
            for (x, y, z), (long, wide, high) in zip(places, sizes, strict=True)
        )

    @pytest.mark.parametrize("tilt", [10, 20, 30])
    def test_what_a_handle_joins_is_one_thing(self, tilt: float) -> None:
        """Of a handle the top and one side are seen: together they are twice as wide as it is thick."""
        assert len(scene_of(Camera(tilt_deg=tilt).sees(TABLE, *self.drill(1.0))).objects) == 1

    def test_unless_it_is_longer_than_tools_are(self) -> None:
        assert len(scene_of(Camera(tilt_deg=20).sees(TABLE, *self.drill(1.6))).objects) > 1


def rippled(cloud: Cloud, middle: tuple[float, float], size_m: float, height_m: float) -> Cloud:
    """The cloud with all points of the table in a square lifted by a height."""
    points: FloatArray = cloud.points.copy()
    inside = (np.abs(points[:, :2] - middle) < 0.5 * size_m).all(axis=1) & (points[:, 2] < 0.02)
    assert inside.sum() >= 30
    points[inside, 2] += height_m
    return Cloud(points, cloud.viewpoint, Source("test"))


class TestRipples:
    FAR = Camera(tilt_deg=60, distance=1.1)

    @pytest.mark.parametrize(("y", "count"), [(0.22, 1), (-0.22, 2)])
    def test_what_is_no_higher_than_noise_is_there_is_no_object(self, y: float, count: int) -> None:
        """Lifted by 5 mm, a square of 5 cm is a thing where noise is 1.3 mm, and none where it is 2.5 mm."""
        seen = self.FAR.sees(TABLE, BODY, noise_m=2.2 * MM)
        assert len(scene_of(rippled(seen, (-0.15, y), 0.05, 5 * MM)).objects) == count

    @pytest.mark.parametrize(("x", "count"), [(0.01, 1), (0.12, 2)])
    def test_nor_is_a_ripple_beside_the_edge_of_something_nearer(self, x: float, count: int) -> None:
        """Behind a tall box the table's own edge is rippled; farther from it the same ripple is a thing."""
        tall = Box((-0.05, 0.0, 0.12), (0.1, 0.06, 0.24))
        seen = Camera(tilt_deg=35, pixels=(400, 300), focal=570.0).sees(TABLE, tall)
        assert len(scene_of(rippled(seen, (x, 0.12), 0.016, 9 * MM)).objects) == count


class TestColours:
    LEFT, RIGHT = Box((-0.04, 0.0, 0.03), (0.08, 0.10, 0.06)), Box((0.04, 0.0, 0.03), (0.08, 0.10, 0.06))

    def flush(self, other: tuple[int, int, int]) -> Cloud:
        """Two boxes whose tops and fronts are flush, a brown one and one in another colour, unevenly lit."""
        cloud = KINECT.sees(TABLE, self.LEFT, self.RIGHT)
        light = np.random.default_rng(0).uniform(0.8, 1.0, len(cloud.points))
        colors = np.where(cloud.points[:, :1] < 0, (120, 80, 50), other) * light[:, None]
        return replace(cloud, colors=colors.astype(np.uint8))

    @pytest.mark.parametrize(("other", "count"), [((200, 30, 30), 2), ((84, 56, 35), 1)], ids=["red", "in shadow"])
    def test_flush_surfaces_are_parted_by_their_colours_if_that_is_asked_for(
        self, other: tuple[int, int, int], count: int
    ) -> None:
        assert len(scene_of(self.flush(other)).objects) == 1
        assert len(scene_of(self.flush(other), "seam_color=20").objects) == count
