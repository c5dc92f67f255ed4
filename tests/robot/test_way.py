"""The poses before, at and after a grasp: those of the fingertips, of the flange and of the hand's own frame."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from flatgrasp_cli import Plan, load_gripper, load_robot, load_settings, plan, to_document
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import turned_about_z
from flatgrasp_cli.model import Approach, Cloud, Grasp, Pose, Poses, Reach
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.robot import Motion, forward, in_dh_base, way_to
from tests.conftest import Box, Camera
from tests.robot.arms import rows

UR5 = load_robot("ur5")
DEPTH = load_settings().depth
CAMERA = Camera(tilt_deg=20, target=(0.45, -0.1, 0.0))
UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def block() -> Cloud:
    """A block on a table in front of the robot, at an angle."""
    return CAMERA.sees(Box((0.45, 0.0, -0.01), (0.9, 0.7, 0.02)), Box((0.45, -0.1, 0.02), (0.10, 0.04, 0.04), 30))


def best(result: Plan) -> Grasp:
    assert result.best is not None, result.reason
    return result.best


def matrix(quaternion: FloatArray) -> FloatArray:
    return np.asarray(Rotation.from_quat(quaternion).as_matrix())


def of_joints(robot: Robot, reach: Reach | None) -> tuple[FloatArray, FloatArray]:
    """Places (3, 3) and rotations (3, 3, 3) of the flange in the robot's base frame: pre-grasp, grasp, lift."""
    assert reach is not None
    assert reach.joints_rad is not None
    frames = forward(rows(robot), reach.joints_rad)[:, 5]
    turn = np.diag(in_dh_base(robot.base_frame, np.ones(3)))
    return frames[:, :3, 3] @ turn, turn @ frames[:, :3, :3]


def in_order(poses: Poses) -> tuple[Pose, Pose, Pose]:
    return poses.pre_grasp, poses.pose, poses.lift


def wrist_turned(robot: Robot, angle_deg: float) -> Robot:
    """The robot with its usual stance turned about the flange's axis."""
    *others, last = robot.reach.reference_deg
    reach = robot.reach.model_copy(update={"reference_deg": (*others, last + angle_deg)})
    return robot.model_copy(update={"reach": reach})


MOUNTINGS: list[dict[str, float]] = [{}, {"adapter_m": 0.03, "palm_offset_m": 0.152}, {"mounted_deg": -37.0}]


@pytest.mark.parametrize("base_frame", ["base", "base_link"])
@pytest.mark.parametrize("mounting", MOUNTINGS, ids=["bare", "adapter", "turned"])
@pytest.mark.parametrize("stance_deg", [0.0, 180.0])
def test_the_joints_put_the_flange_where_the_grasp_says(
    stance_deg: float, mounting: dict[str, float], base_frame: Any, block: Cloud, pr2: Gripper
) -> None:
    turn = in_dh_base(base_frame, np.ones(3))
    assert block.viewpoint is not None
    cloud = Cloud(block.points * turn, block.viewpoint * turn)
    robot = wrist_turned(UR5.model_copy(update={"base_frame": base_frame}), stance_deg)
    result = plan(cloud, pr2.model_copy(update=mounting), robot=robot, top=5)
    for grasp in result.objects[0].grasps:
        places, turns = of_joints(robot, grasp.reach)
        for pose, place, rotation in zip(in_order(grasp.flange), places, turns, strict=True):
            assert pose.position == pytest.approx(place, abs=1e-9)
            assert matrix(pose.orientation) == pytest.approx(rotation, abs=1e-9)


def test_of_two_stances_half_a_turn_apart_one_takes_the_twin(block: Cloud, pr2: Gripper) -> None:
    """Both put the same fingertips' frame at the grasp, and flanges that are turned by 180° about the approach."""
    one, other = (best(plan(block, pr2, robot=wrist_turned(UR5, angle), top=1)) for angle in (0.0, 180.0))
    assert one.reach is not None
    assert other.reach is not None
    assert {one.reach.twin, other.reach.twin} == {False, True}
    assert one.pre_grasp.orientation == pytest.approx(other.pre_grasp.orientation)
    assert one.flange.pose.position == pytest.approx(other.flange.pose.position)
    half = matrix(one.flange.pose.orientation) @ np.diag([-1, -1, 1])
    assert matrix(other.flange.pose.orientation) == pytest.approx(half)
    plain = one if other.reach.twin else other
    assert plain.flange.pose.orientation == pytest.approx(plain.orientation)


def placed(gripper: Gripper, **values: Any) -> Grasp:
    """A grasp at (0.4, 0.2, 0.1) straight from above, its closing axis along y, 40 mm wide."""
    names = ("force_balance_deg", "torque_arm_m", "required_friction", "variance_m", "gravity_distance_m")
    measured: dict[str, Any] = dict.fromkeys((*names, "inside_share", "arc_ratio"), 0.0)
    tips = Pose(np.array([0.4, 0.2, 0.1]), np.array([0.0, 1.0, 0.0, 0.0]))
    reached = values.get("reach")
    twin = reached is not None and reached.twin
    return Grasp(
        rank=1,
        position=tips.position,
        orientation=tips.orientation,
        opening_m=0.06,
        width_m=0.04,
        contacts=np.zeros((2, 3)),
        fingers=(0, 1),
        approach=Approach(direction=-UP, tilt_deg=0.0, known_from="top"),
        way=way_to(tips, 0.04, gripper, Motion(0.10, 0.08, UP, twin=True), twin=twin),
        **measured,
        **values,
    )


def test_a_parallel_hand_from_above_by_hand() -> None:
    """WSG-50: 71 mm to the palm, 81 mm of fingers; the flange is 152 mm above the fingertips wherever they are."""
    grasp = placed(load_gripper("wsg_50"))
    assert [pose.position for pose in in_order(grasp.flange)] == [
        pytest.approx([0.4, 0.2, z]) for z in (0.352, 0.252, 0.332)
    ]
    assert [pose.orientation.tolist() for pose in in_order(grasp.flange)] == [[0, 1, 0, 0]] * 3
    assert grasp.pre_grasp.position == pytest.approx([0.4, 0.2, 0.2])
    assert grasp.lift.position == pytest.approx([0.4, 0.2, 0.18])
    assert grasp.hand is grasp.flange


def test_the_flange_stays_while_an_arcs_tips_come_out() -> None:
    """2F-85: 94 mm to the palm, 59 mm of fingers open at 85 mm, 13.5 mm more when closed: 160.147 mm at 40 mm."""
    hand = load_gripper("robotiq_2f_85")
    grasp = placed(hand)
    assert grasp.flange.pose.position[2] - grasp.position[2] == pytest.approx(0.094 + 0.059 + 0.0135 * 45 / 85)
    open_tips = grasp.flange.pose.position[2] - hand.tool_length_m(grasp.opening_m)
    assert open_tips - grasp.position[2] == pytest.approx(0.0135 * 20 / 85)  # tip_shift_m short of the pose


def test_an_adapter_and_a_turned_hand_by_hand() -> None:
    """The hand's frame keeps the closing axis on y. Turned by 90° on the flange, its y is the flange's −x."""
    grasp = placed(load_gripper("wsg_50").model_copy(update={"adapter_m": 0.02, "mounted_deg": 90.0}))
    assert grasp.flange.pose.position == pytest.approx([0.4, 0.2, 0.252])
    assert grasp.hand.pose.position == pytest.approx([0.4, 0.2, 0.232])
    assert grasp.hand.pose.orientation == pytest.approx([0, 1, 0, 0])
    closing, x = matrix(grasp.hand.pose.orientation)[:, 1], matrix(grasp.flange.pose.orientation)[:, 0]
    assert closing == pytest.approx(-x)
    assert matrix(grasp.flange.pose.orientation)[:, 2] == pytest.approx([0, 0, -1])


def test_the_twin_turns_flange_and_hand_and_not_the_fingertips() -> None:
    hand = load_gripper("wsg_50").model_copy(update={"adapter_m": 0.02})
    grasp, twin = placed(hand), placed(hand, reach=Reach(ok=True, twin=True))
    for own, turned in ((grasp.flange, twin.flange), (grasp.hand, twin.hand)):
        for one, other in zip(in_order(own), in_order(turned), strict=True):
            assert other.position == pytest.approx(one.position)
            assert matrix(other.orientation)[:, :2] == pytest.approx(-matrix(one.orientation)[:, :2])
    assert twin.lift.orientation.tolist() == grasp.lift.orientation.tolist()


def test_documents_hold_the_flange_and_the_hand_where_it_differs(block: Cloud, pr2: Gripper) -> None:
    for hand in (pr2, pr2.model_copy(update={"adapter_m": 0.02})):
        result = plan(block, hand, top=1)
        (part,) = to_document(result)["objects"][0]["grasps"]
        grasp = best(result)
        for key, poses in (("flange", grasp.flange), ("hand", grasp.hand)):
            if hand is pr2 and key == "hand":
                assert part["hand"] is None
                continue
            assert set(part[key]) == {"pose", "pre_grasp", "lift"}
            for name, pose in part[key].items():
                assert pose["position"] == pytest.approx(getattr(poses, name).position, abs=1e-9)
                assert pose["orientation"] == pytest.approx(getattr(poses, name).orientation, abs=1e-9)


def test_an_adapter_is_no_longer_than_the_way_to_the_palm(pr2: Gripper) -> None:
    with pytest.raises(ValidationError, match="adapter_m is a part of palm_offset_m"):
        Gripper.model_validate(pr2.model_dump() | {"adapter_m": 0.2})


@given(st.integers(0, 2**32 - 1), st.floats(-720, 720))
def test_a_turn_about_z_is_scipys(seed: int, angle_deg: float) -> None:
    before = Rotation.random(rng=np.random.default_rng(seed))
    turned = turned_about_z(before.as_quat(), angle_deg)
    assert turned[3] >= 0
    expected = before * Rotation.from_euler("z", angle_deg, degrees=True)
    assert matrix(turned) == pytest.approx(expected.as_matrix(), abs=1e-12)


def test_a_hand_that_came_aslant_goes_back_before_it_goes_up() -> None:
    """From the front, along x: it ends 10 cm before where it gripped, and 8 cm higher."""
    tips = Pose(np.array([0.4, 0.2, 0.1]), np.array([0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]))
    motion = Motion(0.10, 0.08, UP, twin=True, back_first=True)
    way = way_to(tips, 0.04, load_gripper("wsg_50"), motion, twin=False)
    assert way.back_first
    assert way.tips.pre_grasp.position == pytest.approx([0.3, 0.2, 0.1])
    assert way.tips.lift.position == pytest.approx([0.3, 0.2, 0.18])
