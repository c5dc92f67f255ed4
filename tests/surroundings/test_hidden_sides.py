"""What fingers do at sides that the sensor did not see, and over an object alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, load_settings
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Cloud, ObjectPlan
from flatgrasp_cli.planning import plan_object
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.scene import segment
from tests.conftest import MM, TABLE, Box, Camera, Tube, holds
from tests.surroundings.on_a_table import ABOVE, BLOCK, DEPTH, HAND, KINECT, best, planned, seen


class TestHiddenSides:
    @pytest.mark.parametrize("radius", [0.02, 0.025, 0.033])
    def test_the_opening_clears_a_lying_can_whose_far_flank_is_hidden(self, radius: float, pr2: Gripper) -> None:
        can = Tube((0.0, 0.0, radius), radius, 0.14, (1.0, 0.0, 0.0))
        grasp = seen(pr2, can, camera=KINECT)
        low, high = (grasp.position[1] + sign * grasp.opening_m / 2 for sign in (-1, 1))
        assert abs(axes_from_quaternion(grasp.orientation)[1, 1]) > 0.98
        assert low < -radius - HAND.clearance_m
        assert high > radius

    @pytest.mark.parametrize("radius", [0.02, 0.025])
    def test_the_contact_is_where_the_flank_ends_in_the_mean(self, radius: float, pr2: Gripper) -> None:
        grasp = seen(pr2, Tube((0.0, 0.0, radius), radius, 0.14, (1.0, 0.0, 0.0)), camera=KINECT)
        assert grasp.hidden_m > 10 * MM
        assert grasp.contacts[:, 1] == pytest.approx([-radius, radius], abs=3 * MM)
        assert grasp.width_m == pytest.approx(2 * radius, abs=3 * MM)

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
        assert result.objects[0].rejection.stage == "unseen"
        assert "hidden" in str(result.reason)

    def test_what_may_stand_unseen_makes_a_grasp_less_sure_unless_it_is_ignored(self, pr2: Gripper) -> None:
        cloud = KINECT.sees(TABLE, Box((0.0, 0.0, 0.025), (0.12, 0.05, 0.05)))
        ranked, ignored, free = (
            holds(best(planned(cloud, pr2, f"depth.unseen={unseen}", f"uncertainty.occupied_share={share}")))
            for unseen, share in (("rank", 0.5), ("ignore", 0.5), ("rank", 0))
        )
        assert ranked < ignored - 0.1
        assert ignored == pytest.approx(free, abs=1e-9)

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
