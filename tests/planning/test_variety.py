"""Which of an object's grasps are listed: such that differ, by hand and by a slow twin."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_robot, load_settings, plan
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.ranking import TIE
from tests.conftest import EACH, MM, TABLE, Box, Camera, cloud_of, holds, rectangle, sampled

VARIETY = load_settings().variety


def alike(one: Grasp, other: Grasp) -> bool:
    """Whether two grasps are at about one place and turned alike."""
    near = np.linalg.norm(one.position - other.position) < VARIETY.apart_m
    cosine = abs(axes_from_quaternion(one.orientation)[1] @ axes_from_quaternion(other.orientation)[1])
    return bool(near and cosine > np.cos(np.radians(VARIETY.apart_deg)))


def test_of_a_bar_grasps_a_fingers_width_apart_are_listed(pr2: Gripper) -> None:
    """120 mm long: the pads of 22 mm leave 98 mm for their middle, room for four or five places 20 mm apart."""
    cloud = cloud_of(sampled(rectangle(120, 40)))
    grasps = plan(cloud, pr2).objects[0].grasps
    assert 4 <= len(grasps) <= 5
    assert not any(alike(one, other) for one, other in combinations(grasps, 2))
    assert np.ptp([grasp.position[0] for grasp in grasps]) > 60 * MM


def listed_and_all(*options: str) -> list[tuple[Grasp, ...]]:
    """The grasps of a bar that are listed, and all that there are."""
    cloud, settings = cloud_of(sampled(rectangle(120, 40))), ((), EACH)
    found = (
        plan(cloud, load_gripper("pr2"), load_settings("default", (*more, *options)), top=1000) for more in settings
    )
    return [result.objects[0].grasps for result in found]


def test_each_grasp_left_out_is_like_one_that_holds_as_probably() -> None:
    listed, every = listed_and_all()
    assert len(every) > 3 * len(listed)
    for grasp in every:
        assert max(holds(other) for other in listed if alike(grasp, other)) >= holds(grasp) - TIE


@pytest.mark.parametrize("options", [("ranking.prefer=cage",), ("ranking.prefer=gravity_distance",)])
def test_each_grasp_left_out_is_like_a_better_one(options: tuple[str, ...]) -> None:
    listed, every = listed_and_all(*options)
    assert len(every) > 3 * len(listed)
    slow: list[Grasp] = []
    for grasp in every:
        if not any(alike(grasp, better) for better in slow):
            slow.append(grasp)
    assert [grasp.fingers for grasp in listed] == [grasp.fingers for grasp in slow]


def test_a_robot_has_a_real_second_choice(pr2: Gripper) -> None:
    """What it reaches differs, and so does what it is refused."""
    seen = Camera(tilt_deg=20, target=(0.85, 0.0, 0.0)).sees(
        Box((0.85, 0.0, -0.01), (0.5, 0.5, 0.02)), Box((0.85, 0.0, 0.02), (0.30, 0.04, 0.04))
    )
    robot: Robot = load_robot("ur5")
    (item,) = plan(seen, pr2, robot=robot).objects
    for grasps in (item.grasps, item.refused):
        assert len(grasps) > 1
        assert not any(alike(one, other) for one, other in combinations(grasps, 2))


def test_the_paper_lists_grasps_as_they_come(pr2: Gripper) -> None:
    grasps = plan(cloud_of(sampled(rectangle(120, 40))), pr2, load_settings("paper")).objects[0].grasps
    assert len(grasps) == 10
    assert any(alike(one, other) for one, other in combinations(grasps, 2))


def test_only_the_listed_ones_are_certified_and_all_of_them(pr2: Gripper) -> None:
    for item in plan(Camera().sees(TABLE, Box((0.0, 0.0, 0.02), (0.12, 0.04, 0.04))), pr2).objects:
        assert len(item.grasps) > 1
        assert all(grasp.cage is not None and grasp.closure is not None for grasp in item.grasps)
