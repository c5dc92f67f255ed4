"""What would help where there is no grasp: each remedy names an option with its number, and following it helps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli import Cloud, Plan, load_gripper, load_robot, load_settings, plan
from flatgrasp_cli.model import Rejection
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.document import to_document
from flatgrasp_cli.results.remedies import remedy_of
from flatgrasp_cli.results.table import refusal
from tests.conftest import TABLE, Box, Camera, Tube, cloud_of, disc, rectangle, sampled

CAMERA = Camera()


def words(result: Plan) -> str:
    """The remedy for what a plan says first; the same in the document and on stderr."""
    assert result.best is None
    remedy = remedy_of(result, result.objects[0] if result.objects else None)
    assert remedy is not None
    assert to_document(result)["remedy"] == remedy
    assert refusal(result)[1] == f"remedy: {remedy}"
    return remedy


def test_too_wide_names_the_gripper_that_opens_so_far() -> None:
    cloud = cloud_of(sampled(rectangle(200, 96)))
    remedy = words(plan(cloud, load_gripper("robotiq_2f_85")))
    assert remedy.endswith("mm are needed, robotiq_2f_85 opens 85 mm: --gripper onrobot_rg2 opens 104 mm")
    assert 100 <= int(remedy.split()[0]) <= 103
    assert plan(cloud, load_gripper("onrobot_rg2")).best is not None


def test_too_wide_for_all_names_the_widest() -> None:
    remedy = words(plan(cloud_of(sampled(rectangle(300, 300), pitch_mm=3)), load_gripper("pr2")))
    assert "robotiq_2f_140, the widest shipped gripper, 128 mm" in remedy
    assert "--scene table" in remedy


def test_in_millimetres_the_scale_is_named() -> None:
    plate = cloud_of(sampled(rectangle(120, 40)))
    assert "--scale 0.001" in words(plan(replace(plate, points=1000 * plate.points), load_gripper("pr2")))
    assert "--scale 0.001" in words(plan(replace(plate, points=50 * plate.points), load_gripper("pr2")))


def test_too_narrow_names_a_hand_that_closes(pr2: Gripper) -> None:
    hand = pr2.model_copy(update={"min_opening_m": 0.06})
    assert "closes to 0 mm" in words(plan(cloud_of(sampled(rectangle(50, 40))), hand))


def test_an_empty_crop_says_where_the_cloud_is(pr2: Gripper) -> None:
    cloud = CAMERA.sees(TABLE)
    remedy = words(plan(cloud, pr2, load_settings("default", ("scene.crop=[5,6,5,6,5,6]",))))
    low, high = cloud.points.min(axis=0), cloud.points.max(axis=0)
    assert f"x {low[0]:.3f} … {high[0]:.3f}, y {low[1]:.3f} … {high[1]:.3f}" in remedy


def test_an_empty_table_names_the_least_height_and_the_way_up(pr2: Gripper) -> None:
    remedy = words(plan(CAMERA.sees(TABLE), pr2, load_settings("default", ("scene.mode=table",))))
    assert "2 mm" in remedy
    assert "--up X,Y,Z" in remedy


def test_no_table_names_the_other_mode(pr2: Gripper) -> None:
    ball = np.random.default_rng(0).normal(size=(3000, 3))
    ball *= 0.1 / np.linalg.norm(ball, axis=1, keepdims=True)
    cloud = Cloud(ball, viewpoint=np.array([0, 0, 1.0]))
    remedy = words(plan(cloud, pr2, load_settings("default", ("scene.mode=table", "scene.min_plane_share=0.5"))))
    assert "--scene object" in remedy
    assert "50 %" in remedy


def test_friction_that_would_do_is_named(pr2: Gripper) -> None:
    hand = pr2.model_copy(update={"pad_friction": 0.01})
    result = plan(cloud_of(sampled(rectangle(120, 40))), hand)
    rejected = replace(result.objects[0], grasps=(), rejection=Rejection("torque_balance", "", 0.413, 0.01))
    assert str(remedy_of(result, rejected)).endswith("0.01 is assumed: --set balance.friction=0.42")
    rejected = replace(rejected, rejection=Rejection("force_balance", "", 30.0, np.degrees(np.arctan(0.01))))
    assert str(remedy_of(result, rejected)).endswith("--set balance.friction=0.58")  # tan 30°
    rejected = replace(rejected, rejection=Rejection("force_balance", "", 30.2, 20.0))
    assert remedy_of(result, rejected) == "--set balance.force_balance_max_deg=31 allows it"


def test_a_limit_that_the_flattest_pair_keeps_is_named_and_does(pr2: Gripper) -> None:
    cloud = cloud_of(sampled(disc(30)))
    strict = plan(cloud, pr2, load_settings("default", ("hand.variance_max_share=0.01",)))
    remedy = words(strict)
    assert remedy.startswith("--set hand.variance_max_share=0.0")
    named = remedy.split()[1].removeprefix("hand.")
    assert plan(cloud, pr2, load_settings("default", (f"hand.{named}",))).best is not None


def test_an_arm_that_reaches_is_named(pr2: Gripper) -> None:
    block = Box((0.0, 0.0, 0.02), (0.1, 0.04, 0.04))
    seen = CAMERA.sees(TABLE, block)
    for away, robot, said in ((0.75, "ur3", "--robot ur5 reaches 0.85 m"), (3.0, "ur10", "is --camera-pose right?")):
        cloud = replace(seen, points=seen.points + np.array([away, 0.0, 0.0]), viewpoint=np.array([away, 0, 0.8]))
        down = load_settings("default", ("approach.directions=top",))
        assert words(plan(cloud, pr2, down, robot=load_robot(robot))).endswith(said)


def test_a_pen_of_a_few_points_is_grasped_or_too_coarse_for_its_outline(pr2: Gripper) -> None:
    camera = Camera(tilt_deg=50, pixels=(320, 240), focal=200.0, distance=0.9)
    rod = Tube((0.0, 0.0, 0.004), 0.004, 0.14, (1.0, 0.3, 0.0))
    result = plan(camera.sees(TABLE, rod, noise_m=1e-3), pr2)
    (pen,) = result.objects
    assert pen.grasps[0].width_m == pytest.approx(0.008, abs=0.004)
    in_its_own_way = Rejection(stage="depth", reason="the fingers come down on the object itself", cause="itself")
    refused = replace(pen, grasps=(), rejection=in_its_own_way)
    assert "27 points some 5 mm apart" in str(remedy_of(result, refused))


@pytest.mark.parametrize(
    ("thickness_m", "height_m", "cause", "said"),
    [(0.030, 0.05, "neighbours", "take away what stands beside it"), (0.009, 0.14, "palm", "fingers of ")],
)
def test_what_keeps_the_hand_up_is_told_apart(
    thickness_m: float, height_m: float, cause: str, said: str, pr2: Gripper
) -> None:
    """A long low block between two long walls, 22 mm away: thick fingers meet them, or the palm does."""
    walls = [Box((0.0, y, 0.5 * height_m), (0.3, 0.02, height_m)) for y in (-0.047, 0.047)]
    cloud = Camera(distance=1.0).sees(TABLE, Box((0.0, 0.0, 0.0125), (0.2, 0.03, 0.025)), *walls)
    result = plan(cloud, pr2.model_copy(update={"finger_thickness_m": thickness_m}))
    block = next(item for item in result.objects if item.box and 0.15 < item.box.size[0] < 0.25)
    assert block.rejection is not None
    assert (block.rejection.stage, block.rejection.cause) == ("depth", cause)
    assert str(remedy_of(result, block)).startswith(said)


def test_what_stands_alone_has_no_neighbours(pr2: Gripper) -> None:
    """A high box from low down: fingers that come down on its own rear are told so."""
    grazing = Camera(tilt_deg=82, distance=0.7, target=(0.0, 0.0, 0.25))
    down = load_settings("default", ("approach.directions=top",))
    result = plan(grazing.sees(TABLE, Box((0.0, 0.0, 0.15), (0.14, 0.04, 0.3))), pr2, down)
    assert result.best is None
    assert "stands beside it" not in str(result.reason)


def test_a_hidden_way_names_the_share_that_allows_it(pr2: Gripper) -> None:
    rejection = Rejection("unseen", "13 % of the hand's way is hidden, allowed 10 %", value=0.128, limit=0.1)
    result = plan(CAMERA.sees(TABLE, Box((0.0, 0.0, 0.03), (0.1, 0.04, 0.06))), pr2)
    item = replace(result.objects[0], grasps=(), rejection=rejection)
    assert "--set approach.hidden_share=0.13 allows as much" in str(remedy_of(result, item))
    strict = replace(result, settings=load_settings("default", ("depth.unseen=refuse",)))
    assert "--set depth.unseen=rank" in str(remedy_of(strict, item))


@pytest.mark.parametrize(
    ("cause", "tilt_deg", "said"),
    [
        ("tilt", 68.94, "--max-tilt 69 allows it"),
        ("tilt", 92.0, "--max-tilt 90 allows it"),
        ("below", 140.0, "--sensor"),
    ],
)
def test_a_view_that_is_too_aslant_names_what_can_be_stated(
    cause: str, tilt_deg: float, said: str, pr2: Gripper
) -> None:
    result = plan(CAMERA.sees(TABLE, Box((0.0, 0.0, 0.03), (0.1, 0.04, 0.06))), pr2)
    asked = replace(result, settings=load_settings("default", ("approach.directions=view",)))
    rejection = Rejection("approach", "the hand comes aslant", value=tilt_deg, limit=30.0, cause=cause)
    assert said in str(remedy_of(asked, replace(result.objects[0], grasps=(), rejection=rejection)))
