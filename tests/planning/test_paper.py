"""The paper to the letter grasps the paper's own objects, as its figure 17 shows for the bear."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_settings, plan, read_clouds
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.profiles import list_profiles
from tests.conftest import SAMPLES, planned_sample

OBJECTS = ("teddy_bear", "electric_drill", "pistol", "spray_bottle", "pan", "hammer", "juice_box")


@pytest.mark.parametrize("gripper", ["lacquey", "pr2"])
@pytest.mark.parametrize("name", OBJECTS)
def test_all_of_the_papers_objects_are_grasped(name: str, gripper: str) -> None:
    assert planned_sample(name, gripper, "paper").best is not None


def test_the_bear_is_grasped_across_its_body() -> None:
    """Fig. 17: a few grasps are left, and the best one holds the body beside the centre of gravity."""
    (bear,) = planned_sample("teddy_bear", "lacquey", "paper").objects
    left = {stage.stage: stage.kept for stage in bear.funnel}
    assert 3 <= left["operability"] <= 10
    best = bear.grasps[0]
    assert 0.080 <= best.width_m <= 0.095
    assert best.gravity_distance_m == min(grasp.gravity_distance_m for grasp in bear.grasps)
    box = bear.box
    assert box is not None
    closing = axes_from_quaternion(best.orientation)[1]
    assert abs(closing @ box.frame.axes[1]) > np.cos(np.radians(10))  # square to the bear's long axis


def test_with_the_palms_width_nothing_of_the_bear_is_left() -> None:
    """Why the paper's w_h must be that of the fingers."""
    palm = load_gripper("lacquey").model_copy(update={"paper_hand_width_m": 0.092})
    cloud = next(read_clouds(SAMPLES / "teddy_bear.pcd"))
    assert plan(cloud, palm, load_settings("paper")).best is None


@pytest.mark.parametrize("name", list_profiles("gripper"))
def test_in_the_papers_symbols_every_hand_has_two_equal_fingers(name: str) -> None:
    gripper = load_gripper(name)
    symbols = gripper.in_the_papers_symbols()
    assert symbols.jaws == ((0.0,), (0.0,))
    assert symbols.finger_width_m == symbols.hand_width_m
    same = {"jaws", "finger_width_m", "hand_width_m"}
    assert symbols.model_dump(exclude=same) == gripper.model_dump(exclude=same)
    if name == "lacquey":  # a thumb of 10 mm against a pair of 50.2 mm
        assert symbols.finger_width_m == pytest.approx(0.0301)
    else:
        assert symbols.finger_width_m == gripper.finger_width_m


def test_the_profile_may_state_the_papers_symbols() -> None:
    stated = {"paper_finger_width_m": 0.02, "paper_hand_width_m": 0.025}
    symbols = load_gripper("lacquey").model_copy(update=stated).in_the_papers_symbols()
    assert (symbols.finger_width_m, symbols.hand_width_m) == (0.02, 0.025)


def test_the_default_plans_for_the_hand_as_it_is() -> None:
    assert planned_sample("juice_box", "lacquey").gripper == load_gripper("lacquey")
    assert planned_sample("juice_box", "lacquey", "paper").gripper == load_gripper("lacquey").in_the_papers_symbols()
