"""How wide fingers open over a table, what hangs in their way, and a search for any collision."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flatgrasp_cli import load_gripper
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.profiles import Gripper
from tests.conftest import MM, TABLE, Box, Camera, Solid, Tube
from tests.surroundings.on_a_table import ABOVE, BLOCK, DEPTH, HAND, KINECT, SLACK_M, best, planned, struck


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
        grasp = best(planned(ABOVE.sees(TABLE, free, step), pr2, "scene.select=[0,0]"))
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
